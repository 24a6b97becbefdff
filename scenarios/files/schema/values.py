"""Kinds of values that several parts of a scenario file have in common."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from peopleboy.sim.people.body.clothes import COLOURS

Coordinate = Annotated[float, Field(ge=-1000.0, le=1000.0)]
Point = Annotated[tuple[Coordinate, Coordinate], Field(strict=False)]
Position = Annotated[tuple[Coordinate, Coordinate, Coordinate], Field(strict=False)]
Seconds = Annotated[float, Field(ge=0.0, le=36000.0)]
Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]
Celsius = Annotated[float, Field(ge=-40.0, le=400.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Extent = Annotated[float, Field(ge=0.005, le=100.0)]
Size = Annotated[tuple[Extent, Extent, Extent], Field(strict=False)]
Rgb = Annotated[tuple[Share, Share, Share], Field(strict=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,39}$")]
CameraName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
Key = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,59}$")]


def _word_or_list(value: Any) -> str:
    return "word" if isinstance(value, str) else "list"


ColourName = Literal[*COLOURS]  # type: ignore[valid-type]
Colour = Annotated[
    Annotated[ColourName, Tag("word")] | Annotated[Rgb, Tag("list")], Discriminator(_word_or_list)
]
Face = Annotated[Annotated[Name, Tag("word")] | Annotated[Point, Tag("list")], Discriminator(_word_or_list)]


class Strict(BaseModel):
    """Refuses unknown keys, numbers written as text, NaN and infinity."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)
