"""Commands that run many seeds: `sweep`, `compare`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    BEHAVIOUR,
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

_SEEN: Final = 0.3

if TYPE_CHECKING:
    from peopleboy.scenarios.running.run_options import RunOptions


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
    workers: int | None,
    scheduler: str | None,
    output: Output,
) -> None:
    """Run a scenario with many seeds, or many random worlds, without recordings, and score them together.

    A killed call goes on where it was. For random worlds, where many people stand behind things, scores are
    given for all people, and for those of whom more than 30 % is visible.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.scenarios.running.many_runs import sweep as run_seeds
    from peopleboy.scenarios.running.many_runs import sweep_worlds
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.show_scores import print_runs

    who = chosen_workers(workers, scheduler)
    options = given.make(seed=0, out=given.out or Path("runs"))
    if (scenario is None) == (randomise is None) or (randomise is not None and seeds is not None):
        raise BadInput("sweep: give a scenario, with --seeds or without, or --randomise N")
    if scenario is None:
        runs = sweep_worlds(range(randomise or 0), options, who)
    else:
        runs = run_seeds(scenario, range(10 if seeds is None else seeds), options, who)
    groups = score_by_tracker(runs)
    if randomise is None:
        output.figures(lambda: figures_of_all(groups), lambda: print_runs(groups, note=tell_note))
        return
    seen = score_by_tracker(runs, _SEEN)

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
    workers: int | None,
    scheduler: str | None,
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
    from peopleboy.scenarios.running.engine.task import chosen_workers

    who = chosen_workers(workers, scheduler)
    chosen = [parse_controller(text) for text in controllers.split(",")]
    names = [load_scenario(scenario).name for scenario in scenarios]
    out, found = given.out or Path("runs") / "compare", []
    for scenario, name in zip(scenarios, names, strict=True):
        runs = compare(scenario, chosen, range(seeds), given.make(seed=0, out=out / name), who)
        found.append(keep_comparison(name, runs, out / name))
        if output.is_wordy:
            show_comparison(name, runs)
            click.echo(out / name / "comparison.png")
    output.figures(lambda: {"comparisons": found})
