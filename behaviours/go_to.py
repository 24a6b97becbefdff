"""Drive to a goal by odometry, around obstacles that the sonars detect and around people in the image."""

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.echo_map import EchoMap, EchoMapConfig
from peopleboy.behaviours.following.target import TargetConfig, bearing
from peopleboy.behaviours.percept import Percept, Points


@dataclass(frozen=True, slots=True, kw_only=True)
class GoToConfig:
    """Gains and limits of driving to a goal.

    Attributes:
        arrive_m: [m] distance from the goal at which the robot stops, by odometry ...
        leave_m: [m] ... and distance from which it drives again.
        plan_s: [s] time between two searches for a route.
        ahead_m: [m] distance along the route of the point that the robot steers to.
        facing_gain: [1/s] turn rate per bearing of that point.
        max_turn_rad_s: [rad/s] highest turn rate.
        turn_only_rad: [rad] bearing from which the robot only turns.
        max_linear_m_s: [m/s] highest speed.
        approach_1_s: [1/s] highest speed per distance to the goal.
        people_m: [m] distance that routes keep from visible people: personal space.
        person_m: [m] height that is assumed for people, to get their distance from their apparent height.
        min_confidence: people of lower confidence are ignored.
        stalled_s: [s] time without motion after which the robot backs off ...
        stalled_m_s: [m/s] ... with this as the lowest speed of motion ...
        back_s: [s] ... for so long ...
        back_m_s: [m/s] ... and with this speed.
        view: field of view of the image.
        map: map of obstacles.
    """

    arrive_m: float = 0.2
    leave_m: float = 0.4
    plan_s: float = 0.5
    ahead_m: float = 0.7
    facing_gain: float = 2.0
    max_turn_rad_s: float = 1.2
    turn_only_rad: float = math.radians(50.0)
    max_linear_m_s: float = 0.8
    approach_1_s: float = 0.8
    people_m: float = 1.2
    person_m: float = 1.75
    min_confidence: float = 0.5
    stalled_s: float = 2.0
    stalled_m_s: float = 0.03
    back_s: float = 1.0
    back_m_s: float = 0.2
    view: TargetConfig = field(default_factory=TargetConfig)
    map: EchoMapConfig = field(default_factory=EchoMapConfig)


class GoTo:
    """Driving to `Percept.goal_m` as a behaviour.

    A route is searched again and again on a map of echoes, on which unknown floor counts as free: the robot
    finds its way out of dead ends. It stops while people leave no route, and at the goal.

    Attributes:
        mode: "drive", "wait" (there is no route), "back_off", "arrived", or "blind" (invalid input).
        reason: reason for the mode.
    """

    following = None

    def __init__(self, config: GoToConfig | None = None) -> None:
        self._config = GoToConfig() if config is None else config
        self._map: EchoMap | None = None
        self._goal_m: tuple[float, float] | None = None
        self._route: Points | None = None
        self._time_s = self._planned_s = -math.inf
        self._moved_s = self._back_until_s = -math.inf
        self.mode, self.reason = "wait", "no goal"

    def command(self, percept: Percept) -> Command:
        """Return the command for a percept; stop on invalid input, or when time does not increase."""
        if not (percept.is_sound and percept.time_s > self._time_s):
            return self._stop("blind", "invalid or old input")
        if percept.goal_m is None:
            return self._stop("wait", "no goal")
        self._time_s = percept.time_s
        there = self._explore(percept, percept.goal_m)
        distance_m = math.dist((percept.odometry.x, percept.odometry.y), percept.goal_m)
        if distance_m < (self._config.leave_m if self.mode == "arrived" else self._config.arrive_m):
            return self._stop("arrived", "at the goal by odometry")
        if percept.time_s - self._planned_s >= self._config.plan_s:
            self._planned_s = percept.time_s
            self._route = self._find_route(there, percept, percept.goal_m)
        if self._route is None:
            self._moved_s = percept.time_s
            why = "people leave no route" if percept.people else "obstacles leave no route"
            return self._stop("wait", why)
        if self._is_stalled(percept):
            self.mode, self.reason = "back_off", "the robot could not move on"
            return Command(linear_m_s=-self._config.back_m_s, angular_rad_s=0.0)
        self.mode, self.reason = "drive", "on the way to the goal"
        return self._steer(self._route, percept, distance_m)

    def _stop(self, mode: str, reason: str) -> Command:
        self.mode, self.reason = mode, reason
        return STOP

    def _explore(self, percept: Percept, goal_m: tuple[float, float]) -> EchoMap:
        """Return the map with the newest echoes; a new one for a new goal."""
        is_new = self._goal_m is None or math.dist(goal_m, self._goal_m) > self._config.arrive_m
        if self._map is None or is_new:
            here = (percept.odometry.x, percept.odometry.y)
            self._map, self._goal_m = EchoMap(here, goal_m, self._config.map), goal_m
            self._planned_s = -math.inf
        self._map.update(percept)
        return self._map

    def _find_route(self, there: EchoMap, percept: Percept, goal_m: tuple[float, float]) -> Points | None:
        """Return a route that keeps from people."""
        people = _positions(percept, self._config)
        return there.find_route(percept.odometry, goal_m, percept.time_s, people, self._config.people_m)

    def _is_stalled(self, percept: Percept) -> bool:
        """Return whether the robot must back off, as the guard or an obstacle has held it for a while."""
        config, now_s = self._config, percept.time_s
        if now_s < self._back_until_s:
            return True
        is_moving = abs(percept.linear_m_s) > config.stalled_m_s
        is_turning = abs(percept.angular_rad_s) > config.stalled_m_s
        if is_moving or is_turning or self.mode != "drive":
            self._moved_s = now_s
        if now_s - self._moved_s > config.stalled_s:
            self._back_until_s = now_s + config.back_s
            return True
        return False

    def _steer(self, route: Points, percept: Percept, distance_m: float) -> Command:
        """Steer to a point of the route ahead; slow down in turns, and at the goal."""
        config, pose = self._config, percept.odometry
        away = np.hypot(*(route - (pose.x, pose.y)).T)
        rest = route[int(np.argmin(away)) :]
        ahead = np.flatnonzero(np.hypot(*(rest - (pose.x, pose.y)).T) > config.ahead_m)
        x, y = pose.to_local(tuple(rest[ahead[0] if len(ahead) else -1].tolist()))
        aim = math.atan2(y, x)
        turn = min(max(config.facing_gain * aim, -config.max_turn_rad_s), config.max_turn_rad_s)
        share = max(1.0 - abs(aim) / config.turn_only_rad, 0.0)
        speed = min(config.max_linear_m_s, config.approach_1_s * distance_m)
        return Command(linear_m_s=share * speed, angular_rad_s=turn)


def _positions(percept: Percept, config: GoToConfig) -> Points:
    """Return the positions (P, 2) [m] of visible people in the frame of odometry, by apparent height."""
    up = 2.0 * 0.75 * math.tan(config.view.half_view_rad)  # height of the image [m] at 1 m, 4 to 3
    found = [
        percept.odometry.transform_polar(
            config.person_m / (up * person.height), bearing(person.x, config.view)
        )
        for person in percept.people
        if person.is_sound and person.confidence >= config.min_confidence
    ]
    return np.array(found).reshape(-1, 2)
