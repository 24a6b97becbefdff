"""The scores of a run: how well people were found, and how well one was followed."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.following_metrics import FollowingScore, FollowingTask, score_following
from scenarios.loop import Tick
from sim.config import WorldConfig
from tracker.evaluation.boxes import iou
from tracker.evaluation.evaluate import Scores, evaluate
from tracker.evaluation.mot_files import read_tracks, read_truth
from tracker.evaluation.table import to_json

BAND_M = 1.2


@dataclass(frozen=True, slots=True, eq=False)
class RunScores:
    """Scores of one run.

    Attributes:
        people: detection, localisation and identity; from the files of the run.
        following: of the first person in the scenario; None if the robot was not to follow anybody.
    """

    people: Scores
    following: FollowingScore | None

    def to_json(self) -> dict[str, Any]:
        """Give all figures as JSON can hold them: None for what is undefined."""
        groups: dict[str, Any] = dict(to_json(self.people))
        if self.following is not None:
            groups["following"] = {
                name: None if isinstance(value, float) and math.isnan(value) else value
                for name, value in asdict(self.following).items()
            }
        return groups


class FollowingLog:
    """Keeps what the scores of following need, tick by tick."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def add(self, tick: Tick) -> None:
        """Take in one tick; the person followed is the scenario's first."""
        truth = tick.truth
        target = next((person for person in truth.people if person.id == 1), None)
        position = (math.nan, math.nan) if target is None else target.position_m
        boxes = np.array([track.box for track in tick.tracks if track.status != "tentative"]).reshape(-1, 4)
        has_box = target is not None and target.box is not None and len(boxes) > 0
        is_tracked = has_box and bool(iou(np.array([target.box]), boxes).max() > 0.5)  # type: ignore[union-attr]
        robot = truth.robot
        self._rows.append(
            (truth.time_s, robot.x, robot.y, robot.heading, *position, is_tracked, bool(truth.contacts))
        )

    def score(self, task: FollowingTask) -> FollowingScore:
        """Score the run so far against what the robot was to do."""
        table = np.array(self._rows, dtype=np.float64)
        return score_following(
            time_s=table[:, 0],
            robot=table[:, 1:4],
            person=table[:, 4:6],
            is_tracked=table[:, 6] > 0.0,
            is_contact=table[:, 7] > 0.0,
            task=task,
        )


def following_task(config: WorldConfig, keep_height: float) -> FollowingTask:
    """Turn the height [image heights] at which a person is to be seen into the distance that shows it so.

    The band reaches 1.2 m to either side of it. It is the first person who is to be followed.
    """
    camera = config.robot.thermal.camera
    shown_px = keep_height * camera.height
    keep_m = camera.focal_px * config.people[0].height_m / shown_px + camera.position_m[0]
    return FollowingTask(keep_m=keep_m, band_m=(keep_m - BAND_M, keep_m + BAND_M))


def score_run(folder: Path, frames: int, following: FollowingScore | None) -> RunScores:
    """Score a run from the truth and tracks in its folder."""
    truth, tracks = read_truth(folder / "truth" / "gt.txt"), read_tracks(folder / "tracks.txt")
    return RunScores(evaluate(truth, tracks, frames=frames), following)
