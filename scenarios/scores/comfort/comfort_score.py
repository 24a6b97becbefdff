"""The scores of comfort, instant by instant, in a run and in an environment alike."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from peopleboy.scenarios.scores.comfort.comfort_metrics import (
    ComfortRun,
    ComfortScore,
    score_comfort,
    time_to_collision,
)
from peopleboy.sim.robot.robot_body import RADIUS_M, outline_gap
from peopleboy.sim.truth.image_free_truth import Bystander, ImageFreeTruth
from peopleboy.sim.truth.truth import PersonTruth, Truth

_BODY_M: Final = 0.25  # radius of the disc that stands for a person


class ComfortLog:
    """Keeps what the scores of comfort need, instant by instant."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def add(self, truth: Truth | ImageFreeTruth) -> None:
        """Take in one instant."""
        robot = truth.robot
        gap_m = min((outline_gap(robot, person.position_m) for person in truth.people), default=math.inf)
        soonest_s = min((_time_to_collision(truth, person) for person in truth.people), default=math.inf)
        self._rows.append((truth.time_s, robot.x, robot.y, robot.heading, gap_m, soonest_s))

    def score(self) -> ComfortScore:
        """Score what happened so far."""
        table = np.array(self._rows, dtype=np.float64)
        return score_comfort(
            ComfortRun(
                time_s=table[:, 0],
                robot=table[:, 1:4],
                gap_m=table[:, 4],
                time_to_collision_s=table[:, 5],
            )
        )


def _time_to_collision(truth: Truth | ImageFreeTruth, person: PersonTruth | Bystander) -> float:
    robot, (speed, _) = truth.robot, truth.robot_velocity
    (x, y), (vx, vy) = person.position_m, person.velocity_m_s
    gap = np.array((x - robot.x, y - robot.y))
    own_x, own_y = speed * math.cos(robot.heading), speed * math.sin(robot.heading)
    return time_to_collision(gap, np.array((vx - own_x, vy - own_y)), RADIUS_M + _BODY_M)
