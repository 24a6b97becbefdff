"""What a tracker's explanation adds to the rows of the tracks table, and how it is read back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from functools import singledispatch
from typing import Any

from peopleboy.tracker.attention.people.attentive_explanation import AttentiveExplanation
from peopleboy.tracker.fusion.explanations import BothExplanations, FusedExplanation
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.explanation import ContourExplanation
from peopleboy.tracker.thermal.variants import VARIANTS

STATE = ("x", "y", "w", "h", "d", "vx", "vy", "vw", "vh")
SPREAD = "uncertainty_px2"
COLUMNS = (SPREAD, *STATE)
"""Columns of the tracks table that have no value for trackers without contours."""

_NOTHING: Mapping[str, Any] = dict.fromkeys(COLUMNS)


@singledispatch
def explained(explanation: object, track: int) -> Mapping[str, Any]:  # noqa: ARG001
    """Give the values of `COLUMNS` for a track; None for a kind of explanation without them."""
    return _NOTHING


@explained.register
def _(explanation: ContourExplanation, track: int) -> Mapping[str, Any]:
    return {SPREAD: explanation.spread_px2[track], **asdict(explanation.ellipses[track])}


@explained.register
def _(explanation: BothExplanations, track: int) -> Mapping[str, Any]:
    return explained(explanation.thermal, track) if track in explanation.thermal.ellipses else _NOTHING


@explained.register
def _(explanation: FusedExplanation, track: int) -> Mapping[str, Any]:
    return explained(explanation.both, track)


@explained.register
def _(explanation: AttentiveExplanation, track: int) -> Mapping[str, Any]:
    return explained(explanation.below, track)


def read_explanation(tracker: str, rows: Iterable[Mapping[str, Any]]) -> ContourExplanation | None:
    """Read back what a tracker of that name explained at one frame; None if its rows hold nothing of it."""
    told = [row for row in rows if row[SPREAD] is not None]
    if not told or tracker not in VARIANTS:
        return None
    return ContourExplanation(
        config=VARIANTS[tracker],
        ellipses={row["id"]: Ellipse(**{name: row[name] for name in STATE}) for row in told},
        spread_px2={row["id"]: row[SPREAD] for row in told},
    )
