"""The scores of comfort, instant by instant, in a run and in an environment alike."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.scores.comfort.comfort_metrics import (
    ComfortRun,
    ComfortScore,
    score_comfort,
    times_to_collision,
)
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.robot.robot_body import RADIUS_M, outline_gap
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth

_BODY_M: Final = 0.25  # radius of the disc that stands for a person


class ComfortLog:
    """Keeps what the scores of comfort need, instant by instant, and works out the rest when asked."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._people: list[tuple[float, ...]] = []

    def add(self, truth: Truth | ImageFreeTruth) -> None:
        """Take in one instant."""
        robot, (speed, _), people = truth.robot, truth.robot_velocity, truth.people
        self._rows.append((truth.time_s, robot.x, robot.y, robot.heading, speed, len(people)))
        self._people += [(*person.position_m, *person.velocity_m_s) for person in people]

    def score(self) -> ComfortScore:
        """Score what happened so far."""
        people = np.array(self._people, dtype=np.float64).reshape(-1, 4)
        return score_company(np.array(self._rows, dtype=np.float64), people)


def score_company(table: NDArray[np.float64], people: NDArray[np.float64]) -> ComfortScore:
    """Score how a robot drove among people.

    Args:
        table: (T, 6) of each instant the time [s], the robot's x, y [m], heading [rad] and forward speed
            [m/s], and how many people were there.
        people: (Q, 4) x, y [m] and velocity [m/s] of all of them, one instant after the other.
    """
    row = np.repeat(np.arange(len(table)), table[:, 5].astype(np.int64))
    gap_m, soonest_s = np.full((2, len(table)), np.inf)
    np.minimum.at(gap_m, row, _gaps(table[row], people))
    np.minimum.at(soonest_s, row, _times_to_collision(table[row], people))
    return score_comfort(
        ComfortRun(time_s=table[:, 0], robot=table[:, 1:4], gap_m=gap_m, time_to_collision_s=soonest_s)
    )


def _gaps(robots: NDArray[np.float64], people: NDArray[np.float64]) -> list[float]:
    """Distances [m] on the floor of people, (Q, 4), from the outlines of robots, (Q, 6), as above."""
    return [
        outline_gap(Planar(*robot), (x, y))
        for robot, (x, y) in zip(robots[:, 1:4].tolist(), people[:, :2].tolist(), strict=True)
    ]


def _times_to_collision(robots: NDArray[np.float64], people: NDArray[np.float64]) -> NDArray[np.float64]:
    """Times [s] (Q,) of robots and people, rows as above."""
    headings, speeds = robots[:, 3].tolist(), robots[:, 4]
    own_x = speeds * [math.cos(heading) for heading in headings]
    own_y = speeds * [math.sin(heading) for heading in headings]
    velocity = people[:, 2:] - np.stack([own_x, own_y], axis=1)
    return times_to_collision(people[:, :2] - robots[:, 1:3], velocity, RADIUS_M + _BODY_M)
