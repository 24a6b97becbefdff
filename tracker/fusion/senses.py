"""The two trackers, and what of their tracks each other's image confirms."""

from __future__ import annotations

import math
from typing import Final, Protocol

import numpy as np

from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Frame
from peopleboy.tracker.fusion.fresh_images import FreshImages
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.glance import Glance, depth_of, glance_at
from peopleboy.tracker.fusion.person import TALL_M, WIDE_M
from peopleboy.tracker.fusion.told import Told, in_room
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.rgbd.detection.depth_view import DepthView
from peopleboy.tracker.rgbd.people.hypothesis import Hypothesis
from peopleboy.tracker.rgbd.people.look_at import Body, box_at
from peopleboy.tracker.rgbd.people.looks import BINS
from peopleboy.tracker.rgbd.rgbd_explanation import RgbdExplanation
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.track import Status, Track

LIT: Final = 40.0
"""Mean of the colour image from which on colours mean anything."""

_EVERY: Final = 16  # pixels from one that is looked at for light to the next
_MISSED_S: Final = 0.15  # without a detection, after which somebody is not seen any more
_BODY_M: Final = 0.1
_REACH_M: Final = 0.4
_ANYBODY: Final = Body(width_m=WIDE_M, head_m=TALL_M, low_m=0.0, looks=np.zeros(BINS))


class Heat:
    """What the thermal tracker tells, but for those through whom depth is seen."""

    def __init__(self, tracker: PeopleTracker, config: FusionConfig) -> None:
        self.tracker = tracker
        self._config = config
        self._images = FreshImages(THERMAL)

    def told(self, frame: Frame, pose: RobotPose) -> list[Told] | None:
        """Give who is told of; None without a new image."""
        fresh = self._images.of(frame)
        if fresh is None:
            return None
        tracks = [one for one in self.tracker.update(fresh) if one.status is not Status.TENTATIVE]
        return [
            self._told(track, pose)
            for track in tracks
            if track.place is not None and not self._is_seen_through(track, frame)
        ]

    def _told(self, track: Track, pose: RobotPose) -> Told:
        place, error = in_room(track, pose)
        return Told(
            id=track.id,
            place_m=place,
            error_m2=error,
            status=track.status,
            confidence=track.confidence,
            occluder=track.occluder,
            box=track.boxes[THERMAL],
        )

    def _is_seen_through(self, track: Track, frame: Frame) -> bool:
        assert track.place is not None
        reach = _REACH_M + 3.0 * math.sqrt(track.place.covariance_m2[0])
        found = glance_for(np.array(track.place.position_m), _ANYBODY, reach, frame)
        return found is not None and found.beyond > self._config.seen_through


class Depth:
    """What the tracker by depth tells, but for those who are cold."""

    def __init__(self, tracker: RgbdTracker, config: FusionConfig) -> None:
        self.tracker = tracker
        self._config = config
        self._images = FreshImages(DEPTH)

    def told(self, frame: Frame, pose: RobotPose) -> list[Told] | None:
        """Give who is told of; None without a new image."""
        fresh = self._images.of(frame)
        if fresh is None:
            return None
        tracks = self.tracker.update(fresh)
        explanation = self.tracker.explanation
        assert explanation is not None
        people = {one.id: one for one in explanation.hypotheses}
        is_lit = float(frame.rgb(DEPTH_COLOUR)[::_EVERY, ::_EVERY].mean()) > LIT
        told = (self._told(track, people[track.id], explanation.detections, frame, pose, is_lit=is_lit) for track in tracks)
        return [one for one in told if one is not None]

    def _told(
        self, track: Track, person: Hypothesis, detections, frame: Frame, pose: RobotPose, *, is_lit: bool
    ) -> Told | None:
        assert track.place is not None
        found = glance_for(np.array(track.place.position_m), person.body, _REACH_M, frame)
        if found is not None and found.warm is not None and found.warm < self._config.least_warm:
            return None
        is_seen = frame.time_s - person.seen_s < _MISSED_S
        place, error = in_room(track, pose)
        near = [(float(np.hypot(*(d.place_m - person.place_m))), k) for k, d in enumerate(detections)] if is_seen else []
        body = detections[min(near)[1]].body if near and min(near)[0] < 0.35 else None
        return Told(
            id=track.id,
            place_m=place,
            error_m2=error,
            status=track.status if is_seen else Status.TOTALLY_OCCLUDED,
            confidence=track.confidence,
            occluder=track.occluder,
            tall_m=person.body.head_m if body is None else body.head_m,
            span_m=person.body.width_m,
            looks=body.looks if is_lit and body is not None else None,
        )


def glance_for(place_m: np.ndarray[tuple[int], np.dtype[np.float64]], body: Body, reach_m: float, frame: Frame) -> Glance | None:
    """Look for somebody at a place (2,) in the robot's frame in the depth image; None where that is not seen."""
    if DEPTH not in frame.images or DEPTH not in frame.calibrations:
        return None
    view = DepthView.of(frame.calibrations[DEPTH], DEPTH)
    box = box_at(view, place_m, body)
    return None if box[2] <= 0.0 else glance_at(box, depth_of(place_m, frame) - _BODY_M, reach_m, frame)
