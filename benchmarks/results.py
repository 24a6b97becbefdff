"""`python -m benchmarks.results TABLE...`: update the measured results in docs/results.yaml.

Each table records how, when and on what it was measured; the command reads the output of the measurements.
"""

import json
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import Any

import click
import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

from benchmarks import call
from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.scores.evaluate_runs import evaluate_runs
from peopleboy.scenarios.scores.tables.drive_comparison import figures_of
from peopleboy.tracker.evaluation.evaluate import combine
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.wording import hint

PATH = Path(__file__).parents[1] / "docs" / "results.yaml"


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class ResultColumn(_Part):
    """One column of a table of results."""

    name: str = Field(description="title of the column")
    form: str = Field(default="{:.1f}", description="format of a value, with its unit")
    key: str = Field(default="", description="path of the value in the measured output, such as /thesis/CP")
    factor: float = Field(default=1.0, description="data on which it was measured")


class ResultRow(_Part):
    """Results of one scenario, tracker or part."""

    name: str
    measured: str = Field(
        default="",
        description="output of a command: a JSON file, FILE#/KEY for a part of it, or folders of runs, "
        "runs/NAME-*; empty if the command only prints its results",
    )
    runs: int | None = Field(default=None, ge=1, description="number of runs")
    figures: tuple[float | None, ...] = Field(description="one value per column; null if not measured")


class ResultTable(_Part):
    """One table on the page of results."""

    command: str
    recorded: str = Field(description="date on which the values were recorded")
    seeds: str = Field(description="description of the seeds")
    chosen_on: str = Field(
        default="", description="scenes on which settings of the tracker or behaviour were tuned"
    )
    rows_are: str = Field(default="", description="title of the first column")
    columns: tuple[ResultColumn, ...]
    rows: tuple[ResultRow, ...]

    @model_validator(mode="after")
    def _has_a_figure_for_every_column(self) -> "ResultTable":
        for row in self.rows:
            if len(row.figures) != len(self.columns):
                raise ValueError(f"{row.name}: {len(row.figures)} values for {len(self.columns)} columns")
        return self


class ResultTables(_Part):
    """The whole file."""

    tables: dict[str, ResultTable]


def read_tables(path: Path = PATH) -> ResultTables:
    """Read the file.

    Raises:
        BadInput: it cannot be read, or does not contain tables of results.
    """
    data = read_yaml(path)
    with found_in(file=str(path)):
        return validated(ResultTables, data)


def as_yaml(tables: ResultTables) -> str:
    """Return the text of the file, without keys that have their default."""
    data = tables.model_dump(mode="json", exclude_defaults=True)
    text: str = yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=110, default_flow_style=None)
    return text


def take_in(table: ResultTable) -> ResultTable:
    """Return a table with the current values from the outputs that its rows name, and today's date.

    Empty cells stay empty.

    Raises:
        BadInput: no row names an output, or a value is missing.
    """
    if not any(row.measured for row in table.rows):
        raise BadInput(f"`{table.command}` only prints its results; put them into docs/results.yaml by hand")
    rows = tuple(_take_row(row, table) for row in table.rows)
    return table.model_copy(update={"rows": rows, "recorded": date.today().isoformat()})


def _take_row(row: ResultRow, table: ResultTable) -> ResultRow:
    if not row.measured:
        return row
    found = read_measured(row)
    figures = tuple(
        old if old is None or not column.key else _look_up(found, column, row)
        for column, old in zip(table.columns, row.figures, strict=True)
    )
    return row.model_copy(update={"figures": figures})


def read_measured(row: ResultRow) -> Any:
    """Read the measured output of a row.

    Folders of runs are summarised: `scores` over all their frames, `mean` and `worst` of the robot's driving
    metrics, and `runs`, their number. A JSON file may have `runs`, too, as a number or a list.

    Raises:
        BadInput: it is missing, or its number of runs differs from that of the row.
    """
    found = _of_folders(row.measured) if row.measured.endswith("*") else _of_file(row)
    runs = found.get("runs") if isinstance(found, dict) else None
    count = len(runs) if isinstance(runs, list) else runs
    if count != row.runs:
        raise BadInput(f"{row.measured}: has {count} runs, expected {row.runs}; run the measurement first")
    return found


def _of_file(row: ResultRow) -> Any:
    path, _, inside = row.measured.partition("#")
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: no results found; run the measurement first") from error
    return _at(content, inside, row)


def _of_folders(pattern: str) -> dict[str, Any]:
    """Score the folders whose names end in a seed: `crossing_2-0`, but not `crossing_2-0-thesis`."""
    folders = [path for path in sorted(Path().glob(pattern)) if path.name.rpartition("-")[2].isdigit()]
    if not folders:
        raise BadInput(f"{pattern}: no runs found; run the measurement first")
    return _of_runs(folders)


def _of_runs(folders: Sequence[Path]) -> dict[str, Any]:
    drives = [figures_of(folder) for folder in folders]
    values = {name: np.array([drive[name] for drive in drives]) for name in drives[0]}
    finite = {name: value[np.isfinite(value)] for name, value in values.items()}
    return {
        "runs": len(folders),
        "scores": to_json(combine([run.scores for run in evaluate_runs(folders)])),
        "mean": {name: float(value.mean()) if value.size else None for name, value in finite.items()},
        "worst": {name: float(value.max()) if value.size else None for name, value in finite.items()},
    }


def _look_up(found: Any, column: ResultColumn, row: ResultRow) -> float | None:
    value = _at(found, column.key, row)
    if value is not None and not isinstance(value, int | float):
        raise BadInput(f"{row.measured}: {column.key} must be a number, got {value!r}")
    return None if value is None else column.factor * value


def _at(content: Any, key: str, row: ResultRow) -> Any:
    """Look up a path such as /thesis/CP; numbers are indices of lists."""
    for step in key.split("/")[1:]:
        try:
            content = content[int(step)] if isinstance(content, list) else content[step]
        except (KeyError, IndexError, TypeError, ValueError) as error:
            raise BadInput(f"{row.measured}: {row.name} has no {key}") from error
    return content


@click.command()
@click.argument("names", metavar="[TABLE]...", nargs=-1)
def main(names: Sequence[str]) -> None:
    """Update these tables from the output of their commands; without a name, list all tables.

    Run `make pages` to show them on the page of results.
    """
    known = read_tables().tables
    for name in names:
        if name not in known:
            raise BadInput(f"unknown table {name!r}; {hint(name, known)}")
    if names:
        taken = {name: take_in(known[name]) for name in names}
        PATH.write_text(as_yaml(ResultTables(tables=known | taken)), encoding="utf-8")
    else:
        for name, table in known.items():
            click.echo(f"{name:20s} {table.recorded}  {table.command}")


if __name__ == "__main__":
    call(main, "benchmarks.results")
