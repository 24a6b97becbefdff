"""Commands that run many seeds: `sweep`, `compare`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.commands.options import (
    BOXES,
    Output,
    WholeNumber,
    behaviour_option,
    boxes_option,
    output_options,
    physics_option,
    tell_note,
    tracker_option,
    workers_options,
)

_SEEN: Final = 0.3


@click.command()
@click.argument("scenario", required=False, shell_complete=complete_scenario)
@click.option("--seeds", type=WholeNumber(min=1), help="How many, from 0 on.  [default: 10]")
@click.option(
    "--randomise",
    metavar="N",
    type=WholeNumber(min=1),
    help="In place of a scenario: how many worlds drawn at random, as `render` has them.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Where the runs' folders go.",
)
@tracker_option
@boxes_option
@behaviour_option
@physics_option
@workers_options
@click.option("--overwrite", is_flag=True, help="Replace earlier runs.")
@output_options
def sweep(
    scenario: str | None,
    seeds: int | None,
    randomise: int | None,
    out: Path,
    tracker: str | None,
    boxes: str,
    behaviour: str | None,
    physics: str | None,
    workers: int | None,
    scheduler: str | None,
    overwrite: bool,
    output: Output,
) -> None:
    """Run a scenario with many seeds, or many random worlds, without recordings, and score them together.

    A killed call goes on where it was. Of random worlds, where many people stand behind things, figures are
    told of everybody, and again of those of whom more than 30 % is seen.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.scenarios.running.many_runs import sweep as run_seeds
    from peopleboy.scenarios.running.many_runs import sweep_worlds
    from peopleboy.scenarios.scores.by_tracker import figures_of_all, score_by_tracker
    from peopleboy.scenarios.scores.show_scores import print_runs
    from peopleboy.tracker.footage.box_kinds import BoxKind

    who, kind = chosen_workers(workers, scheduler), BoxKind(boxes)
    if (scenario is None) == (randomise is None) or (randomise is not None and seeds is not None):
        raise BadInput("sweep: give a scenario, with --seeds or without, or --randomise N")
    if scenario is None:
        runs = sweep_worlds(
            range(randomise or 0), out, tracker, who, behaviour, physics, kind, overwrite=overwrite
        )
    else:
        count = range(10 if seeds is None else seeds)
        runs = run_seeds(scenario, count, out, tracker, who, behaviour, physics, kind, overwrite=overwrite)
    groups = score_by_tracker(runs)
    if randomise is None:
        output.figures(lambda: figures_of_all(groups), lambda: print_runs(groups, note=tell_note))
        return
    seen = score_by_tracker(runs, _SEEN)

    def show() -> None:
        print_runs(groups, note=tell_note)
        print_runs(seen, f"people of whom more than {_SEEN:.0%} is seen")

    output.figures(lambda: figures_of_all(groups) | {"seen": figures_of_all(seen)}, show)


@click.command()
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
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs") / "compare",
    show_default=True,
    help="Where runs, tables and plots go.",
)
@click.option(
    "--boxes",
    type=BOXES,
    default="torso",
    show_default=True,
    help="What boxes of trackers of your own are drawn round: the torso, or all of a person.",
)
@physics_option
@workers_options
@click.option("--overwrite", is_flag=True, help="Replace earlier runs.")
@output_options
def compare(
    controllers: str,
    scenarios: Sequence[str],
    seeds: int,
    out: Path,
    boxes: str,
    physics: str | None,
    workers: int | None,
    scheduler: str | None,
    overwrite: bool,
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
    from peopleboy.tracker.footage.box_kinds import BoxKind

    who = chosen_workers(workers, scheduler)
    chosen = [parse_controller(text) for text in controllers.split(",")]
    names = [load_scenario(scenario).name for scenario in scenarios]
    found = []
    for scenario, name in zip(scenarios, names, strict=True):
        runs = compare(
            scenario, chosen, range(seeds), out / name, who, physics, BoxKind(boxes), overwrite=overwrite
        )
        found.append(keep_comparison(name, runs, out / name))
        if output.is_wordy:
            show_comparison(name, runs)
            click.echo(out / name / "comparison.png")
    output.figures(lambda: {"comparisons": found})
