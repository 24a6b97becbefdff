"""What a tracker gives out: people, each with an id, a status and a box."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """How well a person is seen right now."""

    TENTATIVE = "tentative"
    TRACKED = "tracked"
    PARTLY_OCCLUDED = "partly occluded"
    TOTALLY_OCCLUDED = "totally occluded"


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """One person as the tracker believes it at one instant.

    Attributes:
        id: 1 or more; a person who was forgotten and is found again gets a new one.
        box: left, top, width, height [px], which may reach outside the image.
        confidence: 0..1, how well the image speaks for the person.
        status: whether the person is confirmed, and how much of it is hidden.
        age_s: time since the track was born [s].
        occluder: id of the person in front who hides it; None if nobody does, or nobody known.
    """

    id: int
    box: tuple[float, float, float, float]
    confidence: float
    status: Status
    age_s: float
    occluder: int | None = None
