"""A flat world of points, a robot without dynamics but with limits, and a pinhole view of one person."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.behaviour import STOP, Behaviour, Command
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.geometry.pose2 import Pose2

Array = NDArray[np.float64]
STEP_S = 1.0 / 15.0
SONAR_DEG = (90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90)
SONAR_ANGLE = np.radians(np.array(SONAR_DEG, float))
# ARIA's peoplebot-sh.p, SonarUnit 0..15.
SONAR_X = (
    np.array([69, 114, 148, 166, 166, 148, 114, 69, -157, -203, -237, -255, -255, -237, -203, -157]) / 1e3
)
_AHEAD, _LEFT = np.cos(SONAR_ANGLE)[:, None], np.sin(SONAR_ANGLE)[:, None]
SONAR_Y = np.array([136, 119, 78, 27, -27, -78, -119, -136, -136, -119, -78, -27, 27, 78, 119, 136]) / 1e3
HALF_VIEW = math.atan(4.0 / 3.0 * math.tan(math.radians(22.0)))
CAMERA_X, IMAGE_SPAN = 0.14, 2.0 * math.tan(math.radians(22.0))
FRONT, REAR, HALF_WIDTH = 0.21, 0.30, 0.19  # of the hull, from the origin between the wheels


def wall(a: tuple[float, float], b: tuple[float, float]) -> Array:
    """Points every 2 cm from a to b."""
    count = max(int(math.dist(a, b) / 0.02), 1) + 1
    return np.linspace(a, b, count)


def _is_in_hull(points: Array) -> bool:
    x, y = points.T
    return bool(np.any((x < FRONT) & (x > -REAR) & (np.abs(y) < HALF_WIDTH)))


def _ring(centre: Array, radius: float = 0.2) -> Array:
    angle = np.linspace(0.0, math.tau, 24, endpoint=False)
    return centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@dataclass
class Toy:
    """One person who walks along `path` (time to x, y), walls as points, one robot."""

    path: Callable[[float], tuple[float, float]]
    walls: Array = field(default_factory=lambda: np.zeros((0, 2)))
    tall_m: float = 1.75
    rng: np.random.Generator | None = None
    hidden: Callable[[float], bool] = lambda _: False
    pose: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        self.time_s, self.speed, self.turn, self.pending = 0.0, 0.0, 0.0, STOP

    def local(self, points: Array) -> Array:
        dx, dy = (points - self.pose[:2]).T
        c, s = math.cos(self.pose[2]), math.sin(self.pose[2])
        return np.stack([c * dx + s * dy, c * dy - s * dx], axis=1)

    def person(self) -> Array:
        return np.array(self.path(self.time_s))

    def obstacles(self) -> Array:
        return self.local(np.concatenate([self.walls, _ring(self.person())]))

    def sonar(self) -> Array:
        points = self.obstacles()
        dx, dy = points[:, 0] - SONAR_X[:, None], points[:, 1] - SONAR_Y[:, None]  # (16, M)
        far = np.sqrt(dx * dx + dy * dy)
        is_in_cone = _AHEAD * dx + _LEFT * dy > math.cos(math.radians(7.5)) * far
        ranges = np.where(is_in_cone, far, 5.0).min(axis=1)
        if self.rng is not None:
            ranges = np.where(self.rng.random(16) < 0.01, 5.0, ranges + self.rng.normal(0.0, 0.01, 16))
        return np.clip(ranges, 0.15, 5.0)

    def bearing(self) -> float:
        x, y = self.local(self.person()[None])[0]
        return math.atan2(y, x)

    def distance(self) -> float:
        return math.dist(self.pose[:2], self.person())

    def people(self) -> tuple[SeenPerson, ...]:
        x, y = self.local(self.person()[None])[0]
        depth = x - CAMERA_X
        column = -y / (max(depth, 1e-6) * math.tan(HALF_VIEW))
        if depth < 0.3 or abs(column) > 1.0 or self.hidden(self.time_s) or self._is_walled_off(depth, y):
            return ()
        noise = np.zeros(2) if self.rng is None else self.rng.normal(0.0, 1.0, 2)
        bottom = 0.5 + 1.2 / (depth * IMAGE_SPAN)
        height = self.tall_m / (depth * IMAGE_SPAN) * math.exp(0.04 * noise[0])
        return (
            SeenPerson(
                id=1,
                x=column + 0.02 * noise[1],
                height=height,
                top=bottom - height,
                bottom=bottom,
                confidence=0.9,
                is_visible=True,
            ),
        )

    def _is_walled_off(self, depth: float, y: float) -> bool:
        ahead = self.local(self.walls) - (CAMERA_X, 0.0)
        far = math.hypot(depth, y)
        along, aside = ahead @ (depth / far, y / far), ahead @ (-y / far, depth / far)
        is_near = along * along + aside * aside < max(far - 0.05, 0.0) ** 2
        return bool(np.any(is_near & (np.abs(aside) < math.tan(0.02) * along)))

    def percept(self) -> Percept:
        return Percept(
            time_s=self.time_s,
            people=self.people(),
            sonar_m=self.sonar(),
            sonar_angle_rad=SONAR_ANGLE,
            linear_m_s=self.speed,
            angular_rad_s=self.turn,
            odometry=Pose2(*self.pose.tolist()),
        )

    def is_contact(self) -> bool:
        return _is_in_hull(self.obstacles())

    def wall_gap(self) -> float:
        """Smallest distance [m] from the hull to a wall."""
        x, y = self.local(self.walls).T
        beyond = np.maximum(np.maximum(x - FRONT, -REAR - x), 0.0)
        return float(np.hypot(beyond, np.maximum(np.abs(y) - HALF_WIDTH, 0.0)).min())

    def step(self, behaviour: Behaviour) -> Command:
        """One tick; the command acts one frame after its image."""
        command = behaviour.command(self.percept())
        for _ in range(8):
            self._move(self.pending, STEP_S / 8.0)
        self.pending = command
        self.time_s += STEP_S
        return command

    def _move(self, wanted: Command, step_s: float) -> None:
        most = 0.6 * step_s
        self.speed += min(max(wanted.linear_m_s - self.speed, -most), most)
        most = math.radians(200.0) * step_s
        self.turn += min(max(wanted.angular_rad_s - self.turn, -most), most)
        heading = self.pose[2] + 0.5 * self.turn * step_s
        forward = self.speed * step_s
        self.pose = self.pose + np.array(
            [forward * math.cos(heading), forward * math.sin(heading), self.turn * step_s]
        )


@dataclass
class Log:
    """What happened, one row a frame."""

    time_s: Array
    robot: Array
    person: Array
    is_tracked: NDArray[np.bool_]
    is_contact: NDArray[np.bool_]
    mode: list[str]
    commands: list[Command]
    bearing: Array
    distance: Array


def drive(toy: Toy, behaviour: Behaviour, seconds: float) -> Log:
    rows, modes, commands = [], [], []
    for _ in range(round(seconds / STEP_S)):
        seen, row = bool(toy.people()), (toy.time_s, *toy.pose, *toy.person())
        commands.append(toy.step(behaviour))
        modes.append(behaviour.mode)
        rows.append((*row, seen, toy.is_contact(), toy.bearing(), toy.distance()))
    table = np.array(rows, float)
    return Log(
        time_s=table[:, 0],
        robot=table[:, 1:4],
        person=table[:, 4:6],
        is_tracked=table[:, 6] > 0.5,
        is_contact=table[:, 7] > 0.5,
        mode=modes,
        commands=commands,
        bearing=table[:, 8],
        distance=table[:, 9],
    )


def straight(start, velocity, begin_s=0.0, end_s=math.inf):
    def path(time_s):
        walked = min(max(time_s, begin_s), end_s) - begin_s
        return start[0] + velocity[0] * walked, start[1] + velocity[1] * walked

    return path


def room(*openings):
    """14 x 8 m with a wall across at x = 4 that leaves the given opening."""
    outer = [((-3, -4), (11, -4)), ((-3, 4), (11, 4)), ((-3, -4), (-3, 4)), ((11, -4), (11, 4))]
    inner = [((4, -4), (4, low)) for low, _ in openings] + [((4, high), (4, 4)) for _, high in openings]
    return np.concatenate([wall(a, b) for a, b in outer + inner])
