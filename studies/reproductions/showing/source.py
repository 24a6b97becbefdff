"""What the sources say: their figures and claims, from the data file."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, RootModel, ValidationError, model_validator

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.schema.values import Strict

PATH = Path(__file__).with_name("source_figures.yaml")
SOURCE = "source"

Number = Annotated[float, Field(allow_inf_nan=False)]
Figure = Number | Annotated[tuple[Number, Number], Field(strict=False)]


class Value(Strict):
    """One line of a table; further keys are columns."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Figure]

    group: str
    """what is varied"""
    who: str = SOURCE
    """whose figures, where the source has several, such as computers"""

    @property
    def figures(self) -> dict[str, tuple[float, float | None]]:
        """Mean and deviation by column."""
        return {
            name: value if isinstance(value, tuple) else (value, None)
            for name, value in (self.__pydantic_extra__ or {}).items()
        }


class Claim(Strict):
    """A sentence of the source that can be checked."""

    says: str
    """in our words"""
    metric: str
    """column that it is about"""
    groups: Annotated[tuple[str, str], Field(strict=False)]
    """the first compared with the second"""
    expect: Literal["more", "less", "alike", "no less", "differs"]
    """what the first is, or that they differ either way"""
    by: Number | None = None
    """difference in points that the source gives"""
    times: Number | None = None
    """how many times the second's figure the source says that the first's is"""
    tested: bool = False
    """whether the source has a paired t-test"""


class SourceTable(Strict):
    """One table or figure."""

    title: str
    source: str
    note: str = ""
    picture: str = ""
    """what the source's figure shows, where it is a picture"""
    values: Annotated[tuple[Value, ...], Field(strict=False)] = ()
    claims: Annotated[tuple[Claim, ...], Field(strict=False)] = ()

    @model_validator(mode="after")
    def _says_something(self) -> SourceTable:
        if not (self.values or self.claims or self.picture):
            raise ValueError("give values, claims or what a picture shows")
        return self


class _Tables(RootModel[dict[str, SourceTable]]):
    """All of them by id."""


@cache
def source_tables(path: Path = PATH) -> dict[str, SourceTable]:
    """Read the data file.

    Raises:
        BadInput: the file is wrong.
    """
    data: dict[Any, Any] = read_yaml(path)
    try:
        return _Tables.model_validate(data).root
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(key) for key in first["loc"])
        raise BadInput(f"{path}: {place}: {first['msg']}, got {first['input']!r}") from None
