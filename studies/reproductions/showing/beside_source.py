"""Our figures beside the printed ones: how far apart they are, how sure that is, and what follows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from peopleboy.studies.reproductions.experiments.experiment import Samples
from peopleboy.studies.reproductions.showing.intervals import PERCENT, Gap, margin, mean_of, to_source
from peopleboy.studies.reproductions.showing.source import SOURCE, SourceTable
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors

_SECONDS: Final = "s"
_COMPARED: Final = (*PERCENT, _SECONDS)
"""Columns whose figures do not depend on whose computer it was."""


class Standing(StrEnum):
    """How a figure of ours stands beside the source's."""

    BETTER = "better"
    ALIKE = "as the source"
    WORSE = "worse"
    UNCLEAR = "undecided"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Compared:
    """A printed figure, and ours.

    Attributes:
        group, column: which of the table's.
        who: whose ours is.
        source, ours: the two.
        difference: ours less the source's.
        standing: what follows from its interval.
    """

    group: str
    column: str
    who: str
    source: float
    ours: float
    difference: Gap
    standing: Standing

    @property
    def is_below(self) -> bool:
        """Whether ours is the worse of the two, for sure or not."""
        return self.difference.by > 0 if self.column == _SECONDS else self.difference.by < 0


def compare(samples: Samples, table: SourceTable) -> Iterator[Compared]:
    """Set every printed figure that can be compared beside all of ours."""
    for value in table.values:
        for column, (source, deviation) in value.figures.items():
            if value.who != SOURCE or column not in _COMPARED:
                continue
            for line, figures in samples.items():
                ours = figures.get(column)
                if line.group != value.group or ours is None or isinstance(ours, ImageErrors):
                    continue
                away = to_source(column, ours, source, deviation)
                standing = _standing(column, away, source)
                yield Compared(value.group, column, line.who, source, mean_of(ours), away, standing)


def _standing(column: str, away: Gap, source: float) -> Standing:
    """Hold the interval against the margin first: who is within it on both sides is alike."""
    if math.isnan(away.by):
        return Standing.UNKNOWN
    within = margin(column, source)
    if -within <= away.low and away.high <= within:
        return Standing.ALIKE
    if away.low > 0:
        return Standing.WORSE if column == _SECONDS else Standing.BETTER
    if away.high < 0:
        return Standing.BETTER if column == _SECONDS else Standing.WORSE
    return Standing.UNCLEAR
