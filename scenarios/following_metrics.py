"""How well one person was followed: found, kept in sight, kept at the distance, never touched."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bad_input import BadInput

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Row = tuple[str, float, str, str]  # name, value, unit, explanation


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingTask:
    """What the robot was asked to do; distances are between the origins of robot and person, on the floor.

    Attributes:
        keep_m: [m] distance to keep; at 3.9 a person of 1.75 m is 0.58 image heights tall in a level camera
            of 44 degrees that sits 0.14 m before the robot's origin.
        band_m: [m] nearest and farthest distance that count as kept: 1.2 m to either side.
        facing_rad: [rad] bearing within which the robot faces the person.
        lost_s: [s] a person out of track for this long is lost; shorter gaps are drop-outs.
    """

    keep_m: float = 3.9
    band_m: tuple[float, float] = (2.7, 5.1)
    facing_rad: float = math.radians(10.0)
    lost_s: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingScore:
    """Scores of one run; shares and means are over the frames since the encounter with the person there.

    Attributes:
        found: whether the person was ever tracked: the encounter.
        time_to_find_s: [s] from the start to the encounter.
        followed: share of time tracked.
        in_band: share of time within the band of distances.
        facing: share of time facing the person.
        in_band_and_facing: share of time both.
        mean_distance_error_m, rms_distance_error_m: [m] off the distance to keep, absolute.
        min_distance_m: [m] over the whole run.
        collisions: contacts begun, over the whole run.
        times_lost: periods without track, each of lost_s or longer.
        longest_lost_s: [s] longest period without track.

    What is not defined (no encounter, nobody there) is NaN.
    """

    found: bool
    time_to_find_s: float
    followed: float
    in_band: float
    facing: float
    in_band_and_facing: float
    mean_distance_error_m: float
    rms_distance_error_m: float
    min_distance_m: float
    collisions: int
    times_lost: int
    longest_lost_s: float

    def rows(self) -> list[Row]:
        """Give the scores as table rows: name, value, unit, explanation."""
        return [
            ("found", float(self.found), "", "1 if the person was ever tracked"),
            ("time to find", self.time_to_find_s, "s", "from the start to the first track"),
            ("followed", 100.0 * self.followed, "%", "time tracked since found"),
            ("in band", 100.0 * self.in_band, "%", "time at a good distance since found"),
            ("facing", 100.0 * self.facing, "%", "time turned to the person since found"),
            ("in band and facing", 100.0 * self.in_band_and_facing, "%", "both at once"),
            ("distance error", self.mean_distance_error_m, "m", "mean of the absolute error since found"),
            ("distance error RMS", self.rms_distance_error_m, "m", "root mean square since found"),
            ("nearest", self.min_distance_m, "m", "smallest distance in the run, centre to centre"),
            ("collisions", float(self.collisions), "", "contacts begun in the run"),
            ("times lost", float(self.times_lost), "", "periods without track since found"),
            ("longest lost", self.longest_lost_s, "s", "longest period without track since found"),
        ]


def score_following(
    *,
    time_s: Floats,
    robot: Floats,
    person: Floats,
    is_tracked: Flags,
    is_contact: Flags,
    task: FollowingTask | None = None,
) -> FollowingScore:
    """Score one run in which the robot was to follow one person.

    Args:
        time_s: (T,) [s] rising.
        robot: (T, 3) [m, m, rad] x, y, heading in the world frame.
        person: (T, 2) [m] x, y in the world frame, NaN while the person is not there.
        is_tracked: (T,) whether a track lay on this person.
        is_contact: (T,) whether the robot touched anything or anyone.
        task: what was asked.

    Raises:
        BadInput: the arrays do not have these shapes, or time does not rise.
    """
    _check(time_s, robot, person, is_tracked, is_contact)
    task = FollowingTask() if task is None else task
    distance, bearing = _person_from_robot(robot, person)
    is_there = np.isfinite(distance)
    first = int(np.argmax(is_tracked)) if is_tracked.any() else len(time_s)
    since = is_there & (np.arange(len(time_s)) >= first)
    is_kept = (distance >= task.band_m[0]) & (distance <= task.band_m[1])  # NaN is in no band
    is_facing = np.abs(bearing) < task.facing_rad
    error = np.abs(distance[since] - task.keep_m)
    lost = _periods(time_s, since & ~is_tracked)
    return FollowingScore(
        found=bool(is_tracked.any()),
        time_to_find_s=float(time_s[first] - time_s[0]) if is_tracked.any() else math.nan,
        followed=_mean(is_tracked[since]),
        in_band=_mean(is_kept[since]),
        facing=_mean(is_facing[since]),
        in_band_and_facing=_mean((is_kept & is_facing)[since]),
        mean_distance_error_m=_mean(error),
        rms_distance_error_m=math.sqrt(_mean(error**2)),
        min_distance_m=float(np.min(distance[is_there])) if is_there.any() else math.nan,
        collisions=_count_starts(is_contact),
        times_lost=int(np.sum(lost >= task.lost_s)),
        longest_lost_s=float(np.max(lost, initial=0.0)),
    )


def _check(time_s: Floats, robot: Floats, person: Floats, is_tracked: Flags, is_contact: Flags) -> None:
    """Refuse arrays that do not belong together."""
    frames = len(time_s)
    shapes = [a.shape for a in (time_s, robot, person, is_tracked, is_contact)]
    if frames == 0 or shapes != [(frames,), (frames, 3), (frames, 2), (frames,), (frames,)]:
        raise BadInput(f"following: shapes must be (T,), (T, 3), (T, 2), (T,), (T,) with T > 0, got {shapes}")
    if not np.all(np.diff(time_s) > 0.0):
        raise BadInput("following: time_s must rise from frame to frame")


def _person_from_robot(robot: Floats, person: Floats) -> tuple[Floats, Floats]:
    """Give distance [m] and bearing [rad, -pi..pi, positive left], (T,) each."""
    x, y = (person - robot[:, :2]).T
    bearing = np.arctan2(y, x) - robot[:, 2]
    return np.hypot(x, y), np.arctan2(np.sin(bearing), np.cos(bearing))


def _mean(values: Floats | Flags) -> float:
    return float(np.mean(values)) if values.size else math.nan


def _count_starts(flags: Flags) -> int:
    """Count the runs of true values."""
    return int(np.sum(flags & ~np.concatenate([[False], flags[:-1]])))


def _periods(time_s: Floats, flags: Flags) -> Floats:
    """Give the length [s] of each run of true values, up to the next frame or the end: (N,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return time_s[np.minimum(ends, len(time_s) - 1)] - time_s[starts]
