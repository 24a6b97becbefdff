"""Tracks of the two trackers, each verified in the image of the other sensor."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Floats, Frame, FreshImages
from peopleboy.tracker.fusion.fused_person import TALL_M, WIDE_M, SensorTrack, to_room_frame
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.rgbd.hypothesis import Detection, Hypothesis
from peopleboy.tracker.rgbd.observation_model import Body
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.sensors.depth_visibility import REACH_M, colours, depth_visibility
from peopleboy.tracker.track import Status, Track

LIT: Final = 40.0
"""Mean grey of the colour image from which colours are usable."""

_EVERY: Final = 16  # every so many pixels are sampled to measure the light
_MISSED_S: Final = 0.15  # after which an undetected person no longer counts as seen
_OWN_M: Final = 0.35  # from a person's position, within which a detection is its own


class Heat:
    """The thermal tracker, without tracks where the depth camera sees the background.

    Args:
        tracker: detects people in the thermal image.
        config: settings.
    """

    def __init__(self, tracker: ContourTracker, config: FusionConfig) -> None:
        self.tracker = tracker
        self._config = config
        self._images = FreshImages(THERMAL)

    def reported(self, frame: Frame, pose: Pose2) -> list[SensorTrack]:
        """Return all tracks; none without a new image."""
        fresh = self._images.of(frame)
        if fresh is None:
            return []
        return [
            _warm(track, pose)
            for track in self.tracker.update(fresh)
            if track.status is not Status.TENTATIVE and not self._is_seen_through(track, frame)
        ]

    def _is_seen_through(self, track: Track, frame: Frame) -> bool:
        if track.place is None:
            return True  # the position is unknown, so that depth cannot disagree
        reach_m = REACH_M + 3.0 * math.sqrt(track.place.covariance_m2[0])
        found = depth_visibility(np.array(track.place.position_m), WIDE_M, TALL_M, frame, reach_m)
        return found is not None and found.beyond > self._config.seen_through


class Depth:
    """The depth tracker, without cold objects.

    Attributes:
        is_lit: whether colours were usable in the last image.

    Args:
        tracker: detects people in the depth image.
        config: settings.
    """

    def __init__(self, tracker: RgbdTracker, config: FusionConfig) -> None:
        self.tracker = tracker
        self._config = config
        self._images = FreshImages(DEPTH)
        self.is_lit = False

    def reported(self, frame: Frame, pose: Pose2) -> list[SensorTrack]:
        """Return all tracks; none without a new image."""
        fresh = self._images.of(frame)
        if fresh is None:
            return []
        tracks = self.tracker.update(fresh)
        explanation = self.tracker.explanation
        assert explanation is not None
        people = {one.id: one for one in explanation.hypotheses}
        self.is_lit = float(frame.rgb(DEPTH_COLOUR)[::_EVERY, ::_EVERY].mean()) > LIT
        reported = []
        for track in tracks:
            person = people[track.id]
            is_found = frame.time_s - person.seen_s < _MISSED_S
            body = _body_of(person, explanation.detections) if is_found else None
            has_appearance = self.is_lit and is_found
            appearance = colours(person.place_m, person.body.head_m, frame) if has_appearance else None
            if not self._is_cold(track, person, frame):
                reported.append(_deep(track, person, body, appearance, pose, is_found=is_found))
        return reported

    def _is_cold(self, track: Track, person: Hypothesis, frame: Frame) -> bool:
        assert track.place is not None
        body = person.body
        found = depth_visibility(np.array(track.place.position_m), body.width_m, body.head_m, frame)
        return found is not None and found.warm is not None and found.warm < self._config.least_warm


def _warm(track: Track, pose: Pose2) -> SensorTrack:
    place, error = to_room_frame(track, pose)
    return SensorTrack(
        id=track.id,
        place_m=place,
        error_m2=error,
        status=track.status,
        confidence=track.confidence,
        occluder=track.occluder,
        box=track.boxes[THERMAL],
    )


def _deep(
    track: Track,
    person: Hypothesis,
    body: Body | None,
    appearance: Floats | None,
    pose: Pose2,
    *,
    is_found: bool,
) -> SensorTrack:
    place, error = to_room_frame(track, pose)
    return SensorTrack(
        id=track.id,
        place_m=place,
        error_m2=error,
        status=track.status if is_found else Status.TOTALLY_OCCLUDED,
        confidence=track.confidence,
        occluder=track.occluder,
        tall_m=(body or person.body).head_m,
        span_m=person.body.width_m,
        appearance=appearance,
    )


def _body_of(person: Hypothesis, detections: Sequence[Detection]) -> Body | None:
    """Return the measurement of the detection nearest to a person, or None."""
    ways = {k: math.dist(one.place_m, person.place_m) for k, one in enumerate(detections)}
    nearest = min(ways, key=lambda k: ways[k], default=None)
    return detections[nearest].body if nearest is not None and ways[nearest] < _OWN_M else None
