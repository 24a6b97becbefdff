"""`python -m docs.generate.sources RUN`: ship the results of a run of `peopleboy reproduce`.

Results may be of any version of the code, which the page states. With `--add ID`, this part of a later run
replaces the shipped one, or is added, and the page states that.
"""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import click

from docs.generate.sources.source_pages import PAGE, whole_page
from docs.generate.sources.source_run import FOLDER, SourceRun
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.studies.reproductions.catalogue import choose, of_paper
from peopleboy.studies.reproductions.experiment import ExperimentOutcome
from peopleboy.studies.reproductions.pictures.plots import draw
from peopleboy.studies.reproductions.plan import full_plan
from peopleboy.studies.reproductions.runner import RESULTS, finished
from peopleboy.studies.reproductions.source_page import head_of

PAPERS = ("thesis", "2005", "panoramic", "situation")
"""The sources on the page."""

_COMMAND = "; ".join(f"peopleboy reproduce --paper {paper}" for paper in PAPERS)


@click.command()
@click.argument("run", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--machine", required=True, help="Description of the machine.")
@click.option(
    "--add", "added", multiple=True, help="Update only this part, and keep all other shipped parts."
)
def main(run: Path, machine: str, added: tuple[str, ...]) -> None:
    """Write results, pictures and page of a run to docs/sources."""
    results = run / RESULTS
    code = _newest_code(results)
    plan, store = full_plan(run / "films"), Store(results, code)
    parts = {name: one for paper in PAPERS for name, one in of_paper(paper).items()}
    wanted = choose(added) if added else parts.values()
    outcomes, missing = finished([one for one in wanted if one.id in parts], plan, store)
    head = head_of(plan, outcomes, store, command=_COMMAND, missing=missing)
    recorded = datetime.fromtimestamp(results.stat().st_mtime, UTC).date().isoformat()
    facts = {"Recorded": recorded, **head.facts, "Machine": machine, "Code": code}
    before = SourceRun.read() if added else None
    stays = set() if before is None else {one.picture for one in before.without(outcomes).outcomes}
    for old in FOLDER.glob("*.[sp][vn]g"):
        if old.name not in stays:
            old.unlink()
    shipped = SourceRun(replace(head, facts=facts), tuple(_with_file(one) for one in outcomes))
    (shipped if before is None else before.with_later(shipped)).write()
    # Read back what was written, since values are rounded to a few digits.
    (FOLDER / PAGE).write_text(whole_page(SourceRun.read()), encoding="utf-8")
    click.echo(FOLDER / PAGE)


def _newest_code(results: Path) -> str:
    *_, last = results.read_text(encoding="utf-8").splitlines()
    code: str = json.loads(last)["code"]
    return code


def _with_file(outcome: ExperimentOutcome) -> ExperimentOutcome:
    """Write the picture or plot to a separate file."""
    number = outcome.experiment.id
    address = outcome.picture or draw(outcome.experiment, outcome.samples)
    if address is None:
        return outcome
    kind, _, content = address.partition(";base64,")
    name = f"{number}.{'svg' if 'svg' in kind else 'png'}"
    (FOLDER / name).write_bytes(base64.b64decode(content))
    return replace(outcome, picture=name)


if __name__ == "__main__":
    main()
