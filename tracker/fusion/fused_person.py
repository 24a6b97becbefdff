"""State of one person, fused from thermal, depth and colour."""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import THERMAL, Floats, Frame
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.panoramic.people.floor_motion import FloorMotion
from peopleboy.tracker.rgbd.observation_model import similarity
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

# Output of one of the trackers for one person in one frame.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorTrack:
    """A track of the thermal or of the depth tracker.

    Attributes:
        id: of the track.
        place_m, error_m2: (2,) position in the room frame [m], and its covariance (2, 2) [m2].
        status: visibility of the person.
        confidence: 0..1.
        occluder: id of the same tracker's occluding track, or None.
        box: in the thermal image [px]; None from the depth tracker.
        tall_m, span_m: [m] height, and width including the arms; None if the tracker does not measure them.
        appearance: (BINS,) current colour histogram; None if not visible or in the dark.
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
    appearance: Floats | None = None

    @property
    def is_seen(self) -> bool:
        """Whether the tracker sees any part of the person."""
        return self.status is not Status.TOTALLY_OCCLUDED

    @property
    def is_clear(self) -> bool:
        """Whether the person is fully visible."""
        return self.status is Status.TRACKED


def to_room_frame(track: Track, pose: Pose2) -> tuple[Floats, Floats]:
    """Return position (2,) [m] and covariance (2, 2) [m2] of a track with a position, in the room frame."""
    assert track.place is not None
    xx, xy, yy = track.place.covariance_m2
    return to_room(np.array(track.place.position_m), pose), pose.inverse().covariance_to_local(
        np.array([[xx, xy], [xy, yy]])
    )


def to_room(place_m: Floats, pose: Pose2) -> Floats:
    """Transform a position (2,) from the robot frame to the room frame."""
    ahead, aside = place_m.tolist()
    return pose.transform_polar(math.hypot(ahead, aside), math.atan2(aside, ahead))


TALL_M: Final = 1.72
WIDE_M: Final = 0.42
SPAN_M: Final = 0.48

_BEST_FIRST: Final = (Status.TRACKED, Status.PARTLY_OCCLUDED, Status.TOTALLY_OCCLUDED)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FusedPerson:
    """A person reported by at least one of the trackers.

    Attributes:
        id: of the fused track; negative while its identity is undecided.
        motion: position and velocity in the room frame.
        heat, depth: ids of its current or last track of the thermal and of the depth tracker.
        warm, deep: their outputs in this frame; None if there are none.
        is_peeked: whether the guided search found the person in the depth image of this frame.
        tall_m, wide_m, span_m: [m] height, and width of the torso and including the arms.
        appearance: (BINS,) colour histogram; None before the first one in the light.
        looked: number of observations of the appearance.
        strange: consecutive frames with a different appearance.
        born_s, seen_s, looked_s: [s] times of creation, of the last observation, and of the last match of
            appearance.
        looked_m: (2,) position of that match in the room frame; None if there was none.
    """

    id: int
    motion: FloorMotion
    heat: int | None = None
    depth: int | None = None
    warm: SensorTrack | None = None
    deep: SensorTrack | None = None
    is_guided: bool = False
    tall_m: float = TALL_M
    wide_m: float = WIDE_M
    span_m: float = SPAN_M
    appearance: Floats | None = None
    appearance_count: int = 0
    strange: int = 0
    born_s: float
    seen_s: float
    appearance_s: float = -math.inf
    appearance_m: Floats | None = None

    @property
    def reported(self) -> tuple[SensorTrack, ...]:
        """The outputs for the person in this frame."""
        return tuple(one for one in (self.warm, self.deep) if one is not None)

    @property
    def is_seen(self) -> bool:
        """Whether the person is seen in this frame."""
        return self.is_guided or any(one.is_seen for one in self.reported)

    @property
    def is_guest(self) -> bool:
        """Whether the identity is undecided."""
        return self.id < 0

    @property
    def status(self) -> Status:
        """Visibility of the person, the best of both trackers."""
        reported = (one.status for one in self.reported)
        best = min(reported, key=_BEST_FIRST.index, default=Status.TOTALLY_OCCLUDED)
        is_found = self.is_guided and best is Status.TOTALLY_OCCLUDED
        return Status.PARTLY_OCCLUDED if is_found else best

    def later(self, dt_s: float, config: FusionConfig) -> "FusedPerson":
        """Return the person predicted to a later time, without outputs."""
        motion = self.motion.later(dt_s, config.restlessness)
        if not self.is_seen:
            motion = motion.slowed(dt_s, config.slow_s)
        return replace(self, motion=motion, warm=None, deep=None, is_guided=False)

    def with_depth(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> "FusedPerson":
        """Update with the depth tracker's track."""
        person = replace(self, depth=reported.id, deep=reported)
        if not reported.is_seen:
            return person
        if reported.is_clear or self.depth is None:
            person = person._measured(reported, 1.0 if self.depth is None else config.learned, config)
        person = person._with_appearance(reported, time_s, config)
        return replace(person, motion=self._placed(reported, config), seen_s=time_s)

    def with_heat(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> "FusedPerson":
        """Update with the thermal tracker's track."""
        person = replace(self, heat=reported.id, warm=reported)
        return (
            replace(person, motion=self._placed(reported, config), seen_s=time_s)
            if reported.is_seen
            else person
        )

    def named(self, other: "FusedPerson") -> "FusedPerson":
        """Return this person with the id, measures and appearance of another."""
        return replace(
            self,
            id=other.id,
            appearance=other.appearance,
            appearance_count=other.appearance_count,
            tall_m=other.tall_m,
            wide_m=other.wide_m,
            span_m=other.span_m,
            born_s=other.born_s,
            strange=0,
        )

    def floor_place(self, pose: Pose2, shared_m: float) -> FloorPlace:
        """Return the person's position in the robot frame.

        Args:
            pose: of the robot in the room frame.
            shared_m: [m] error common to all images of a person.
        """
        x, y = pose.points_to_local(self.motion.place_m).tolist()
        covariance = pose.covariance_to_local(self.motion.place_m2) + np.eye(2) * shared_m**2
        (xx, xy), (_, yy) = covariance.tolist()
        return FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy))

    def _placed(self, reported: SensorTrack, config: FusionConfig) -> FloorMotion:
        further_m = config.clear_m if reported.is_clear else config.partly_m
        return self.motion.corrected(reported.place_m, reported.error_m2 + np.eye(2) * further_m**2)

    def _measured(self, reported: SensorTrack, share: float, config: FusionConfig) -> "FusedPerson":
        """Update height and width."""
        tall = (
            self.tall_m if reported.tall_m is None else self.tall_m + share * (reported.tall_m - self.tall_m)
        )
        if not reported.is_clear:
            return replace(self, tall_m=tall)
        span = (
            self.span_m
            if reported.span_m is None
            else self.span_m + config.learned * (reported.span_m - self.span_m)
        )
        return replace(self, tall_m=tall, span_m=span)

    def _with_appearance(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> "FusedPerson":
        """Update the appearance, but not with that of another person."""
        if reported.appearance is None:
            return self
        if self.appearance is None or self.strange >= config.relearn_frames:
            return replace(
                self,
                appearance=reported.appearance,
                appearance_count=1,
                appearance_s=time_s,
                appearance_m=reported.place_m,
                strange=0,
            )
        if similarity(self.appearance, reported.appearance) < config.least_own:
            return replace(self, strange=self.strange + 1)
        appearance_count = self.appearance_count + 1
        appearance = self.appearance + max(config.learned, 1.0 / appearance_count) * (
            reported.appearance - self.appearance
        )
        return replace(
            self,
            appearance=appearance,
            appearance_count=appearance_count,
            appearance_s=time_s,
            appearance_m=reported.place_m,
            strange=0,
        )


def initiate_person(number: int, reported: SensorTrack, time_s: float) -> FusedPerson:
    """Initiate a person from a tracker's output."""
    motion = FloorMotion.begin(reported.place_m, reported.error_m2)
    return FusedPerson(id=number, motion=motion, born_s=time_s, seen_s=time_s)


# The box of a person in the thermal image, from the sensor that sees it best.

_NEAREST_M: Final = 0.3

# Width of the torso as a share of the height, of the contour's width, and of the width in depth; least
# squares on seed 100 of seven scenarios.
_TORSO: Final = (0.045, 0.32, 0.47)
_TORSO_BY_HEAT: Final = (0.065, 0.715)


def outline(person: FusedPerson, frame: Frame, pose: Pose2) -> Box | None:
    """Return left, top, width, height [px] in the thermal image; the box may lie outside.

    Depth measures head and feet best, and the thermal image the middle. If only one of them sees the person,
    its ends are used.

    Returns:
        None for a person who is not ahead and not in the thermal image.
    """
    contour = _contour(person)
    standing = standing_box(person, THERMAL, frame, pose)
    if contour is None or standing is None:
        return contour or standing
    left, top, width, height = contour
    if person.deep is not None:
        _, top, torso, tall = standing
    else:
        torso, tall = standing[2] * height / standing[3], height
    return left + (width - torso) / 2.0, top, torso, tall


def with_width(person: FusedPerson, frame: Frame, pose: Pose2, share: float) -> FusedPerson:
    """Update the apparent width of the torso, which changes as the person turns, unless partly occluded."""
    contour, standing = _contour(person), standing_box(person, THERMAL, frame, pose)
    if contour is None:
        return person
    _, _, width, height = contour
    deep = person.deep
    if deep is not None and deep.is_clear and deep.span_m is not None and standing is not None:
        tall, by_heat, by_depth = _TORSO
        wide = person.tall_m * (tall + by_heat * width / standing[3]) + by_depth * deep.span_m
    else:
        tall, by_heat = _TORSO_BY_HEAT
        wide = person.tall_m * (tall + by_heat * width / height)
    return replace(person, wide_m=person.wide_m + share * (wide - person.wide_m))


def standing_box(person: FusedPerson, camera: str, frame: Frame, pose: Pose2) -> Box | None:
    """Project an upright person of the estimated measures.

    Returns:
        left, top, width, height [px]; None for a person behind the camera, or a camera that is not planar.
    """
    calibration = frame.calibrations.get(camera)
    x, y = pose.points_to_local(person.motion.place_m).tolist()
    is_flat = isinstance(calibration, PinholeCalibration)
    if calibration is None or not is_flat or x - calibration.position_m[0] < _NEAREST_M:
        return None
    (u, top), (_, bottom) = calibration.project(np.array([[x, y, person.tall_m], [x, y, 0.0]])).tolist()
    width = (bottom - top) * person.wide_m / person.tall_m
    return u - width / 2.0, top, width, bottom - top


def _contour(person: FusedPerson) -> Box | None:
    """Return the thermal tracker's box of a fully visible person."""
    return person.warm.box if person.warm is not None and person.warm.is_clear else None
