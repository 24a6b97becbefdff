"""Commands that run many seeds: `sweep`, `compare`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.scenarios.commands.options import tracker_option
from peopleboy.scenarios.scores.show_scores import print_spread


@click.command()
@click.argument("scenario")
@click.option(
    "--seeds", type=click.IntRange(min=1), default=10, show_default=True, help="How many, from 0 on."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Where the runs' folders go.",
)
@tracker_option
@click.option(
    "--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Runs at the same time."
)
@click.option("--overwrite", is_flag=True, help="Replace earlier runs.")
def sweep(scenario: str, seeds: int, out: Path, tracker: str | None, jobs: int, overwrite: bool) -> None:
    """Run a scenario with many seeds, without recordings, and score them together."""
    from peopleboy.scenarios.running.sweep import run_seeds
    from peopleboy.scenarios.scores.evaluate_runs import evaluate_runs

    folders = run_seeds(scenario, range(seeds), out, tracker, jobs, overwrite=overwrite)
    print_spread(evaluate_runs(folders))


@click.command()
@click.option(
    "--controllers",
    default="follow_person,follow_person@truth",
    show_default=True,
    help="Behaviours, each with @ and a tracker if it is to see by another one, or by the truth.",
)
@click.option(
    "--scenario",
    "scenarios",
    multiple=True,
    default=("single_follow",),
    show_default=True,
    help="Name or file; can be given again.",
)
@click.option(
    "--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="How many, from 0 on."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs") / "compare",
    show_default=True,
    help="Where runs, tables and plots go; earlier ones are replaced.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at the same time."
)
def compare(controllers: str, scenarios: Sequence[str], seeds: int, out: Path, jobs: int) -> None:
    """Let controllers drive through the same scenes, and print how they did, with confidence intervals."""
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.running.compare_controllers import compare, parse_controller
    from peopleboy.scenarios.running.show_comparison import show_comparison

    chosen = [parse_controller(text) for text in controllers.split(",")]
    names = [load_scenario(scenario).name for scenario in scenarios]
    for scenario, name in zip(scenarios, names, strict=True):
        runs = compare(scenario, chosen, range(seeds), out / name, jobs)
        show_comparison(name, runs, out / name)
        click.echo(out / name / "comparison.png")
