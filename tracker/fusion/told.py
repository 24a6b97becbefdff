"""What one of the trackers tells of somebody in one frame."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Box, Status, Track


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Told:
    """A track of the thermal tracker, or of the one by depth.

    Attributes:
        id: of the track.
        place_m, error_m2: (2,) in the room [m], (2, 2) of its error [m2].
        status: how well the person is seen.
        confidence: 0..1.
        occluder: id of the same tracker's track that hides it; None for nobody.
        box: in the thermal image [px], as the thermal tracker sees it; None from the other.
        tall_m, span_m: [m] height, and width with the arms; None where the tracker does not measure them.
        looks: (BINS,) histogram of what is seen just now; None where nothing is, or it is dark.
    """

    id: int
    place_m: Floats
    error_m2: Floats
    status: Status
    confidence: float
    occluder: int | None = None
    box: Box | None = None
    tall_m: float | None = None
    span_m: float | None = None
    looks: Floats | None = None

    @property
    def is_seen(self) -> bool:
        """Whether the tracker sees any of the person."""
        return self.status is not Status.TOTALLY_OCCLUDED

    @property
    def is_clear(self) -> bool:
        """Whether nothing hides any of the person."""
        return self.status is Status.TRACKED


def in_room(track: Track, pose: RobotPose) -> tuple[Floats, Floats]:
    """Give place (2,) [m] and covariance (2, 2) [m2] of a track that has a place, in the room."""
    assert track.place is not None
    xx, xy, yy = track.place.covariance_m2
    back = RobotPose(heading=-pose.heading)
    return to_room(np.array(track.place.position_m), pose), back.turned(np.array([[xx, xy], [xy, yy]]))


def to_room(place_m: Floats, pose: RobotPose) -> Floats:
    """Put a place (2,) in the robot's frame into the room."""
    ahead, aside = place_m.tolist()
    return pose.place(math.hypot(ahead, aside), math.atan2(aside, ahead))
