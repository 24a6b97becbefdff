"""Fusion of thermal, depth and colour, and of the panorama where one is mounted."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Final

import numpy as np

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.contour.explanation import ContourExplanation
from peopleboy.tracker.frame import DEPTH, PANORAMA, THERMAL, Frame, check_frame
from peopleboy.tracker.fusion.fused_explanations import BothExplanations, FusedExplanation
from peopleboy.tracker.fusion.fused_person import (
    FusedPerson,
    SensorTrack,
    initiate_person,
    outline,
    standing_box,
    to_room,
    with_width,
)
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.handover_tracker import HandoverTracker
from peopleboy.tracker.fusion.identity_resolution import IdentityResolution
from peopleboy.tracker.fusion.sensor_tracks import Depth, Heat
from peopleboy.tracker.fusion.track_to_track import distance2, is_contradicted, pairs
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.rgbd.depth_view import DepthView
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdExplanation, RgbdTracker
from peopleboy.tracker.sensors.depth_visibility import depth_visibility
from peopleboy.tracker.sensors.guided_search import search_near
from peopleboy.tracker.track import Box, Status, Track

# One track per person ahead of the robot, from the thermal image and from depth with colour.

_LONGEST_STEP_S: Final = 0.5
_CROWDED_M: Final = (0.5, 0.7)  # in depth and to the side, within which two people's shoulders merge
_NOBODYS: Final = -1  # stands for the id of no track
_UNSURE: Final = 0.1  # confidence in a person that neither tracker reports

Own = Callable[[FusedPerson], int | None]
Take = Callable[[FusedPerson, SensorTrack], FusedPerson]


class ThermalDepthTracker:
    """People tracked by a thermal tracker and by a depth tracker, with one id each.

    Both trackers run independently. A person has at most one track of each, and one position in the room from
    a Kalman filter over both. A partly occluded person is also searched for in the depth image.

    Args:
        thermal: tracker in the thermal image.
        rgbd: tracker in depth and colour.
        config: settings.
    """

    def __init__(self, thermal: ContourTracker, rgbd: RgbdTracker, config: FusionConfig) -> None:
        self._config = config
        self._heat, self._depth = Heat(thermal, config), Depth(rgbd, config)
        self._pose = Pose2()
        self._people: tuple[FusedPerson, ...] = ()
        self._time_s = -math.inf
        self._numbers, self._guests = count(1), count(-1, -1)

    @property
    def cameras(self) -> tuple[str, ...]:
        """The cameras of both trackers."""
        return (*self._heat.tracker.cameras, *self._depth.tracker.cameras)

    @property
    def explanation(self) -> ContourExplanation:
        """The thermal tracker's explanation, by fused ids."""
        number = {one.warm.id: one.id for one in self._known if one.warm is not None}
        return BothExplanations.of(self._heat.tracker.explanation, None, number).thermal

    @property
    def by_depth(self) -> RgbdExplanation | None:
        """The depth tracker's explanation; None before its first image."""
        return self._depth.tracker.explanation

    def introduce(self, box: Box) -> None:
        """Report that a person is at this box [px] of the thermal image in the next frame."""
        self._heat.tracker.introduce(box)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame, with whichever images it has, and return the reported tracks.

        Raises:
            BadInput: raised by either tracker for an invalid image.
        """
        check_frame(frame)
        if frame.odometry is not None:
            self._pose = self._pose.integrate(frame.odometry.motion)
        dt_s, self._time_s = min(frame.time_s - self._time_s, _LONGEST_STEP_S), frame.time_s
        deep, warm = self._depth.reported(frame, self._pose), self._heat.reported(frame, self._pose)
        people = [one.later(dt_s, self._config) for one in self._people]
        people = self._joined(people, deep, _depth, self._with_depth)
        people = self._joined(people, warm, _heat, self._with_heat)
        people = self._single([self._peeked(one, people, frame) for one in people])
        recognition = IdentityResolution(self._config, frame.time_s, self._depth.is_lit)
        people = recognition.resolve_swaps(recognition.settled(people, self._numbers))
        self._people = tuple(
            with_width(one, frame, self._pose, self._config.learned_width)
            for one in people
            if not self._is_forgotten(one)
        )
        shown = [one for one in self._known if self._is_shown(one, frame)]
        return tuple(self._track(one, frame) for one in sorted(shown, key=lambda one: one.id))

    @property
    def _known(self) -> list[FusedPerson]:
        return [one for one in self._people if not one.is_guest]

    def _with_depth(self, person: FusedPerson, reported: SensorTrack) -> FusedPerson:
        return person.with_depth(reported, self._time_s, self._config)

    def _with_heat(self, person: FusedPerson, reported: SensorTrack) -> FusedPerson:
        if is_contradicted(person, reported, self._config):
            reported = replace(reported, status=Status.TOTALLY_OCCLUDED)
        return person.with_heat(reported, self._time_s, self._config)

    def _joined(
        self, people: Sequence[FusedPerson], reported: Sequence[SensorTrack], own: Own, take: Take
    ) -> list[FusedPerson]:
        """Associate a tracker's tracks with people; an unmatched track becomes a tentative person."""
        found = pairs(people, reported, [own(one) for one in people], self._time_s, self._config)
        joined = [take(one, reported[found[k]]) if k in found else one for k, one in enumerate(people)]
        owners = {reported[m].id: people[k].id for k, m in found.items()}
        joined = [_without(one, own, owners) for one in joined]
        taken = set(found.values())
        for k, one in enumerate(reported):
            if k not in taken and one.is_seen and not self._is_double(one, joined):
                joined.append(take(initiate_person(next(self._guests), one, self._time_s), one))
        return joined

    def _is_double(self, reported: SensorTrack, people: Sequence[FusedPerson]) -> bool:
        """Return whether an unmatched thermal track probably belongs to a person who has another one."""
        gate, floor_m = self._config.own_gate, self._config.floor_m
        return reported.box is not None and any(
            one.is_seen and distance2(one, reported, floor_m) < gate for one in people
        )

    def _peeked(self, person: FusedPerson, people: Sequence[FusedPerson], frame: Frame) -> FusedPerson:
        """Run the guided search for a person whom neither tracker sees fully."""
        config = self._config
        is_due = person.depth is not None and self._time_s - person.seen_s <= config.peek_s
        if not is_due or any(one.is_clear for one in person.reported) or self._is_crowded(person, people):
            return person
        here = self._pose.points_to_local(person.motion.place_m)
        found = search_near(here, person.span_m, person.tall_m, frame)
        if found is None or (found.warm is not None and found.warm < config.peek_warm):
            return person
        place, error = to_room(found.place_m, self._pose), np.eye(2) * config.peek_m**2
        motion = person.motion.corrected(place, error)
        return replace(person, motion=motion, is_guided=True, seen_s=self._time_s)

    def _is_crowded(self, person: FusedPerson, people: Sequence[FusedPerson]) -> bool:
        here, (deep_m, aside_m) = self._pose.points_to_local(person.motion.place_m), _CROWDED_M
        others = (
            self._pose.points_to_local(one.motion.place_m)
            for one in people
            if one is not person and one.is_seen
        )
        return any(abs(x - here[0]) < deep_m and abs(y - here[1]) < aside_m for x, y in others)

    def _single(self, people: Sequence[FusedPerson]) -> list[FusedPerson]:
        """Merge two people at one position, one seen in thermal only and the other in depth only.

        Two people known by their appearance stay separate: the thermal tracker has swapped them.
        """
        kept = list(people)
        for person in people:
            if (
                person not in kept
                or person.deep is None
                or (person.warm is not None and person.warm.is_seen)
                or not person.deep.is_seen
            ):
                continue
            double = next((one for one in kept if self._is_same(person, one)), None)
            if double is not None:
                kept = [part for one in kept for part in self._settled(one, person, double)]
        return kept

    def _settled(self, one: FusedPerson, deep: FusedPerson, double: FusedPerson) -> tuple[FusedPerson, ...]:
        """Assign a thermal track to the person that depth sees there; its former owner is away."""
        if one is double:
            return () if double.appearance is None else (replace(double, warm=None, heat=None),)
        if one is not deep:
            return (one,)
        both = replace(deep, warm=double.warm, heat=double.heat)
        if double.appearance is None and not double.is_guest and (deep.is_guest or double.id < deep.id):
            return (replace(both, id=double.id, born_s=double.born_s),)
        return (both,)

    def _is_same(self, deep: FusedPerson, other: FusedPerson) -> bool:
        warm = other.warm
        if other.deep is not None or warm is None or not warm.is_seen:
            return False
        return distance2(deep, warm, self._config.floor_m) < self._config.gate

    def _is_forgotten(self, person: FusedPerson) -> bool:
        limit_s = self._config.away_s if person.is_guest else self._config.remembered_s
        return self._time_s - person.seen_s > limit_s

    def _is_shown(self, person: FusedPerson, frame: Frame) -> bool:
        """Return whether a person is reported: occluded ones coast for a while, others only briefly."""
        config, late_s = self._config, self._time_s - person.seen_s
        if person.is_seen or late_s > config.hidden_s:
            return person.is_seen
        found = depth_visibility(
            self._pose.points_to_local(person.motion.place_m), person.wide_m, person.tall_m, frame
        )
        if found is not None:
            return found.nearer > config.hidden_share
        return person.warm is not None or late_s <= config.blink_s

    def _track(self, person: FusedPerson, frame: Frame) -> Track:
        boxes = {
            THERMAL: outline(person, frame, self._pose),
            DEPTH: standing_box(person, DEPTH, frame, self._pose),
        }
        return Track(
            id=person.id,
            boxes={camera: box for camera, box in boxes.items() if box is not None},
            place=person.floor_place(self._pose, self._config.shared_m),
            confidence=max((one.confidence for one in person.reported), default=_UNSURE),
            status=person.status,
            age_s=self._time_s - person.born_s,
            occluder=self._occluder_of(person),
        )

    def _occluder_of(self, person: FusedPerson) -> int | None:
        """Return the id of the person who occludes this one, by either tracker, or None."""
        for reported, own in ((person.deep, _depth), (person.warm, _heat)):
            if reported is not None and reported.occluder is not None:
                found = [
                    one.id for one in self._known if own(one) == reported.occluder and one.id != person.id
                ]
                if found:
                    return found[0]
        return None


def _heat(person: FusedPerson) -> int | None:
    return person.heat


def _depth(person: FusedPerson) -> int | None:
    return person.depth


def _without(person: FusedPerson, own: Own, owners: Mapping[int, int]) -> FusedPerson:
    """Remove a track that now belongs to another person, so that it does not switch back and forth."""
    mine = own(person)
    if mine is None or owners.get(mine, person.id) == person.id:
        return person
    return replace(person, heat=_NOBODYS) if own is _heat else replace(person, depth=_NOBODYS)


class FusedTracker:
    """Combines detection in thermal, position from depth and identity from colour.

    Args:
        ahead: tracker in thermal, depth and colour.
        panoramic: tracker in the panorama, used if the robot carries that camera.
    """

    def __init__(self, ahead: ThermalDepthTracker, panoramic: PanoramicTracker) -> None:
        self._ahead, self._panoramic = ahead, panoramic
        self._round: HandoverTracker | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The required cameras; the panorama is used where it is mounted."""
        return self._ahead.cameras

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse an unusable depth camera, and a panoramic camera without a trained model.

        Raises:
            BadInput: a camera is unusable.
        """
        DepthView.of(calibrations.get(DEPTH), DEPTH)
        if PANORAMA in calibrations:
            self._panoramic.check_cameras(calibrations)

    @property
    def explanation(self) -> FusedExplanation:
        """The explanations of all parts."""
        both = (
            BothExplanations(self._ahead.explanation, None)
            if self._round is None
            else self._round.explanation
        )
        return FusedExplanation(both, self._ahead.by_depth)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame, with whichever images it has, and return the reported tracks.

        Raises:
            BadInput: raised by the parts for an invalid image.
        """
        check_frame(frame)
        if PANORAMA not in frame.calibrations:
            return self._ahead.update(frame)
        if self._round is None:
            self._round = HandoverTracker(self._ahead, self._panoramic)
        return self._round.update(frame)
