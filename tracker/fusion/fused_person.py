"""One person, as heat, depth and colour tell together."""

from __future__ import annotations

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

# What one of the trackers reports for a person in one frame.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorTrack:
    """A track of the thermal tracker, or of the one by depth.

    Attributes:
        id: of the track.
        place_m, error_m2: (2,) in the room [m], (2, 2) of its error [m2].
        status: how well the person is seen.
        confidence: 0..1.
        occluder: id of the same tracker's track that hides it; None for nobody.
        box: in the thermal image [px], as the thermal tracker sees it; None from the other.
        tall_m, span_m: [m] height, and width with the arms; None where the tracker does not measure them.
        appearance: (BINS,) histogram of what is seen just now; None where nothing is, or it is dark.
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
        """Whether the tracker sees any of the person."""
        return self.status is not Status.TOTALLY_OCCLUDED

    @property
    def is_clear(self) -> bool:
        """Whether nothing hides any of the person."""
        return self.status is Status.TRACKED


def to_room_frame(track: Track, pose: Pose2) -> tuple[Floats, Floats]:
    """Return place (2,) [m] and covariance (2, 2) [m2] of a track that has a place, in the room."""
    assert track.place is not None
    xx, xy, yy = track.place.covariance_m2
    return to_room(np.array(track.place.position_m), pose), pose.inverse().covariance_to_local(
        np.array([[xx, xy], [xy, yy]])
    )


def to_room(place_m: Floats, pose: Pose2) -> Floats:
    """Put a place (2,) in the robot's frame into the room."""
    ahead, aside = place_m.tolist()
    return pose.transform_polar(math.hypot(ahead, aside), math.atan2(aside, ahead))


TALL_M: Final = 1.72
WIDE_M: Final = 0.42
SPAN_M: Final = 0.48

_BEST_FIRST: Final = (Status.TRACKED, Status.PARTLY_OCCLUDED, Status.TOTALLY_OCCLUDED)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FusedPerson:
    """A person that at least one of the trackers has reported.

    Attributes:
        id: number of the fused track; negative for a guest, whose identity is not decided yet.
        motion: place and velocity in the room.
        heat, depth: ids of the tracks in the thermal and in the depth image that are, or were last, its own.
        warm, deep: what these tell in this frame; None for nothing.
        is_peeked: whether it was found where it was expected in the depth image of this frame.
        tall_m, wide_m, span_m: [m] height, and width of the torso and with the arms.
        appearance: (BINS,) histogram of colours; None before any were seen in the light.
        looked: how often these were seen.
        strange: frames in a row in which it looked otherwise.
        born_s, seen_s, looked_s: [s] when it was born, last seen, and last known by its appearance.
        looked_m: (2,) where that was in the room; None for nowhere.
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
        """What is reported for the person in this frame."""
        return tuple(one for one in (self.warm, self.deep) if one is not None)

    @property
    def is_seen(self) -> bool:
        """Whether the person is seen in this frame."""
        return self.is_guided or any(one.is_seen for one in self.reported)

    @property
    def is_guest(self) -> bool:
        """Whether it is not decided who this is."""
        return self.id < 0

    @property
    def status(self) -> Status:
        """How well the tracker that sees the person best does."""
        reported = (one.status for one in self.reported)
        best = min(reported, key=_BEST_FIRST.index, default=Status.TOTALLY_OCCLUDED)
        is_found = self.is_guided and best is Status.TOTALLY_OCCLUDED
        return Status.PARTLY_OCCLUDED if is_found else best

    def later(self, dt_s: float, config: FusionConfig) -> FusedPerson:
        """Return the person after it has walked on; it is not reported yet."""
        motion = self.motion.later(dt_s, config.restlessness)
        if not self.is_seen:
            motion = motion.slowed(dt_s, config.slow_s)
        return replace(self, motion=motion, warm=None, deep=None, is_guided=False)

    def with_depth(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> FusedPerson:
        """Update by the depth tracker's track."""
        person = replace(self, depth=reported.id, deep=reported)
        if not reported.is_seen:
            return person
        if reported.is_clear or self.depth is None:
            person = person._measured(reported, 1.0 if self.depth is None else config.learned, config)
        person = person._with_appearance(reported, time_s, config)
        return replace(person, motion=self._placed(reported, config), seen_s=time_s)

    def with_heat(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> FusedPerson:
        """Update by the thermal tracker's track."""
        person = replace(self, heat=reported.id, warm=reported)
        return (
            replace(person, motion=self._placed(reported, config), seen_s=time_s)
            if reported.is_seen
            else person
        )

    def named(self, other: FusedPerson) -> FusedPerson:
        """Return who is here, with the id, the measures and the appearance of another."""
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
        """Return where the person stands in the robot's frame.

        Args:
            pose: of the robot in the room.
            shared_m: [m] error that all images of a person have in common.
        """
        x, y = pose.points_to_local(self.motion.place_m).tolist()
        covariance = pose.covariance_to_local(self.motion.place_m2) + np.eye(2) * shared_m**2
        (xx, xy), (_, yy) = covariance.tolist()
        return FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy))

    def _placed(self, reported: SensorTrack, config: FusionConfig) -> FloorMotion:
        further_m = config.clear_m if reported.is_clear else config.partly_m
        return self.motion.corrected(reported.place_m, reported.error_m2 + np.eye(2) * further_m**2)

    def _measured(self, reported: SensorTrack, share: float, config: FusionConfig) -> FusedPerson:
        """Learn height and width."""
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

    def _with_appearance(self, reported: SensorTrack, time_s: float, config: FusionConfig) -> FusedPerson:
        """Learn the appearance, but not that of another person."""
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
    """Initiate a person where a tracker reports one."""
    motion = FloorMotion.begin(reported.place_m, reported.error_m2)
    return FusedPerson(id=number, motion=motion, born_s=time_s, seen_s=time_s)


# The box of a person in the thermal image, from the sensors that see it best.

_NEAREST_M: Final = 0.3

# Width of the torso as a share of the height, of the contour's width, and of the width by depth; by least
# squares on seed 100 of seven scenarios.
_TORSO: Final = (0.045, 0.32, 0.47)
_TORSO_BY_HEAT: Final = (0.065, 0.715)


def outline(person: FusedPerson, frame: Frame, pose: Pose2) -> Box | None:
    """Return left, top, width, height [px] in the thermal image, which may lie outside.

    Depth knows best where head and feet are, heat where the middle is. Whom only one of them sees has the
    ends of that one.

    Returns:
        None for who is not ahead, and not in the thermal image either.
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
    """Learn how wide the torso appears, which changes as the person turns; not of who is hidden in part."""
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
    """Project a person, upright at its place, in its own measures.

    Returns:
        left, top, width, height [px]; None for who is not before a camera, or one whose image is not flat.
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
    """Return the thermal tracker's box of who is seen whole."""
    return person.warm.box if person.warm is not None and person.warm.is_clear else None
