"""Tracks made by hand, of either camera of the handover."""

from __future__ import annotations

from typing import Any

from peopleboy.tracker.track import FloorPlace, Status, Track


def track(
    number: int,
    at_m: tuple[float, float] | None = (3.0, 0.0),
    *,
    deviation_m: float = 0.1,
    age_s: float = 5.0,
    status: Status = Status.TRACKED,
    **further: Any,
) -> Track:
    """Somebody at a place, sure to so many metres all round."""
    variance = deviation_m**2
    place = None if at_m is None else FloorPlace(position_m=at_m, covariance_m2=(variance, 0.0, variance))
    return Track(id=number, place=place, age_s=age_s, status=status, **{"confidence": 0.9} | further)
