"""The file of measured figures, docs/results.yaml: tables with how, when and on what they were measured."""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

from peopleboy.bad_input import found_in
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.schema_errors import validated

PATH = Path(__file__).parents[2] / "docs" / "results.yaml"


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Column(_Part):
    """One figure of every row."""

    name: str = Field(description="as the table's head says it")
    form: str = Field(default="{:.1f}", description="how a figure is written, with its unit")
    key: str = Field(default="", description="where the figure stands in what was measured, /thesis/CP")
    factor: float = Field(default=1.0, description="on what was measured")


class Row(_Part):
    """What one scenario, contestant or part came to."""

    name: str
    measured: str = Field(
        default="",
        description="what a command leaves: a JSON file, FILE#/KEY for a part of it, or folders of runs, "
        "runs/NAME-*; empty if it only prints its figures",
    )
    runs: int | None = Field(default=None, ge=1, description="how many runs these figures are of")
    figures: tuple[float | None, ...] = Field(description="one a column; none where nothing was measured")


class ResultTable(_Part):
    """One table of the page of results."""

    command: str
    recorded: str = Field(description="the day on which these figures were put down")
    seeds: str = Field(description="which, in words")
    chosen_on: str = Field(
        default="", description="the scenes on which values of the tracker or behaviour were chosen"
    )
    rows_are: str = Field(default="", description="head of the first column")
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    @model_validator(mode="after")
    def _has_a_figure_for_every_column(self) -> ResultTable:
        for row in self.rows:
            if len(row.figures) != len(self.columns):
                raise ValueError(f"{row.name}: {len(row.figures)} figures for {len(self.columns)} columns")
        return self


class ResultTables(_Part):
    """The whole file."""

    tables: dict[str, ResultTable]


def read_tables(path: Path = PATH) -> ResultTables:
    """Read the file.

    Raises:
        BadInput: it cannot be read, or says something else than tables of figures.
    """
    data = read_yaml(path)
    with found_in(file=str(path)):
        return validated(ResultTables, data)


def as_yaml(tables: ResultTables) -> str:
    """Write the file's text; what is left to its default is left out, as it was."""
    data = tables.model_dump(mode="json", exclude_defaults=True)
    text: str = yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=110, default_flow_style=None)
    return text
