"""Commands that run scenarios: `run`, `sweep`, `compare`."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    BEHAVIOUR,
    DETECTOR,
    SEED,
    TRACKER,
    FieldsCommand,
    GivenOptions,
    Output,
    options_of,
    output_options,
    print_note,
    seeds_options,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.commands.table_options import TableOptions, plot_runs, table_options
from peopleboy.tracker.tracker_names import shown_detector, shown_name

if TYPE_CHECKING:
    from peopleboy.scenarios.files.scenario import Scenario
    from peopleboy.scenarios.loop.loop import Tick
    from peopleboy.scenarios.running.engine.task import Workers
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.by_tracker import Groups
    from peopleboy.scenarios.scores.people_ranges import PeopleRange
    from peopleboy.scenarios.scores.run_scores import RunScores


@click.command(cls=FieldsCommand)
@click.argument("scenario", shell_complete=complete_scenario)
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("seed", "out", "frames", "tracker", "detector", "gallery", "boxes", "behaviour", "physics"),
    *("renderer", "record", "lossless", "overwrite"),
    seed=SEED,
    out="Output folder.  [default: runs/SCENARIO-SEED, followed by -TRACKER, -DETECTOR, -BEHAVIOUR or "
    "-PHYSICS where they differ from the scenario's]",
    tracker=TRACKER,
    detector=DETECTOR,
    behaviour=BEHAVIOUR,
)
@click.option(
    "--live",
    is_flag=True,
    help="Show the run in the rerun viewer while it is simulated; without a display, on a local web page.",
)
@workers_options
@output_options
def run(
    scenario: str,
    given: "GivenOptions[RunOptions]",
    live: bool,
    workers: "Workers",
    output: Output,
) -> None:
    """Simulate a scenario, record it, and score its tracks.

    SCENARIO is a name from `peopleboy list`, the path of a YAML file, or a suite, such as dataset1. The run
    folder contains ground truth, tracks, scores and a recording.

    The runs of a suite use the suite's seeds and have no recordings. If a suite is interrupted, run the
    command again to resume it. --workers and --scheduler apply to suites only.
    """
    from peopleboy.scenarios.files.library import suite_names
    from peopleboy.scenarios.files.load import load_scenario

    _check_physics(given)
    is_suite = scenario in suite_names()
    if is_suite:
        _check_suite(scenario, given)
    loaded = None if is_suite else load_scenario(scenario)
    seed = given.seed if given.seed is not None else 0 if loaded is None else loaded.seed
    name = (scenario if loaded is None else f"{loaded.name}-{seed}") + _others(loaded, given)
    options = given.make(seed=seed, out=given.out or Path("runs") / name)
    if loaded is not None:
        loaded = options.applied_to(loaded)
    if live:
        from peopleboy.scenarios.recording.recording_file import check_installed

        check_installed("--live")
    if live and (loaded is None or not options.record or not output.is_text):
        raise BadInput(
            "--live: shows the recording of a single run; give one scenario, without --no-recording, --json "
            "and --quiet"
        )
    if options.lossless and (loaded is None or not options.record):
        raise BadInput(
            f"{scenario}: --lossless is for recordings; suites and --no-recording write none, leave it out"
        )
    if loaded is None:
        _run_suite(scenario, options, workers, output)
        return
    given_words = click.get_current_context().params
    if given_words["workers"] is not None or given_words["scheduler"] is not None:
        raise BadInput(
            f"{scenario}: is a single run; --workers and --scheduler are for suites, leave them out"
        )
    with ExitStack() as stack:
        if live:
            from peopleboy.scenarios.recording.viewer import live_viewer

            options = replace(options, viewer=stack.enter_context(live_viewer(click.echo)))
        _run_one(loaded, options, output)


def _check_suite(name: str, given: "GivenOptions[RunOptions]") -> None:
    """Refuse options that a suite has itself, or that only single runs have."""
    if given.seed is not None:
        raise BadInput(f"--seed {given.seed}: suite {name} has its own seeds; leave it out")
    if given.behaviour is not None:
        raise BadInput(f"--behaviour {given.behaviour}: suite {name} has its own drives; leave it out")
    if given.gallery is not None:
        raise BadInput(f"--gallery {given.gallery}: is for single runs, and {name} is a suite; leave it out")


def _check_physics(given: "GivenOptions[RunOptions]") -> None:
    """Refuse physics that are not installed, before a scenario is loaded that falls back to others."""
    from peopleboy.sim.physics.physics_engine import check_physics

    if given.physics is not None:
        check_physics(given.physics)


def _others(scenario: "Scenario | None", given: "GivenOptions[RunOptions]") -> str:
    """Return the suffix of the folder's name: the options that differ from the scenario."""
    usual = () if scenario is None else (scenario.tracker, scenario.robot.behaviour, scenario.spec.physics)
    tracker = None if given.tracker is None else shown_name(given.tracker)
    detector = None if given.detector is None else shown_detector(given.detector)
    chosen = (tracker, detector, given.behaviour, given.physics)
    others = [each for each in chosen if each is not None and each not in usual]
    return "".join(f"-{each.replace(':', '.')}" for each in others)


def _run_one(scenario: "Scenario", options: "RunOptions", output: Output) -> None:
    from peopleboy.scenarios.running.run import tracker_name

    scores = _run_shown(scenario, options)
    about = {"run": str(options.out), "scenario": scenario.name, "seed": options.seed}
    about["tracker"] = shown_name(tracker_name(scenario, options))
    output.results(
        lambda: about | {"notes": list(scores.notes), "metrics": scores.to_json()},
        lambda: _show(scores, options),
    )


def _show(scores: "RunScores", options: "RunOptions") -> None:
    from peopleboy.scenarios.recording.recording_file import is_recorded
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.tables.show_scores import print_drive, print_scores

    print_scores(scores.people)
    for title, score in scores.drive.groups.items():
        print_drive(title, score.rows())
    click.echo(headline(scores))
    for note in scores.notes:
        print_note(note)
    click.echo(f"Key moments: {options.out / 'contact_sheet.png'}")
    if is_recorded(options.record):
        click.echo(f"Recording:   peopleboy view {options.out}")


def _run_shown(scenario: "Scenario", options: "RunOptions") -> "RunScores":
    """Run a scenario with a progress bar that shows frames, frame rate and the behaviour's mode."""
    from peopleboy.scenarios.progress_bar import progress_bar, progress_console
    from peopleboy.scenarios.running.run import run as run_scenario

    preparing = progress_console().status("building the world")
    with preparing, progress_bar(scenario.name, unit="frames") as show:

        def report(tick: "Tick", frames: int) -> None:
            preparing.stop()
            show(tick.frame, frames, tick.mode)

        return run_scenario(scenario, options, report)


def _run_suite(name: str, options: "RunOptions", workers: "Workers", output: Output) -> None:
    from peopleboy.scenarios.running.many_runs import run_suite
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.tables.show_scores import print_runs

    folders = run_suite(name, options, workers)
    groups = score_by_tracker(folders)
    output.results(lambda: figures_of_all(groups), lambda: print_runs(groups, note=print_note))
    if output.is_text:
        for path in folders:
            click.echo(path)


_SEEN: Final = 0.3


@click.command(cls=FieldsCommand)
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@seeds_options(10)
@click.option(
    "--random-worlds",
    is_flag=True,
    help="Run one random world per seed instead of scenarios, as in `render --random-worlds`.",
)
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("out", "frames", "tracker", "detector", "boxes", "behaviour", "physics", "overwrite"),
    out="Folder for the run folders.  [default: runs]",
    tracker=TRACKER,
    detector=DETECTOR,
    behaviour=BEHAVIOUR,
    overwrite="Replace earlier runs.",
)
@workers_options
@table_options
@output_options
def sweep(
    scenarios: Sequence[str],
    seeds: range,
    random_worlds: bool,
    given: "GivenOptions[RunOptions]",
    workers: "Workers",
    table: TableOptions,
    output: Output,
) -> None:
    """Run and score scenarios with many seeds, or random worlds.

    SCENARIO can also be a suite, which stands for its scenarios; `peopleboy run SUITE` uses the suite's own
    seeds. A sweep writes no recordings. If it is interrupted, run the command again to resume it. With
    --random-worlds, two scores are printed: one for all people, and one for people with a visible fraction
    above 30 %. The second is useful because many people in random worlds are occluded.
    """
    from peopleboy.scenarios.running.many_runs import sweep as run_seeds
    from peopleboy.scenarios.running.many_runs import sweep_worlds
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions
    from peopleboy.scenarios.scores.tables.show_scores import print_runs
    from peopleboy.tracker.evaluation.table import FIGURES

    _check_physics(given)
    options = given.make(seed=0, out=given.out or Path("runs"))
    if bool(scenarios) is random_worlds:
        raise BadInput("sweep: give scenarios, or --random-worlds, but not both")
    if random_worlds:
        runs = sweep_worlds(seeds, options, workers)
    else:
        runs = run_seeds(scenarios, seeds, options, workers)

    def score(people_range: "PeopleRange | None") -> "Groups":
        return score_by_tracker(runs, ScoreOptions(people_range=people_range))

    def score_seen() -> "Groups":
        return score_by_tracker(runs, ScoreOptions(min_visible=_SEEN))

    def show_seen(_groups: "Groups") -> None:
        if random_worlds and table.per is None:
            title = f"people with a visible fraction above {_SEEN:.0%}"
            print_runs(score_seen(), title, figures=table.figures or FIGURES)

    def seen_to_json(_groups: "Groups") -> dict[str, object]:
        asked = table.figures or FIGURES
        return {"visible": figures_of_all(score_seen(), asked)} if random_worlds else {}

    table.show(output, score, show_seen, seen_to_json, plot_runs(ScoreOptions(), score))


@click.command(cls=FieldsCommand)
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@click.option(
    "--controllers",
    default="follow_person,follow_person@truth",
    show_default=True,
    help="Controllers, separated by commas. Each is a behaviour or module:Class, to which you can "
    "append @TRACKER to replace the scenario's tracker.",
)
@seeds_options(20)
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("out", "boxes", "physics", "overwrite"),
    out="Folder for runs, tables and plots.  [default: runs/compare]",
    boxes="What the boxes of your own trackers enclose: the torso or the whole person.",
    overwrite="Replace earlier runs.",
)
@workers_options
@output_options
def compare(
    scenarios: Sequence[str],
    controllers: str,
    seeds: range,
    given: "GivenOptions[RunOptions]",
    workers: "Workers",
    output: Output,
) -> None:
    """Compare controllers on the same scenarios.

    The command prints metrics with confidence intervals, and their differences from the first controller with
    a paired test. It writes tables and plots, for each scenario and for all together. SCENARIO can also be a
    suite, which stands for its scenarios; the default is single_follow.

    If a comparison is interrupted, run the command again to resume it.
    """
    from peopleboy.scenarios.files.suite import scenarios_of
    from peopleboy.scenarios.running.compare_controllers import compare, parse_controller
    from peopleboy.scenarios.scores.tables.drive_comparison import DriveComparison
    from peopleboy.scenarios.scores.tables.show_scores import print_comparison

    _check_physics(given)
    chosen = [parse_controller(text) for text in controllers.split(",")]
    out = given.out or Path("runs") / "compare"
    compared = {}
    for scenario in scenarios_of(scenarios or ("single_follow",)):
        folder = out / scenario.name
        runs = compare(scenario, chosen, seeds, given.make(seed=0, out=folder), workers)
        compared[folder] = DriveComparison(scenario.name, runs)
    if len(compared) > 1:
        together = {
            str(one): [run for found in compared.values() for run in found.runs[str(one)]] for one in chosen
        }
        compared[out] = DriveComparison(f"all {len(compared)} scenarios", together)
    for folder, found in compared.items():
        found.save(folder)
        if output.is_text:
            print_comparison(found)
            click.echo(folder / "comparison.png")
    contents = [found.to_json() for found in compared.values()]
    output.results(lambda: {"comparisons": contents}, lambda: None)
