"""Where each table and figure of the sources on people tracking stands, from the data file."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field, RootModel, model_validator

from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.schema.values import Strict

_PATH: Final = Path(__file__).with_name("source_contents.yaml")


class Item(Strict):
    """A table or figure of a source, or a passage with figures."""

    what: str
    """its number there"""
    shows: str
    """what it is about"""
    here: Annotated[tuple[str, ...], Field(strict=False)] = ()
    """ids of our experiments"""
    why: str = ""
    """where else it is, or why there is nothing to measure"""

    @model_validator(mode="after")
    def _stands_somewhere(self) -> Item:
        if bool(self.here) == bool(self.why):
            raise ValueError("give either ids of experiments or words")
        return self


class _Sources(RootModel[dict[str, Annotated[tuple[Item, ...], Field(strict=False)]]]):
    """All of them by source."""


@cache
def source_contents() -> dict[str, tuple[Item, ...]]:
    """List what the sources have, by their names as `--paper` has them, in their order."""
    data: dict[Any, Any] = read_yaml(_PATH)
    return _Sources.model_validate(data).root
