"""The scores of following one person, from a run's ticks and what the robot was asked."""

from __future__ import annotations

import math

import numpy as np

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.scores.following_metrics import (
    FollowingRun,
    FollowingScore,
    FollowingTask,
    score_following,
)
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.robot.robot_body import outline_gap
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.evaluation.boxes import iou
from peopleboy.tracker.evaluation.floor import floor_squares
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track

BAND_M = 1.2


class FollowingLog:
    """Keeps what the scores of following need, tick by tick; the person to follow is the scenario's first."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def add(self, tick: Tick) -> None:
        """Take in one tick."""
        truth, robot = tick.truth, tick.truth.robot
        target = next((person for person in truth.people if person.id == 1), None)
        position = (math.nan, math.nan) if target is None else target.position_m
        track, is_wrong = _whose_track(tick)
        gap_m = min((outline_gap(robot, person.position_m) for person in truth.people), default=math.inf)
        self._rows.append(
            (
                *(truth.time_s, robot.x, robot.y, robot.heading, *position),
                *(track > 0, bool(truth.contacts), track, is_wrong, gap_m),
            )
        )

    def score(self, task: FollowingTask) -> FollowingScore:
        """Score the run so far against what the robot was to do."""
        table = np.array(self._rows, dtype=np.float64)
        run = FollowingRun(
            time_s=table[:, 0],
            robot=table[:, 1:4],
            person=table[:, 4:6],
            is_tracked=table[:, 6] > 0.0,
            is_contact=table[:, 7] > 0.0,
            track=table[:, 8].astype(np.int64),
            is_wrong=table[:, 9] > 0.0,
            gap_m=table[:, 10],
        )
        return score_following(run, task)


def _whose_track(tick: Tick) -> tuple[int, bool]:
    """Give the number of the track on the first person, 0 for none; and whether somebody else is followed."""
    tracks = [track for track in tick.tracks if track.status is not Status.TENTATIVE]
    people = [person for person in tick.truth.people if person.box is not None]
    mine, is_wrong = (0.5, 0), False
    for track in tracks:
        covers = [(_overlap(track, person, tick.truth.robot), person.id) for person in people]
        overlap, whose = max(covers, default=(0.0, 0))
        is_wrong |= track.id == tick.following and whose != 1 and overlap > 0.5
        mine = max([mine, *((share, track.id) for share, owner in covers if owner == 1)])
    return mine[1], is_wrong


def _overlap(track: Track, person: PersonTruth, robot: Planar) -> float:
    """Tell how well a track lies on a person, in 0..1: in the thermal image, or else on the floor."""
    if THERMAL in track.boxes:
        return float(iou(np.array(track.boxes[THERMAL]), np.array(person.box)))
    if track.place is None:
        return 0.0
    said, true = np.array(track.place.position_m), np.array(robot.locate(person.position_m))
    return float(iou(floor_squares(said), floor_squares(true)))


def following_task(config: WorldConfig, keep_height: float) -> FollowingTask:
    """Turn the height [image heights] at which a person is to be seen into the distance that shows it so.

    The band reaches 1.2 m to either side of it. It is the first person who is to be followed.
    """
    camera = flat_geometry(config.robot.cameras, "thermal")
    shown_px = keep_height * camera.height
    keep_m = camera.focal_px * config.people[0].height_m / shown_px + camera.position_m[0]
    return FollowingTask(keep_m=keep_m, band_m=(keep_m - BAND_M, keep_m + BAND_M))
