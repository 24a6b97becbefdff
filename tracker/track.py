"""What a tracker gives out: people, each with an id, a status, and where it is in images and on the floor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

Box = tuple[float, float, float, float]
"""left, top, width, height [px], which may reach outside the image."""


class Status(StrEnum):
    """How well a person is seen right now; unknown for imported tracks."""

    TENTATIVE = "tentative"
    TRACKED = "tracked"
    PARTLY_OCCLUDED = "partly occluded"
    TOTALLY_OCCLUDED = "totally occluded"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlace:
    """A place on the floor, and how sure it is.

    Attributes:
        position_m: x forward, y left in the robot's frame [m].
        covariance_m2: xx, xy, yy of the error's covariance [m2].
    """

    position_m: tuple[float, float]
    covariance_m2: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """One person as the tracker believes it at one instant.

    Attributes:
        id: 1 or more; a person who was forgotten and is found again gets a new one.
        boxes: the person's box in the image of each camera that the tracker places it in, by the camera's
            name; none for a tracker that knows people on the floor alone.
        place: where the person stands; None where that is unknown, as in footage.
        confidence: 0..1, how well the images speak for the person.
        status: whether the person is confirmed, and how much of it is hidden.
        age_s: time since the track was born [s].
        occluder: id of the person in front who hides it; None if nobody does, or nobody known.
    """

    id: int
    boxes: Mapping[str, Box] = field(default_factory=dict)
    place: FloorPlace | None = None
    confidence: float
    status: Status
    age_s: float
    occluder: int | None = None

    def __repr__(self) -> str:
        """Say id, status, confidence and place in a line."""
        parts = [f"id={self.id}", f"{self.status}", f"confidence={self.confidence:.2f}"]
        for camera, box in self.boxes.items():
            parts.append(f"{camera}=({', '.join(f'{value:.1f}' for value in box)})")
        if self.place is not None:
            forward, left = self.place.position_m
            parts.append(f"position_m=({forward:.2f}, {left:.2f})")
        if self.occluder is not None:
            parts.append(f"occluder={self.occluder}")
        return f"Track({', '.join(parts)})"


def confirmed(tracks: Iterable[Track], camera: str) -> Iterator[tuple[Track, Box]]:
    """Yield the tracks that are claimed in the image of a camera, with their boxes there."""
    for track in tracks:
        if track.status is not Status.TENTATIVE and camera in track.boxes:
            yield track, track.boxes[camera]
