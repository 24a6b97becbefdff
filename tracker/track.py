"""Output of a tracker: people with ids, statuses, boxes in images, and positions on the floor."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

Box = tuple[float, float, float, float]
"""left, top, width, height [px]; it may reach outside the image."""


class Status(StrEnum):
    """Visibility of a person; unknown for imported tracks."""

    TENTATIVE = "tentative"
    TRACKED = "tracked"
    PARTLY_OCCLUDED = "partly occluded"
    TOTALLY_OCCLUDED = "totally occluded"
    UNKNOWN = "unknown"


class TrackPosture(StrEnum):
    """Posture of a tracked person; people who stand or walk are upright."""

    UPRIGHT = "upright"
    SITTING = "sitting"
    BENDING = "bending"
    CROUCHING = "crouching"
    LYING = "lying"


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlace:
    """A position on the floor and, if known, the velocity, with their uncertainties.

    Attributes:
        position_m: x forward, y left in the robot frame [m].
        covariance_m2: xx, xy, yy of the error covariance [m2].
        velocity_m_s: velocity relative to the floor along the same axes [m/s]; None if unknown.
        velocity_covariance_m2_s2: xx, xy, yy of its error covariance [m2/s2]; None if unknown.
    """

    position_m: tuple[float, float]
    covariance_m2: tuple[float, float, float]
    velocity_m_s: tuple[float, float] | None = None
    velocity_covariance_m2_s2: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """One tracked person at one instant.

    Attributes:
        id: 1 or more; a person who was forgotten and is found again gets a new id.
        boxes: the person's box in each camera image in which the tracker locates it, by camera name; empty
            for a tracker that works on the floor only.
        place: position on the floor; None if unknown, as in footage.
        confidence: 0..1, how well the images support the track.
        status: whether the person is confirmed, and how much of the person is occluded.
        age_s: time since the track was initiated [s].
        occluder: id of the person who occludes this one; None if there is none, or none known.
        posture: posture of the person; None if the detector does not recognise postures.
        edges: left and right edge of the whole person, from the middle of the boxes to the right, in heights
            of the boxes; None if unknown.
    """

    id: int
    boxes: Mapping[str, Box] = field(default_factory=dict)
    place: FloorPlace | None = None
    confidence: float
    status: Status
    age_s: float
    occluder: int | None = None
    posture: TrackPosture | None = None
    edges: tuple[float, float] | None = None

    def __repr__(self) -> str:
        """Return id, status, confidence and position in one line."""
        parts = [f"id={self.id}", f"{self.status}", f"confidence={self.confidence:.2f}"]
        for camera, box in self.boxes.items():
            parts.append(f"{camera}=({', '.join(f'{value:.1f}' for value in box)})")
        if self.place is not None:
            forward, left = self.place.position_m
            parts.append(f"position_m=({forward:.2f}, {left:.2f})")
        if self.occluder is not None:
            parts.append(f"occluder={self.occluder}")
        if self.posture is not None:
            parts.append(str(self.posture))
        return f"Track({', '.join(parts)})"


def confirmed(tracks: Iterable[Track], camera: str) -> Iterator[tuple[Track, Box]]:
    """Yield the tracks with a box in a camera's image, with these boxes."""
    for track in tracks:
        if track.status is not Status.TENTATIVE and camera in track.boxes:
            yield track, track.boxes[camera]
