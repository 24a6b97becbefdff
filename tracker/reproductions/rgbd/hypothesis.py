"""Hypotheses: confirmed and tentative people of the RGB-D tracker."""

from dataclasses import dataclass

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.reproductions.rgbd.floor_filter import FloorFilter
from peopleboy.tracker.reproductions.rgbd.observation_model import Body
from peopleboy.tracker.sensors.depth.pre_detection import PreDetection
from peopleboy.tracker.track import Status


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hypothesis:
    """A person on the floor (SA eq. 4.17).

    Attributes:
        id: of the track; 0 until it is confirmed.
        place_m: (2,) forward, left in the robot frame [m].
        velocity_m_s: (2,) smoothed.
        covariance_m2: (2, 2) of the position.
        body: size and appearance.
        filter: its particles.
        born_s, verified_s, seen_s: [s] times of creation, last verification, and last detection or filter
            match.
        verifications: their number, up to the one needed for confirmation.
        seen_through: consecutive frames in which the background was visible.
        confidence: 0..1.
        status: visibility of the person, and whether it is confirmed.
        occluder: id of the occluding track, or None.
    """

    id: int = 0
    place_m: Floats
    velocity_m_s: Floats
    covariance_m2: Floats
    body: Body
    filter: FloorFilter
    born_s: float
    verified_s: float
    seen_s: float
    verifications: int = 1
    seen_through: int = 0
    confidence: float = 0.5
    status: Status = Status.TENTATIVE
    occluder: int | None = None


# Detections of a frame: on the floor, with a size, and classified as human or not.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detection:
    """An object of human size.

    Attributes:
        found: pre-detection in the depth image.
        place_m: (2,) forward, left in the robot frame [m].
        body: size and appearance.
        score: of its window, above 0 for a human.
        is_verified: whether it is classified as a human.
    """

    found: PreDetection
    place_m: Floats
    body: Body
    score: float
    is_verified: bool
