"""The scores of following one person, instant by instant, in a run and in an environment alike."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.scores.following_metrics import (
    FollowingRun,
    FollowingScore,
    FollowingTask,
    score_following,
)
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Box, Truth
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.floor import floor_squares
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track

TARGET = 1  # the person to follow: the scenario's first
_LEAST_IOU = 0.5  # a track lies on a person whom it overlaps by more


class FollowingLog:
    """Keeps what the scores of following need, instant by instant."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def add(self, truth: Truth | ImageFreeTruth, track: int, is_wrong: bool | None = None) -> None:
        """Take in one instant.

        Args:
            truth: of the instant.
            track: number of the track that lies on the person to follow, 0 for none.
            is_wrong: whether the robot goes after another person; None if nobody knows.
        """
        robot = truth.robot
        target = next((person for person in truth.people if person.id == TARGET), None)
        position = (math.nan, math.nan) if target is None else target.position_m
        wrong = math.nan if is_wrong is None else float(is_wrong)
        self._rows.append(
            (
                *(truth.time_s, robot.x, robot.y, robot.heading, *position),
                *(bool(truth.contacts), track, wrong),
            )
        )

    def score(self, task: FollowingTask) -> FollowingScore:
        """Score what happened so far against what the robot was to do."""
        return score_instants(np.array(self._rows, dtype=np.float64), task)


def score_instants(table: NDArray[np.float64], task: FollowingTask) -> FollowingScore:
    """Score how one person was followed.

    Args:
        table: (T, 9) of each instant the time [s], the robot's x, y [m] and heading [rad], x, y [m] of the
            person to follow, NaN while away, whether the robot touched anything, the number of the track on
            the person, 0 for none, and whether it went after another person, NaN if nobody knows.
        task: what was asked.
    """
    wrong = table[:, 8]
    run = FollowingRun(
        time_s=table[:, 0],
        robot=table[:, 1:4],
        person=table[:, 4:6],
        is_tracked=table[:, 7] > 0.0,
        is_contact=table[:, 6] > 0.0,
        track=table[:, 7].astype(np.int64),
        is_wrong=None if np.isnan(wrong).any() else wrong > 0.0,
    )
    return score_following(run, task)


class Spot(NamedTuple):
    """Where a person truly is.

    Attributes:
        box: left, top, width, height [px] in the thermal image.
        place_m: [m] forward, left, in the robot's frame.
    """

    box: Box
    place_m: tuple[float, float]


def tracks_on_target(tick: Tick, boxes: BoxKind = BoxKind.TORSO, before: int = 0) -> tuple[int, bool]:
    """Return the number of the track on the person to follow, 0 for none; and whether another is followed.

    Args:
        tick: the instant.
        boxes: what the tracker's boxes are drawn round.
        before: see `track_on`.
    """
    robot, is_whole = tick.truth.robot, boxes is BoxKind.WHOLE
    spots = {
        person.id: Spot(box, robot.to_local(person.position_m))
        for person in tick.truth.people
        if (box := person.whole_box if is_whole else person.box) is not None
    }
    return track_on(spots.get(TARGET), tick.tracks, before), _is_wrong(spots, tick)


def track_on(spot: Spot | None, tracks: Iterable[Track], before: int = 0) -> int:
    """Return the number of the track that lies on a person, 0 if none does well enough.

    Args:
        spot: where the person is.
        tracks: of the instant.
        before: the track that lay there last, 0 for none: as long as it does, no other is taken, however
            well that one lies.
    """
    if spot is None:
        return 0
    lying = [
        (track.id == before, overlap, track.id)
        for track in _sure(tracks)
        if (overlap := _overlap(track, spot)) > _LEAST_IOU
    ]
    return max(lying)[2] if lying else 0


def _is_wrong(spots: dict[int, Spot], tick: Tick) -> bool:
    """Return whether the track that the robot follows lies on another person than the person to follow."""
    for track in _sure(tick.tracks):
        if track.id == tick.following:
            overlaps = [(_overlap(track, spot), number) for number, spot in spots.items()]
            overlap, whose = max(overlaps, default=(0.0, 0))
            return whose != TARGET and overlap > _LEAST_IOU
    return False


def _sure(tracks: Iterable[Track]) -> Iterable[Track]:
    return (track for track in tracks if track.status is not Status.TENTATIVE)


def _overlap(track: Track, spot: Spot) -> float:
    """Return how well a track lies on a person, in 0..1: in the thermal image, or else on the floor."""
    if THERMAL in track.boxes:
        return float(iou(np.array(track.boxes[THERMAL]), np.array(spot.box)))
    if track.place is None:
        return 0.0
    said, true = np.array(track.place.position_m), np.array(spot.place_m)
    return float(iou(floor_squares(said), floor_squares(true)))


def following_task(config: WorldConfig, keep_height: float) -> FollowingTask:
    """Turn the height [image heights] at which a person is to be seen into the distance that shows it so.

    It is the first person who is to be followed; where there is nobody, the distance is the usual one.
    """
    if not config.people:
        return FollowingTask()
    camera = flat_geometry(config.robot.cameras, "thermal")
    shown_px = keep_height * camera.height
    return FollowingTask(keep_m=camera.focal_px * config.people[0].height_m / shown_px + camera.position_m[0])
