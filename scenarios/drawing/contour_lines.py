"""What a tracker's explanation has to draw around its tracks, by the kind of explanation."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.attention.people.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.fusion.explanations import BothExplanations
from peopleboy.tracker.thermal.contour.outline import outline
from peopleboy.tracker.thermal.explanation import ContourExplanation

Line = NDArray[np.float64]  # (K, 2) [px] in the thermal image


@singledispatch
def lines_of(explanation: object, points: int = 48) -> Mapping[int, tuple[Line, ...]]:  # noqa: ARG001
    """Give lines of so many points around people, by track id; none for a kind that nobody can draw.

    A new kind of explanation registers here how it is drawn on still pictures.
    """
    return {}


@lines_of.register
def _(explanation: ContourExplanation, points: int = 48) -> Mapping[int, tuple[Line, ...]]:
    return {number: outline(ellipse, points) for number, ellipse in explanation.ellipses.items()}


@lines_of.register
def _(explanation: BothExplanations, points: int = 48) -> Mapping[int, tuple[Line, ...]]:
    return lines_of(explanation.thermal, points)


@lines_of.register
def _(explanation: AttentiveExplanation, points: int = 48) -> Mapping[int, tuple[Line, ...]]:
    return lines_of(explanation.below, points)
