"""Commands that look at the library: `list`, `show`, `schema`."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.commands.options import SEED, WholeNumber


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
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture to write.  [default: SCENARIO-plan.png]"
)
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
