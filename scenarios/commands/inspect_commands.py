"""Commands that inspect runs and the library: `view`, `report`, `evaluate`, `list`, `show` and others."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    PATH,
    SEED,
    FieldsCommand,
    GivenOptions,
    Output,
    WholeNumber,
    options_of,
    output_options,
    tell_note,
)
from peopleboy.scenarios.commands.completion import complete_scenario

if TYPE_CHECKING:
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions


@click.command()
@click.argument("folder", metavar="RUN", type=PATH)
@click.option("--web", is_flag=True, help="Serve it to a browser on this machine, until Ctrl-C.")
@click.option(
    "--port",
    type=WholeNumber(1, 65534),
    metavar="N",
    help="With --web: the page's port; its data takes the next. Any two free ones if not given.",
)
def view(folder: Path, web: bool, port: int | None) -> None:
    """Open the recording of a run in the rerun viewer."""
    from peopleboy.scenarios.recording.recording_file import (
        check_installed,
        is_whole,
        layers_in,
        recording_in,
    )
    from peopleboy.scenarios.recording.viewer import open_viewer, serve

    if port is not None and not web:
        raise BadInput(f"--port {port}: is where --web serves; give --web too, or neither")
    recording = recording_in(folder)
    check_installed("view")
    if not is_whole(recording):
        click.echo(f"peopleboy: {recording}: was cut off; what it holds is shown", err=True)
    layers = [recording, *layers_in(folder)]
    if web:
        serve(layers, lambda address: click.echo(f"{address} shows it; Ctrl-C ends that."), port)
    else:
        open_viewer(layers)


@click.command("scene-model", cls=FieldsCommand)
@click.argument("folder", metavar="RUN", type=PATH)
@options_of(
    "scenarios.running.run_options:RunOptions", "out", "record", out="Folder to leave.  [default: RUN/scene]"
)
@click.option("--no-heat", is_flag=True, help="Find people by their shape alone, without the thermal image.")
def scene_model(folder: Path, no_heat: bool, given: GivenOptions[RunOptions]) -> None:
    """Find what was moved in a run, and which person moved it, in the depth images of its robot.

    The run needs images: run the scenario with --frames, and a camera `depth`. Leaves scene.jsonl, a line a
    frame; static_map.ply, what stands, as points; background.png, its depth in the last view; and scene.rrd,
    which `view` shows over the run's recording.
    """
    from peopleboy.scenarios.finished_runs.run_scene_model import FOLDER, SceneModelOptions, run_scene_model
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.run_folder.atomic_output import check_named, writing_to
    from peopleboy.scenarios.run_folder.finished_run import open_run

    run = open_run(folder)
    place = given.out or folder / FOLDER
    check_named(place)
    if place.exists() and not (place / "scene.jsonl").is_file():
        raise BadInput(f"{place}: is no folder of this command and will not be replaced; give another --out")
    options = SceneModelOptions(has_heat=not no_heat, record=given.record is None)
    with writing_to(place), progress_bar(folder.name, unit="frames") as show:
        lines = run_scene_model(run, place, options, show)
    for line in lines or ["Nothing was moved."]:
        click.echo(line)
    click.echo(place)


@click.command("list")
def list_command() -> None:
    """List the scenarios of the library, and the suites."""
    from peopleboy.scenarios.files.load import library
    from peopleboy.scenarios.files.suite import load_suite, suite_names

    suites = {name: f"suite: {' '.join(load_suite(name).description.split())}" for name in suite_names()}
    entries = library() | suites
    width = max(map(len, entries))
    for name, description in entries.items():
        click.echo(f"{name:{width}} {description}")


@click.command()
@click.argument("scenario", shell_complete=complete_scenario)
@click.option("--seed", type=WholeNumber(min=0), help=f"What is drawn follows from it.  {SEED}")
@click.option("--out", type=PATH, help="Picture to write.  [default: SCENARIO-plan.png]")
def show(scenario: str, seed: int | None, out: Path | None) -> None:
    """Draw the plan of a scenario, with paths and times."""
    from peopleboy.scenarios.drawing.draw_plan import draw_plan
    from peopleboy.scenarios.files.load import load_scenario

    loaded = load_scenario(scenario)
    path = out if out is not None else Path(f"{loaded.name}-plan.png")
    draw_plan(loaded, loaded.seed if seed is None else seed, path)
    click.echo(path)


@click.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    import json

    from peopleboy.scenarios.files.scenario_file import json_schema

    click.echo(json.dumps(json_schema(), indent=2))


@click.command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=PATH)
@click.option(
    "--out",
    type=PATH,
    help="Page to write.  [default: RUN/report.html; report.html here for several]",
)
def report(runs: Sequence[Path], out: Path | None) -> None:
    """Write one HTML page about runs: who was tracked, hidden, lost and swapped, and why.

    Two to four RUNs stand side by side; more are taken together by tracker. A folder that holds folders of
    runs, such as that of a sweep, is taken together too.
    """
    from peopleboy.scenarios.report.report_page import write_report

    page = out if out is not None else (runs[0] / "report.html" if len(runs) == 1 else Path("report.html"))
    for line in write_report(runs, page):
        click.echo(f"peopleboy: {line}", err=True)
    click.echo(page)


@click.command(cls=FieldsCommand)
@click.argument("runs", nargs=-1, type=PATH)
@click.option(
    "--truth", type=PATH, help="MOTChallenge truth, such as RUN/truth/gt.txt; or one person's, VOT or OTB."
)
@click.option("--tracks", type=PATH, help="MOTChallenge results, such as RUN/tracks.txt.")
@options_of("scenarios.scores.evaluate_runs:ScoreOptions", "min_visible", "camera", "boxes")
@output_options
def evaluate(
    runs: Sequence[Path],
    truth: Path | None,
    tracks: Path | None,
    given: GivenOptions[ScoreOptions],
    output: Output,
) -> None:
    """Score tracks against truth: one pair of files, or the folders of any number of runs.

    A folder that holds folders of runs, such as a suite's, stands for all of them. Several runs of one
    tracker give mean and standard deviation over them, beside the figure of all their frames. Runs of several
    trackers stand side by side, with how each differs from the first over runs of the same scenario and seed.
    Where a tracker says where on the floor people stand, its errors are printed in metres; one that gives no
    boxes is scored on the floor alone. Of runs in which the robot drove among people, it prints how
    comfortable they were.
    """
    from peopleboy.scenarios.run_folder.finished_run import runs_in
    from peopleboy.scenarios.scores.by_tracker import (
        ScoredRun,
        comfort_by_tracker,
        figures_of_all,
        score_by_tracker,
    )
    from peopleboy.scenarios.scores.evaluate_runs import evaluate_files
    from peopleboy.scenarios.scores.show_scores import print_comfort, print_runs

    options = given.make()
    if options.camera is not None and not runs:
        raise BadInput("evaluate: --camera goes with folders of runs; give --truth RUN/truth/CAMERA.gt.txt")
    if options.boxes is not None and not runs:
        raise BadInput(
            "evaluate: --boxes goes with folders of runs; boxes in --truth are of one kind; leave it out"
        )
    if bool(runs) == (truth is not None or tracks is not None):
        raise BadInput("evaluate: give folders of runs, or --truth with --tracks")
    if runs:
        found = [run for folder in runs for run in runs_in(folder)]
        groups = score_by_tracker(found, options)
    elif truth is None or tracks is None:
        raise BadInput("evaluate: --truth and --tracks go together")
    else:
        scores = evaluate_files(truth, tracks, min_visible=options.min_visible, note=tell_note)
        groups = {str(tracks): [ScoredRun(str(tracks), str(tracks), None, scores)]}
    comfort = comfort_by_tracker(groups)

    def show() -> None:
        print_runs(groups, note=tell_note)
        print_comfort(comfort)

    comforts = {tracker: score.to_json() for tracker, score in comfort.items()}
    output.figures(lambda: figures_of_all(groups) | ({"comfort": comforts} if comforts else {}), show)
