"""The command `run`: one scenario, or a suite."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    BEHAVIOUR,
    SEED,
    TRACKER,
    FieldsCommand,
    GivenOptions,
    Output,
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
    workers: int | None,
    scheduler: str | None,
    output: Output,
) -> None:
    """Run a scenario headless, and leave a folder with truth, tracks, scores and a recording.

    SCENARIO is a name from `peopleboy list` or the path of a YAML file; or a suite, such as dataset1, whose
    runs have seeds of their own and leave no recordings. A suite that was killed goes on where it was.
    --workers and --scheduler are for suites.
    """
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.files.suite import suite_names
    from peopleboy.scenarios.recording.viewer import live_viewer
    from peopleboy.scenarios.running.engine.task import chosen_workers

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
    if live and (loaded is None or not options.record or not output.is_wordy):
        raise BadInput(
            "--live: shows the recording of one run, and prints where; give one scenario, without --no-rrd, "
            "--json and --quiet"
        )
    if options.lossless and (loaded is None or not options.record):
        raise BadInput(f"{scenario}: --lossless is for the recording, which a suite and --no-rrd leave out")
    if loaded is None:
        _run_suite(scenario, options, chosen_workers(workers, scheduler), output)
        return
    if workers is not None or scheduler is not None:
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
    if options.record:
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
