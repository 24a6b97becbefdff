"""Commands that run scenarios: `run`, `sweep`, `compare`."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    BEHAVIOUR,
    SEED,
    TRACKER,
    FieldsCommand,
    GivenOptions,
    Output,
    WholeNumber,
    options_of,
    output_options,
    tell_note,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario

if TYPE_CHECKING:
    from peopleboy.scenarios.files.scenario import Scenario
    from peopleboy.scenarios.loop.loop import Tick
    from peopleboy.scenarios.running.engine.task import Workers
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.run_scores import RunScores


@click.command(cls=FieldsCommand)
@click.argument("scenario", shell_complete=complete_scenario)
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("seed", "out", "frames", "tracker", "boxes", "behaviour", "physics"),
    *("renderer", "record", "lossless", "overwrite"),
    seed=f"Seed of everything random.  {SEED}",
    out="Folder of the run.  [default: runs/SCENARIO-SEED, and -TRACKER, -BEHAVIOUR, -PHYSICS for others]",
    tracker=TRACKER,
    behaviour=BEHAVIOUR,
)
@click.option(
    "--live", is_flag=True, help="Show it in the rerun viewer as it goes, or on a page of this machine."
)
@workers_options
@output_options
def run(
    scenario: str,
    given: GivenOptions[RunOptions],
    live: bool,
    workers: Workers,
    output: Output,
) -> None:
    """Run a scenario headless, and leave a folder with truth, tracks, scores and a recording.

    SCENARIO is a name from `peopleboy list` or the path of a YAML file; or a suite, such as dataset1, whose
    runs have seeds of their own and leave no recordings. A suite that was killed goes on where it was.
    --workers and --scheduler are for suites.
    """
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.files.suite import suite_names
    from peopleboy.scenarios.recording.recording_file import check_installed
    from peopleboy.scenarios.recording.viewer import live_viewer

    is_suite = scenario in suite_names()
    if is_suite and given.seed is not None:
        raise BadInput(f"--seed {given.seed}: suite {scenario} has seeds of its own; leave it out")
    if is_suite and given.behaviour is not None:
        raise BadInput(f"--behaviour {given.behaviour}: suite {scenario} has drives of its own; leave it out")
    loaded = None if is_suite else load_scenario(scenario)
    seed = given.seed if given.seed is not None else 0 if loaded is None else loaded.seed
    name = (scenario if loaded is None else f"{loaded.name}-{seed}") + _others(loaded, given)
    options = given.make(seed=seed, out=given.out or Path("runs") / name)
    if loaded is not None:
        loaded = options.applied_to(loaded)
    if live:
        check_installed("--live")
    if live and (loaded is None or not options.record or not output.is_wordy):
        raise BadInput(
            "--live: shows the recording of one run, and prints where; give one scenario, without --no-rrd, "
            "--json and --quiet"
        )
    if options.lossless and (loaded is None or not options.record):
        raise BadInput(f"{scenario}: --lossless is for the recording, which a suite and --no-rrd leave out")
    if loaded is None:
        _run_suite(scenario, options, workers, output)
        return
    given_words = click.get_current_context().params
    if given_words["workers"] is not None or given_words["scheduler"] is not None:
        raise BadInput(f"{scenario}: is one run, which has no use for --workers or --scheduler; leave it out")
    with ExitStack() as stack:
        if live:
            options = replace(options, viewer=stack.enter_context(live_viewer(click.echo)))
        _run_one(loaded, options, output)


def _others(scenario: Scenario | None, given: GivenOptions[RunOptions]) -> str:
    """Name what is not as in the scenario, as a folder's name ends."""
    usual = () if scenario is None else (scenario.tracker, scenario.robot.behaviour, scenario.spec.physics)
    chosen = (given.tracker, given.behaviour, given.physics)
    others = [each for each in chosen if each is not None and each not in usual]
    return "".join(f"-{each.replace(':', '.')}" for each in others)


def _run_one(scenario: Scenario, options: RunOptions, output: Output) -> None:
    from peopleboy.scenarios.running.run import tracker_name

    scores = _run_shown(scenario, options)
    about = {"run": str(options.out), "scenario": scenario.name, "seed": options.seed}
    about["tracker"] = tracker_name(scenario, options)
    output.figures(
        lambda: about | {"notes": list(scores.notes), "figures": scores.to_json()},
        lambda: _show(scores, options),
    )


def _show(scores: RunScores, options: RunOptions) -> None:
    from peopleboy.scenarios.recording.recording_file import is_recorded
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.show_scores import print_drive, print_scores

    print_scores(scores.people)
    drives = {"following": scores.following, "corridor": scores.corridor, "comfort": scores.comfort}
    for title, score in drives.items():
        if score is not None:
            print_drive(title, score.rows())
    click.echo(headline(scores))
    for note in scores.notes:
        tell_note(note)
    click.echo(f"{options.out / 'contact_sheet.png'} shows the key moments.")
    if is_recorded(options.record):
        click.echo(f"peopleboy view {options.out} plays the recording.")


def _run_shown(scenario: Scenario, options: RunOptions) -> RunScores:
    """Run a scenario with a bar that shows frames, frame rate and what the robot does."""
    from peopleboy.scenarios.progress_bar import progress_bar, progress_console
    from peopleboy.scenarios.running.run import run as run_scenario

    preparing = progress_console().status("building the world")
    with preparing, progress_bar(scenario.name, unit="frames") as show:

        def report(tick: Tick, frames: int) -> None:
            preparing.stop()
            show(tick.frame, frames, tick.mode)

        return run_scenario(scenario, options, report)


def _run_suite(name: str, options: RunOptions, workers: Workers, output: Output) -> None:
    from peopleboy.scenarios.running.many_runs import run_suite
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.show_scores import print_runs

    folders = run_suite(name, options, workers)
    groups = score_by_tracker(folders)
    output.figures(lambda: figures_of_all(groups), lambda: print_runs(groups, note=tell_note))
    if output.is_wordy:
        for path in folders:
            click.echo(path)


_SEEN: Final = 0.3


@click.command(cls=FieldsCommand)
@click.argument("scenario", required=False, shell_complete=complete_scenario)
@click.option("--seeds", type=WholeNumber(min=1), help="How many, from 0 on.  [default: 10]")
@click.option(
    "--randomise",
    metavar="N",
    type=WholeNumber(min=1),
    help="In place of a scenario: how many worlds drawn at random, as `render` has them.",
)
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("out", "tracker", "boxes", "behaviour", "physics", "overwrite"),
    out="Folder for the runs' folders.  [default: runs]",
    tracker=TRACKER,
    behaviour=BEHAVIOUR,
    overwrite="Replace earlier runs.",
)
@workers_options
@output_options
def sweep(
    scenario: str | None,
    seeds: int | None,
    randomise: int | None,
    given: GivenOptions[RunOptions],
    workers: Workers,
    output: Output,
) -> None:
    """Run a scenario with many seeds, or many random worlds, without recordings, and score them together.

    A killed call goes on where it was. For random worlds, where many people stand behind things, scores are
    given for all people, and for those of whom more than 30 % is visible.
    """
    from peopleboy.scenarios.running.many_runs import sweep as run_seeds
    from peopleboy.scenarios.running.many_runs import sweep_worlds
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions
    from peopleboy.scenarios.scores.show_scores import print_runs

    options = given.make(seed=0, out=given.out or Path("runs"))
    if (scenario is None) == (randomise is None) or (randomise is not None and seeds is not None):
        raise BadInput("sweep: give a scenario, with --seeds or without, or --randomise N")
    if scenario is None:
        runs = sweep_worlds(range(randomise or 0), options, workers)
    else:
        runs = run_seeds(scenario, range(10 if seeds is None else seeds), options, workers)
    groups = score_by_tracker(runs)
    if randomise is None:
        output.figures(lambda: figures_of_all(groups), lambda: print_runs(groups, note=tell_note))
        return
    seen = score_by_tracker(runs, ScoreOptions(min_visible=_SEEN))

    def show() -> None:
        print_runs(groups, note=tell_note)
        print_runs(seen, f"people of whom more than {_SEEN:.0%} is seen")

    output.figures(lambda: figures_of_all(groups) | {"seen": figures_of_all(seen)}, show)


@click.command(cls=FieldsCommand)
@click.option(
    "--controllers",
    default="follow_person,follow_person@truth",
    show_default=True,
    help="Behaviours, or module:Class of your own, each with @ and a tracker if it is to see by another one, "
    "or by the truth.",
)
@click.option(
    "--scenario",
    "scenarios",
    multiple=True,
    default=("single_follow",),
    show_default=True,
    help="Name or file; can be given again.",
)
@click.option("--seeds", type=WholeNumber(min=1), default=20, show_default=True, help="How many, from 0 on.")
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("out", "boxes", "physics", "overwrite"),
    out="Folder for runs, tables and plots.  [default: runs/compare]",
    boxes="What boxes of trackers of your own enclose: the torso, or the whole person.",
    overwrite="Replace earlier runs.",
)
@workers_options
@output_options
def compare(
    controllers: str,
    scenarios: Sequence[str],
    seeds: int,
    given: GivenOptions[RunOptions],
    workers: Workers,
    output: Output,
) -> None:
    """Let controllers drive through the same scenes, and print how they did, with confidence intervals.

    A killed call goes on where it was.
    """
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.running.compare_controllers import (
        compare,
        keep_comparison,
        parse_controller,
        show_comparison,
    )

    chosen = [parse_controller(text) for text in controllers.split(",")]
    names = [load_scenario(scenario).name for scenario in scenarios]
    out, found = given.out or Path("runs") / "compare", []
    for scenario, name in zip(scenarios, names, strict=True):
        runs = compare(scenario, chosen, range(seeds), given.make(seed=0, out=out / name), workers)
        found.append(keep_comparison(name, runs, out / name))
        if output.is_wordy:
            show_comparison(name, runs)
            click.echo(out / name / "comparison.png")
    output.figures(lambda: {"comparisons": found})
