"""Score a drive to a goal: success, time, path, and success weighted by path length."""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from peopleboy.scenarios.files.routes import route_m
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.scores.drive_record import DriveRecord, ScoreRecord, count_contacts, metric, way_m

REACHED_M: Final = 0.5  # from the goal to the robot's centre


class GoalTask(NamedTuple):
    """A place to drive to.

    Attributes:
        goal_m: [m] x, y in the world frame.
        shortest_m: [m] length of the shortest path of the robot's centre from its start, around obstacles.
    """

    goal_m: tuple[float, float]
    shortest_m: float


def goal_task(scenario: Scenario) -> GoalTask | None:
    """Return the goal of a scenario's robot, with the shortest path there; None without a goal."""
    goal_m = scenario.robot.goal_m
    route = None if goal_m is None else scenario.ground.robot_route(scenario.robot.at_m, goal_m)
    return None if goal_m is None or route is None else GoalTask(goal_m, route_m(route))


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalScore(ScoreRecord):
    """Scores of one run, by the true position of the robot; time and path end when it reaches the goal.

    Source of SPL: P. Anderson et al. 2018, On Evaluation of Embodied Navigation Agents.
    """

    reached: bool = metric("reached", "", "whether the robot came within 0.5 m of the goal, 1 or 0")
    spl: float = metric(
        "SPL",
        "",
        "success weighted by path length: the share of the shortest path in that driven, 0 if not reached",
    )
    time_s: float = metric("time to the goal", "s", "time until the robot reached the goal")
    path_m: float = metric("distance driven", "m", "distance driven until then, or until the end")
    shortest_m: float = metric("shortest path", "m", "length of the shortest path around obstacles")
    nearest_m: float = metric("nearest to the goal", "m", "least distance from the goal")
    contacts: int = metric("contacts", "", "number of contacts that start during the run")


def score_goal(run: DriveRecord, task: GoalTask) -> GoalScore:
    """Score one run of driving to a goal."""
    away_m = np.hypot(*(run.robot[:, :2] - task.goal_m).T)
    inside = np.flatnonzero(away_m < REACHED_M)
    reached, end = bool(len(inside)), int(inside[0]) + 1 if len(inside) else len(away_m)
    path_m = way_m(run.robot[:end])
    # The path ends within a circle about the goal, and the shortest path does so, too.
    least_m = max(task.shortest_m - REACHED_M, 0.0)
    share = least_m / max(path_m, least_m) if least_m > 0.0 else 1.0
    return GoalScore(
        reached=reached,
        spl=share if reached else 0.0,
        time_s=float(run.time_s[end - 1] - run.time_s[0]) if reached else math.nan,
        path_m=path_m,
        shortest_m=task.shortest_m,
        nearest_m=float(away_m.min()),
        contacts=count_contacts(run.time_s, run.is_contact),
    )
