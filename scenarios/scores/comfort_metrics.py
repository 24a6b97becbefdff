"""Score how comfortable people were with a robot that drives among them: nearness, collision times, jerk."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.scores.score_record import Floats, ScoreRecord, count_starts, metric
from peopleboy.sim.robot.robot_body import RADIUS_M, outline_gap
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth

# Spaces about a person, from the robot's outline to the middle of the body (E. T. Hall, The Hidden Dimension,
# 1966, which measures from body to body).
INTIMATE_M: Final = 0.45
PERSONAL_M: Final = 1.2
SOCIAL_M: Final = 3.6
_FORESEEN_S: Final = 30.0  # beyond which nobody goes on as they are


@dataclass(frozen=True, slots=True, kw_only=True)
class ComfortScore(ScoreRecord):
    """Scores of one run, over all of it and all people in it.

    `min_time_to_collision_s` takes robot and person for discs; it is NaN if none would have touched within
    30 s. Jerk is the second difference of the forward speed; `felt_jerk_m_s3` is NaN if nobody was within
    social space. Numbers of intrusions are whole but in means of runs.

    Source: metrics of HuNavSim (Perez-Higueras et al. 2023) and of Francis et al. 2023, Principles and
    Guidelines for Evaluating Social Robot Navigation, which have time in spaces, least time to collision and
    jerk; ours are in seconds rather than in shares of a run.
    """

    personal_s: float = metric("within 1.2 m", "s", "time with somebody in personal space")
    intimate_s: float = metric("within 0.45 m", "s", "time with somebody in intimate space")
    personal_intrusions: float = metric("intrusions, 1.2 m", "", "into personal space")
    intimate_intrusions: float = metric("intrusions, 0.45 m", "", "into intimate space")
    min_time_to_collision_s: float = metric(
        "time to collision", "s", "least, if both had gone on as they were"
    )
    jerk_m_s3: float = metric("jerk", "m/s3", "of the robot, root mean square, forwards")
    felt_jerk_m_s3: float = metric("jerk felt", "m/s3", "the same with somebody within 3.6 m")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComfortRun:
    """What happened in a run; one row a frame.

    Attributes:
        time_s: (T,) [s] rising.
        robot: (T, 3) [m, m, rad] x, y, heading in the world frame.
        gap_m: (T,) [m] from the robot's outline to the nearest person's middle; inf where nobody is there.
        time_to_collision_s: (T,) [s] least over all people; inf where none is on a collision course.

    Raises:
        BadInput: the arrays do not have these shapes, or time does not rise.
    """

    time_s: Floats
    robot: Floats
    gap_m: Floats
    time_to_collision_s: Floats

    def __post_init__(self) -> None:
        """Refuse arrays that do not belong together."""
        frames = len(self.time_s)
        shapes = [a.shape for a in (self.time_s, self.robot, self.gap_m, self.time_to_collision_s)]
        if frames == 0 or shapes != [(frames,), (frames, 3), (frames,), (frames,)]:
            raise BadInput(f"comfort: shapes must be (T,), (T, 3), (T,), (T,) with T > 0, got {shapes}")
        if not np.all(np.diff(self.time_s) > 0.0):
            raise BadInput("comfort: time_s must rise from frame to frame")


def score_comfort(run: ComfortRun) -> ComfortScore:
    """Score one run; a frame lasts until the next one."""
    lasts_s = np.diff(run.time_s, append=run.time_s[-1])
    is_personal, is_intimate = run.gap_m < PERSONAL_M, run.gap_m < INTIMATE_M
    nearest_s = float(np.min(run.time_to_collision_s))
    jerk = _jerk(run)
    return ComfortScore(
        personal_s=float(lasts_s[is_personal].sum()),
        intimate_s=float(lasts_s[is_intimate].sum()),
        personal_intrusions=float(count_starts(is_personal)),
        intimate_intrusions=float(count_starts(is_intimate)),
        min_time_to_collision_s=nearest_s if nearest_s <= _FORESEEN_S else math.nan,
        jerk_m_s3=_root_mean_square(jerk),
        felt_jerk_m_s3=_root_mean_square(jerk[run.gap_m[3:] < SOCIAL_M]),
    )


def times_to_collision(gaps: Floats, velocities: Floats, reach_m: float) -> Floats:
    """Return after what times pairs of discs touch that go on as they are.

    Args:
        gaps: (Q, 2) [m] from one middle to the other.
        velocities: (Q, 2) [m/s] of the other against the one.
        reach_m: [m] sum of the radii.

    Returns:
        (Q,) [s] the smaller root of |gap + t velocity| = reach_m; 0 while they overlap, inf if they never
        touch.
    """
    a, b = _products(velocities, velocities), _products(gaps, velocities)
    c = _products(gaps, gaps) - reach_m**2
    inner = b * b - a * c
    touches = (a > 0.0) & (b < 0.0) & (inner >= 0.0)
    roots = c / (np.sqrt(np.where(touches, inner, 1.0)) - np.where(touches, b, 0.0))
    return np.where(c <= 0.0, 0.0, np.where(touches, roots, np.inf))


def _products(one: Floats, other: Floats) -> Floats:
    """(Q,) scalar products of vectors (Q, 2)."""
    products: Floats = (one[:, None, :] @ other[:, :, None])[:, 0, 0]
    return products


def _jerk(run: ComfortRun) -> Floats:
    """Return the second derivative of the forward speed [m/s3] by differences: (T - 3,)."""
    if len(run.time_s) < 4:
        return np.zeros(0)
    steps, heading = np.diff(run.robot[:, :2], axis=0), run.robot[:-1, 2]
    ahead = steps[:, 0] * np.cos(heading) + steps[:, 1] * np.sin(heading)
    step_s = np.diff(run.time_s)
    acceleration = np.diff(ahead / step_s) / step_s[1:]
    jerk: NDArray[np.float64] = np.diff(acceleration) / step_s[2:]
    return jerk


def _root_mean_square(values: Floats) -> float:
    return math.sqrt(float(np.mean(values**2))) if values.size else math.nan


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
        outline_gap(Pose2(*robot), (x, y))
        for robot, (x, y) in zip(robots[:, 1:4].tolist(), people[:, :2].tolist(), strict=True)
    ]


def _times_to_collision(robots: NDArray[np.float64], people: NDArray[np.float64]) -> NDArray[np.float64]:
    """Times [s] (Q,) of robots and people, rows as above."""
    headings, speeds = robots[:, 3].tolist(), robots[:, 4]
    own_x = speeds * [math.cos(heading) for heading in headings]
    own_y = speeds * [math.sin(heading) for heading in headings]
    velocity = people[:, 2:] - np.stack([own_x, own_y], axis=1)
    return times_to_collision(people[:, :2] - robots[:, 1:3], velocity, RADIUS_M + _BODY_M)
