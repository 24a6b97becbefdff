"""The scores of a way along corridors, from the truth instant by instant and the floor plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.scores.corridor_metrics import CorridorScore, Leg, score_corridor
from peopleboy.sim.places.floor_plan import FloorPlan, Rectangle
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth


class CorridorLog:
    """Keeps what the scores of corridor following need, instant by instant."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def add(self, truth: Truth | ImageFreeTruth) -> None:
        """Take in one instant."""
        robot = truth.robot
        self._rows.append((truth.time_s, robot.x, robot.y, robot.heading, float(bool(truth.contacts))))

    def score(self, plan: FloorPlan) -> CorridorScore:
        """Score the way so far in the corridors of a floor plan."""
        return score_way(np.array(self._rows, dtype=np.float64), plan)


def score_way(table: NDArray[np.float64], plan: FloorPlan) -> CorridorScore:
    """Score a way in the corridors of a floor plan.

    Args:
        table: (T, 5) of each instant the time [s], the robot's x, y [m] and heading [rad], and whether it
            touched anything.
        plan: of the place.
    """
    return score_corridor(
        time_s=table[:, 0],
        robot=table[:, 1:4],
        is_contact=table[:, 4] > 0.0,
        legs=tuple(centre_line(area) for _, area in plan.areas),
    )


def centre_line(area: Rectangle) -> Leg:
    """Take an area for a corridor along its longer side."""
    x, y = area.centre
    across, up = area.max_x - area.min_x, area.max_y - area.min_y
    if across >= up:
        return Leg((area.min_x, y), (area.max_x, y), up)
    return Leg((x, area.min_y), (x, area.max_y), across)
