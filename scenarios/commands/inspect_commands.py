"""Commands that inspect runs and the library, such as `list`, `show`, `view`, `report` and `evaluate`."""

import shutil
import sys
import textwrap
from collections.abc import Sequence
from dataclasses import asdict, replace
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
    print_note,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.commands.table_options import TableOptions, plot_runs, table_options
from peopleboy.wording import counted

if TYPE_CHECKING:
    from peopleboy.scenarios.files.library import LibraryEntry
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.by_tracker import Groups
    from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions
    from peopleboy.scenarios.scores.people_ranges import PeopleRange


@click.command(cls=FieldsCommand)
@click.argument("folder", metavar="RUN", type=PATH)
@click.option(
    "--web", is_flag=True, help="Serve the viewer to a browser on this machine until you press Ctrl-C."
)
@click.option(
    "--port",
    type=WholeNumber(1, 65534),
    metavar="N",
    help="Port of the web page with --web; its data uses the next port.  [default: two free ports]",
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
    from peopleboy.scenarios.run_folder.finished_run import note_on

    if port is not None and not web:
        raise BadInput(f"--port {port}: is the port of --web; add --web, or leave --port out")
    recording = recording_in(folder)
    check_installed("view")
    if (folder / "run.json").is_file() and (note := note_on(folder)):
        print_note(f"{folder}: {note}")
    if not is_whole(recording):
        print_note(f"{recording}: the recording was cut off; only the part that was written is shown")
    layers = [recording, *layers_in(folder)]
    if web:
        serve(layers, lambda address: click.echo(f"Viewer: {address} (stop with Ctrl-C)"), port)
    else:
        open_viewer(layers)


@click.command("scene-model", cls=FieldsCommand)
@click.argument("folder", metavar="RUN", type=PATH)
@options_of(
    "scenarios.running.run_options:RunOptions", "out", "record", out="Output folder.  [default: RUN/scene]"
)
@click.option("--no-thermal", is_flag=True, help="Detect people by shape alone, without the thermal image.")
@output_options
def scene_model(folder: Path, no_thermal: bool, given: "GivenOptions[RunOptions]", output: Output) -> None:
    """Find objects that people moved, using depth images.

    The run must contain images of a camera named `depth`: run the scenario with --frames. The command writes
    `scene.jsonl` with one line per frame, the point cloud `static_map.ply` of the static scene, and
    `background.png` with the depth of the static scene from the last viewpoint. It also writes `scene.rrd`,
    which `view` shows together with the run's recording.
    """
    from peopleboy.scenarios.finished_runs.run_scene_model import FOLDER, SceneModelOptions, run_scene_model
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.run_folder.atomic_output import check_named, writing_to
    from peopleboy.scenarios.run_folder.finished_run import open_run

    run = open_run(folder)
    place = given.out or folder / FOLDER
    check_named(place)
    if place.exists() and not (place / "scene.jsonl").is_file():
        raise BadInput(f"{place}: was not written by this command and is not replaced; give another --out")
    options = SceneModelOptions(has_heat=not no_thermal, record=given.record is None)
    with writing_to(place), progress_bar(folder.name, unit="frames") as show:
        lines = run_scene_model(run, place, options, show)
    output.lines({"out": place, "moved": lines}, *(lines or ["Nothing was moved."]), place)


@click.command("list", cls=FieldsCommand)
@click.argument("words", metavar="[WORD...]", nargs=-1)
@output_options
def list_command(words: tuple[str, ...], output: Output) -> None:
    """List the scenarios and suites of the library.

    The list shows the duration, the number of people and a description of each scenario. WORDs limit the list
    to entries whose name or description contains all of them, for example `peopleboy list crossing` or
    `peopleboy list suite`.
    """
    from peopleboy.scenarios.files.library import library, suites

    entries = [entry for entry in (*library().values(), *suites().values()) if entry.matches(words)]
    if not entries:
        raise BadInput(f"list: no scenario or suite contains {' '.join(words)!r}; `peopleboy list` shows all")
    output.results(lambda: [asdict(entry) for entry in entries], lambda: _print_entries(entries))


def _print_entries(entries: "Sequence[LibraryEntry]") -> None:
    """Print a line for each entry; on a terminal, descriptions are wrapped in their column."""
    width = max(len(entry.name) for entry in entries)
    head = f"{'name':{width}}  {'time':>6}  people  "
    click.echo(f"{head}description")
    columns = shutil.get_terminal_size().columns if sys.stdout.isatty() else 0
    room = max(columns - len(head), 30)
    for entry in entries:
        if entry.runs is None:
            facts = f"{entry.duration_s:4g} s  {entry.people:6}"
        else:
            facts = f"{'':6}  {'suite':>6}"
        text = (
            entry.description if entry.runs is None else f"{entry.description} {counted(entry.runs, 'run')}."
        )
        lines = textwrap.wrap(text, room) if columns else [text]
        click.echo(f"{entry.name:{width}}  {facts}  {lines[0]}")
        for line in lines[1:]:
            click.echo(" " * len(head) + line)


@click.command(cls=FieldsCommand)
@click.argument("scenario", shell_complete=complete_scenario)
@click.option("--seed", type=WholeNumber(min=0), help=SEED)
@click.option("--out", type=PATH, help="Path of the image.  [default: SCENARIO-plan.png]")
@output_options
def show(scenario: str, seed: int | None, out: Path | None, output: Output) -> None:
    """Draw the floor plan of a scenario, with paths and times.

    With --json, the command also prints the resolved scenario, including all values that are sampled from the
    seed. If paths of a scenario are faulty, the command lists all faults, marks them in the plan by their
    numbers, and exits with code 2.
    """
    from peopleboy.scenarios.files.load import load_scenario

    try:
        loaded = load_scenario(scenario)
    except BadInput as error:
        _show_faults(scenario, seed, out, error)
        raise
    from peopleboy.scenarios.drawing.draw_plan import draw_plan  # here, as Matplotlib loads slowly

    path = out if out is not None else Path(f"{loaded.name}-plan.png")
    seed = loaded.seed if seed is None else seed
    draw_plan(loaded, seed, path)
    output.results(lambda: {"plan": str(path), "scenario": loaded.resolved(seed)}, lambda: click.echo(path))


def _show_faults(scenario: str, seed: int | None, out: Path | None, error: BadInput) -> None:
    """Draw a refused scenario with its faults, if they are places and the scenario can be drawn."""
    from peopleboy.scenarios.files.load import load_unchecked

    if not any(key[-1:] == ("at_m",) for key in error.keys):
        return
    loaded = load_unchecked(scenario)
    if loaded is None:
        return
    from peopleboy.scenarios.drawing.draw_plan import draw_plan  # here, as Matplotlib loads slowly

    path = out if out is not None else Path(f"{loaded.name}-plan.png")
    draw_plan(loaded, loaded.seed if seed is None else seed, path, error.keys)
    click.echo(f"{path} shows the faults, numbered in this order:", err=True)


@click.command(cls=FieldsCommand)
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    import json

    from peopleboy.scenarios.files.scenario_file import json_schema

    click.echo(json.dumps(json_schema(), indent=2))


@click.command(cls=FieldsCommand)
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=PATH)
@click.option(
    "--out",
    type=PATH,
    help="Path of the HTML page.  [default: RUN/report.html, or report.html in the current folder for "
    "several runs]",
)
@output_options
def report(runs: Sequence[Path], out: Path | None, output: Output) -> None:
    """Write an HTML report on tracks, occlusions and lost tracks.

    The report shows two to four RUNs side by side. For more RUNs, or for a folder of runs such as the output
    of a sweep, it is a summary by tracker.
    """
    from peopleboy.scenarios.report.report_page import write_report

    page = out if out is not None else (runs[0] / "report.html" if len(runs) == 1 else Path("report.html"))
    notes = list(write_report(runs, page))
    for line in notes:
        print_note(line)
    output.lines({"report": page, "notes": notes}, page)


@click.command(cls=FieldsCommand)
@click.argument("runs", nargs=-1, type=PATH)
@click.option(
    "--truth",
    type=PATH,
    help="Ground-truth file in the format of MOTChallenge, such as RUN/truth/gt.txt, of KITTI or of "
    "VisDrone, or in VOT or OTB format for one person.",
)
@click.option(
    "--tracks", type=PATH, help="Track file in MOTChallenge or KITTI format, such as RUN/tracks.txt."
)
@options_of("scenarios.scores.evaluate_runs:ScoreOptions", "protocol", "min_visible", "camera", "boxes")
@table_options
@output_options
def evaluate(
    runs: Sequence[Path],
    truth: Path | None,
    tracks: Path | None,
    given: "GivenOptions[ScoreOptions]",
    table: TableOptions,
    output: Output,
) -> None:
    """Score tracks against ground truth, from runs or files.

    RUNS are run folders, or folders that contain run folders, such as the output of a suite. For several runs
    of one tracker, the command prints the score over all frames, and the mean and standard deviation over the
    runs.

    Runs of several trackers are compared side by side. The difference of each tracker from the first is
    computed over runs of the same scenario and seed, with a 95 % interval and the p-value of the Wilcoxon
    signed-rank test. --csv, --latex and --markdown print these results as a table.

    Position errors on the floor are in metres, and a tracker without boxes is scored on the floor only. If
    the robot drove among people, comfort metrics are printed as well.
    """
    from peopleboy.scenarios.run_folder.finished_run import runs_in
    from peopleboy.scenarios.scores.by_tracker import comfort_by_tracker, score_by_tracker
    from peopleboy.scenarios.scores.tables.show_scores import print_comfort

    options = given.make()
    _check_files(runs, truth, tracks, options, table)
    found = [run for folder in runs for run in runs_in(folder)]

    def score(people_range: "PeopleRange | None") -> "Groups":
        if truth is not None and tracks is not None:
            return _score_files(truth, tracks, options, people_range)
        return score_by_tracker(found, replace(options, people_range=people_range))

    def comfort_to_json(groups: "Groups") -> dict[str, object]:
        comfort = {tracker: one.to_json() for tracker, one in comfort_by_tracker(groups).items()}
        return {"comfort": comfort} if comfort else {}

    table.show(
        output,
        score,
        lambda groups: print_comfort(comfort_by_tracker(groups)),
        comfort_to_json,
        plot_runs(options, score),
    )


def _check_files(
    runs: Sequence[Path],
    truth: Path | None,
    tracks: Path | None,
    options: "ScoreOptions",
    table: "TableOptions",
) -> None:
    """Refuse options that are for folders of runs together with files, and incomplete pairs of files."""
    if bool(runs) == (truth is not None or tracks is not None):
        raise BadInput("evaluate: give folders of runs, or --truth with --tracks")
    if runs:
        return
    if options.camera is not None:
        raise BadInput("evaluate: --camera is for folders of runs; give --truth RUN/truth/CAMERA.gt.txt")
    if options.boxes is not None:
        raise BadInput(
            "evaluate: --boxes is for folders of runs; the boxes of --truth are of one kind; leave it out"
        )
    if table.plots is not None:
        raise BadInput("evaluate: --plots is for folders of runs, which state the occlusions; leave it out")
    if truth is None or tracks is None:
        raise BadInput("evaluate: --truth and --tracks go together")


def _score_files(
    truth: Path, tracks: Path, options: "ScoreOptions", people_range: "PeopleRange | None"
) -> "Groups":
    from peopleboy.scenarios.scores.by_tracker import ScoredRun
    from peopleboy.scenarios.scores.evaluate_runs import evaluate_files

    scores = evaluate_files(
        truth,
        tracks,
        min_visible=options.min_visible,
        protocol=options.protocol,
        note=print_note if people_range is None else lambda _: None,
        people_range=people_range,
    )
    return {str(tracks): [ScoredRun(str(tracks), str(tracks), None, scores)]}
