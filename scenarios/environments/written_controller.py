"""Hand-written behaviours as controllers of an environment, which map observations to actions."""

import math

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.behaviour import Behaviour
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.observations import COLUMNS, Arrays
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD
from peopleboy.sim.robot.robot_config import DriveConfig

_DT_S = 1.0 / 15.0


class WrittenController:
    """Controller that drives with a behaviour, to compare it with other controllers in an environment.

    Make a new one for each episode, because behaviours have state. An environment has no emergency stop; the
    robot brakes with its usual deceleration.

    Args:
        behaviour: a new behaviour, such as `load_scenario("single_follow").make_behaviour()`.
        limits: limits of the robot's drive, which actions are shares of.
    """

    def __init__(self, behaviour: Behaviour, limits: DriveConfig | None = None) -> None:
        self._behaviour = behaviour
        self._limits = DriveConfig() if limits is None else limits
        self._time_s = 0.0

    def __call__(self, observation: Arrays) -> NDArray[np.float32]:
        """Return the action (2,) for an observation with `tracks`; call it once per step."""
        rows = observation["tracks"].reshape(-1, len(COLUMNS)).tolist()
        x, y, cosine, sine, speed, turn_rate = observation["odometry"].tolist()
        pose = Pose2(x, y, math.atan2(sine, cosine))
        percept = Percept(
            time_s=self._time_s,
            people=tuple(_person(row) for row in rows if row[0] > 0),
            sonar_m=observation["sonar"].astype(np.float64),
            sonar_angle_rad=SONAR_ANGLE_RAD,
            linear_m_s=speed,
            angular_rad_s=turn_rate,
            odometry=pose,
            goal_m=_goal(pose, observation["goal"]) if "goal" in observation else None,
            images={"colour": observation["colour"]} if "colour" in observation else {},
        )
        self._time_s += _DT_S
        command = self._behaviour.command(percept)
        limits = self._limits
        shares = command.linear_m_s / limits.max_linear_m_s, command.angular_rad_s / limits.max_angular_rad_s
        return np.clip(np.array(shares, np.float32), -1.0, 1.0)


def _goal(pose: Pose2, goal: NDArray[np.float32]) -> tuple[float, float]:
    """Return the goal [m] in the frame of the start pose."""
    distance_m, cosine, sine = goal.tolist()
    x, y = pose.transform_polar(distance_m, math.atan2(sine, cosine)).tolist()
    return x, y


def _person(row: list[float]) -> SeenPerson:
    number, x, height, top, bottom, confidence, is_visible = row
    return SeenPerson(
        id=int(number), x=x, height=height, top=top, bottom=bottom, confidence=confidence,
        is_visible=is_visible > 0.5,
    )  # fmt: skip
