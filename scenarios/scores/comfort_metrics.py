"""Score the comfort of people near a driving robot: distances, times to collision, jerk."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.collision_course import times_to_collision
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.scores.contacts import AT_REST_M_S
from peopleboy.scenarios.scores.drive_record import (
    DriveRecord,
    Flags,
    Floats,
    ScoreRecord,
    metric,
    root_mean_square,
)
from peopleboy.sim.robot.robot_body import RADIUS_M, outline_gap

# Spaces about a person, from the robot's outline to the middle of the body (E. T. Hall, The Hidden Dimension,
# 1966, which measures from body to body).
INTIMATE_M: Final = 0.45
PERSONAL_M: Final = 1.2
SOCIAL_M: Final = 3.6
_FORESEEN_S: Final = 30.0  # horizon beyond which constant velocity is not assumed
_SOON_S: Final = 1.5  # time to collision of a near miss
_BODY_M: Final = 0.25  # radius of the disc that represents a person


@dataclass(frozen=True, slots=True, kw_only=True)
class ComfortScore(ScoreRecord):
    """Scores of one run, over the whole run and all people.

    `min_time_to_collision_s` models robot and person as discs; it is NaN if none would have touched within
    30 s. Jerk is the second difference of the forward speed; `felt_jerk_m_s3` is NaN if no person was in
    social space. Numbers of intrusions are whole, except in means over runs.

    Source: metrics of HuNavSim (Perez-Higueras et al. 2023) and of Francis et al. 2023, Principles and
    Guidelines for Evaluating Social Robot Navigation, which have time in spaces, least time to collision and
    jerk; ours are in seconds rather than in shares of a run.
    """

    personal_s: float = metric("within 1.2 m", "s", "time with a person in personal space")
    intimate_s: float = metric("within 0.45 m", "s", "time with a person in intimate space")
    personal_intrusions: float = metric("intrusions, 1.2 m", "", "number of entries into personal space")
    intimate_intrusions: float = metric("intrusions, 0.45 m", "", "number of entries into intimate space")
    min_time_to_collision_s: float = metric(
        "time to collision", "s", "minimum during the run, assuming constant velocities"
    )
    driving_personal_s: float = metric(
        "driving within 1.2 m", "s", "time that the robot drives with a person in personal space"
    )
    driving_at_people_s: float = metric(
        "near misses", "s", "time that the robot drives with a time to collision below 1.5 s"
    )
    jerk_m_s3: float = metric("jerk", "m/s3", "root mean square of the forward jerk of the robot")
    felt_jerk_m_s3: float = metric(
        "jerk felt", "m/s3", "root mean square of the jerk while a person is within 3.6 m"
    )


def score_comfort(run: DriveRecord) -> ComfortScore:
    """Score the comfort of people during a drive."""
    row = np.repeat(np.arange(len(run.time_s)), run.count)
    gap_m, soonest_s = np.full((2, len(run.time_s)), np.inf)
    np.minimum.at(gap_m, row, _gaps(run.robot[row], run.people))
    np.minimum.at(soonest_s, row, _times_to_collision(run.robot[row], run.speed_m_s[row], run.people))
    return score_nearness(run, gap_m, soonest_s)


def score_nearness(run: DriveRecord, gap_m: Floats, time_to_collision_s: Floats) -> ComfortScore:
    """Score one run; a frame lasts until the next one.

    Args:
        run: record of the drive.
        gap_m: (T,) [m] from the robot's outline to the nearest person's centre; inf without people.
        time_to_collision_s: (T,) [s] minimum over all people; inf without a collision course.
    """
    lasts_s = np.diff(run.time_s, append=run.time_s[-1])
    is_personal, is_intimate = gap_m < PERSONAL_M, gap_m < INTIMATE_M
    is_driving = np.abs(run.speed_m_s) > AT_REST_M_S
    nearest_s = float(np.min(time_to_collision_s))
    jerk = _jerk(run)
    return ComfortScore(
        personal_s=float(lasts_s[is_personal].sum()),
        intimate_s=float(lasts_s[is_intimate].sum()),
        personal_intrusions=float(_count_starts(is_personal)),
        intimate_intrusions=float(_count_starts(is_intimate)),
        min_time_to_collision_s=nearest_s if nearest_s <= _FORESEEN_S else math.nan,
        driving_personal_s=float(lasts_s[is_driving & is_personal].sum()),
        driving_at_people_s=float(lasts_s[is_driving & (time_to_collision_s < _SOON_S)].sum()),
        jerk_m_s3=root_mean_square(jerk),
        felt_jerk_m_s3=root_mean_square(jerk[gap_m[3:] < SOCIAL_M]),
    )


def _count_starts(flags: Flags) -> int:
    """Count the spans of true values (T,)."""
    return int(np.sum(flags & ~np.concatenate([[False], flags[:-1]])))


def _jerk(run: DriveRecord) -> Floats:
    """Return the second derivative of the forward speed [m/s3] by differences: (T - 3,)."""
    if len(run.time_s) < 4:
        return np.zeros(0)
    steps, heading = np.diff(run.robot[:, :2], axis=0), run.robot[:-1, 2]
    ahead = steps[:, 0] * np.cos(heading) + steps[:, 1] * np.sin(heading)
    step_s = np.diff(run.time_s)
    acceleration = np.diff(ahead / step_s) / step_s[1:]
    jerk: NDArray[np.float64] = np.diff(acceleration) / step_s[2:]
    return jerk


def _gaps(robots: Floats, people: Floats) -> list[float]:
    """Return the floor distances [m] of people, (Q, 4), from the outlines of robots, (Q, 3)."""
    return [
        outline_gap(Pose2(*robot), (x, y))
        for robot, (x, y) in zip(robots.tolist(), people[:, :2].tolist(), strict=True)
    ]


def _times_to_collision(robots: Floats, speeds: Floats, people: Floats) -> Floats:
    """Return times to collision [s] (Q,) of robots, by pose and forward speed, with people; rows as above."""
    headings = robots[:, 2].tolist()
    own_x = speeds * [math.cos(heading) for heading in headings]
    own_y = speeds * [math.sin(heading) for heading in headings]
    velocity = people[:, 2:] - np.stack([own_x, own_y], axis=1)
    return times_to_collision(people[:, :2] - robots[:, :2], velocity, RADIUS_M + _BODY_M)
