"""Score how well one person was followed: found, kept in sight, kept at the distance, never touched."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.score_record import Flags, Floats, ScoreRecord, count_contacts, metric


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingTask:
    """What the robot was asked to do; distances are between the origins of robot and person, on the floor.

    Attributes:
        keep_m: [m] distance to keep; at 3.9 a person of 1.75 m is 0.58 image heights tall in a level camera
            of 44 degrees that sits 0.14 m before the robot's origin.
        within_m: [m] by which a distance may be off on either side, and counts as kept.
        facing_rad: [rad] bearing within which the robot faces the person.
        lost_s: [s] a person out of track for this long is lost; shorter gaps are drop-outs.
        reached_s: [s] last part of the run, which says whether the person was followed to the end.
    """

    keep_m: float = 3.9
    within_m: float = 1.2
    facing_rad: float = math.radians(10.0)
    lost_s: float = 0.5
    reached_s: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingScore(ScoreRecord):
    """Scores of one run; shares and means are over the frames with the person there, from the first track on.

    Shares are 0..1, angles [rad]. `min_distance_m` and `collisions` are over the whole run. A period without
    track counts as lost if it takes `lost_s` or longer. `path_efficiency` ends with the first time in the
    band. `wrong_person_s` is NaN if it is not known whom the robot follows.
    """

    found: bool = metric("found", "", "1 if the person was ever tracked")
    time_to_find_s: float = metric("time to find", "s", "from the start to the first track")
    followed: float = metric("followed", "%", "time tracked since found")
    in_band: float = metric("in band", "%", "time at a good distance since found")
    facing: float = metric("facing", "%", "time turned to the person since found")
    in_band_and_facing: float = metric("in band and facing", "%", "both at once")
    mean_distance_error_m: float = metric("distance error", "m", "mean of the absolute error since found")
    rms_distance_error_m: float = metric("distance error RMS", "m", "root mean square since found")
    min_distance_m: float = metric(
        "nearest", "m", "smallest distance to the person to follow, centre to centre"
    )
    collisions: int = metric("collisions", "", "contacts begun in the run")
    times_lost: int = metric("times lost", "", "periods without track since found")
    longest_lost_s: float = metric("longest lost", "s", "longest period without track since found")
    followed_to_end: bool = metric("to the end", "", "1 if the right person was followed at the end")
    path_efficiency: float = metric("path efficiency", "%", "straight way to the band / way driven")
    mean_heading_error_rad: float = metric("heading error", "deg", "mean absolute since found")
    wrong_person_s: float = metric("wrong person", "s", "time spent going after somebody else")
    identity_changes: int = metric("identity changes", "", "new numbers of the person's track")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowingRun:
    """What happened in a run in which the robot was to follow one person; one row a frame.

    Attributes:
        time_s: (T,) [s] rising.
        robot: (T, 3) [m, m, rad] x, y, heading in the world frame.
        person: (T, 2) [m] x, y in the world frame, NaN while the person is not there.
        is_tracked: (T,) whether a track lay on this person.
        is_contact: (T,) whether the robot touched anything or anyone.
        track: (T,) number of the track that lay on this person, 0 for none; None to leave that out.
        is_wrong: (T,) whether the robot went after another person; None if nobody knows.

    Raises:
        BadInput: the arrays do not have these shapes, or time does not rise.
    """

    time_s: Floats
    robot: Floats
    person: Floats
    is_tracked: Flags
    is_contact: Flags
    track: NDArray[np.int64] | None = None
    is_wrong: Flags | None = None

    def __post_init__(self) -> None:
        """Refuse arrays that do not belong together."""
        frames = len(self.time_s)
        arrays = (self.time_s, self.robot, self.person, self.is_tracked, self.is_contact)
        shapes = [a.shape for a in arrays]
        if frames == 0 or shapes != [(frames,), (frames, 3), (frames, 2), (frames,), (frames,)]:
            raise BadInput(
                f"following: shapes must be (T,), (T, 3), (T, 2), (T,), (T,) with T > 0, got {shapes}"
            )
        more = [a.shape for a in (self.track, self.is_wrong) if a is not None]
        if any(shape != (frames,) for shape in more):
            raise BadInput(f"following: track and is_wrong must be ({frames},), got {more}")
        if not np.all(np.diff(self.time_s) > 0.0):
            raise BadInput("following: time_s must rise from frame to frame")

    @property
    def first(self) -> int:
        """Index of the encounter; T if there was none."""
        return int(np.argmax(self.is_tracked)) if self.is_tracked.any() else len(self.time_s)


def score_following(run: FollowingRun, task: FollowingTask | None = None) -> FollowingScore:
    """Score one run in which the robot was to follow one person.

    Args:
        run: what happened.
        task: what was asked.
    """
    task = FollowingTask() if task is None else task
    time_s, is_tracked, first = run.time_s, run.is_tracked, run.first
    distance, bearing = _person_from_robot(run.robot, run.person)
    is_there = np.isfinite(distance)
    since = is_there & (np.arange(len(time_s)) >= first)
    nearest_m, farthest_m = task.keep_m - task.within_m, task.keep_m + task.within_m
    is_kept = (distance >= nearest_m) & (distance <= farthest_m)  # NaN is in no band
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
        collisions=count_contacts(time_s, run.is_contact),
        times_lost=int(np.sum(lost >= task.lost_s)),
        longest_lost_s=float(np.max(lost, initial=0.0)),
        followed_to_end=_is_at_end(run, task.reached_s),
        path_efficiency=_path_efficiency(run.robot[first:], is_kept[first:]),
        mean_heading_error_rad=_mean(np.abs(bearing[since])),
        wrong_person_s=math.nan if run.is_wrong is None else float(np.sum(_periods(time_s, run.is_wrong))),
        identity_changes=0 if run.track is None else _changes(run.track),
    )


def _is_at_end(run: FollowingRun, last_s: float) -> bool:
    """Return whether the person was tracked for most of the last part, and nobody else followed."""
    last = run.time_s >= run.time_s[-1] - last_s
    is_there = last & np.isfinite(run.person[:, 0])
    is_wrong = run.is_wrong is not None and bool(run.is_wrong[last].any())
    return bool(np.mean(run.is_tracked[is_there]) > 0.5) and not is_wrong if is_there.any() else False


def _path_efficiency(robot: Floats, is_kept: Flags) -> float:
    """Give straight way / way driven until the person is first in the band; NaN if no way was to be made."""
    if not is_kept.any():
        return math.nan
    way = robot[: int(np.argmax(is_kept)) + 1, :2]
    driven = float(np.sum(np.hypot(*np.diff(way, axis=0).T)))
    return float(np.hypot(*(way[-1] - way[0]))) / driven if driven > 0.1 else math.nan


def _changes(track: NDArray[np.int64]) -> int:
    """Count how often the number on the person is another than the last one before."""
    return int(np.sum(np.diff(track[track > 0]) != 0))


def _person_from_robot(robot: Floats, person: Floats) -> tuple[Floats, Floats]:
    """Return distance [m] and bearing [rad, -pi..pi, positive left], (T,) each."""
    x, y = (person - robot[:, :2]).T
    bearing = np.arctan2(y, x) - robot[:, 2]
    return np.hypot(x, y), np.arctan2(np.sin(bearing), np.cos(bearing))


def _mean(values: Floats | Flags) -> float:
    return float(np.mean(values)) if values.size else math.nan


def _periods(time_s: Floats, flags: Flags) -> Floats:
    """Return the length [s] of each run of true values, up to the next frame or the end: (N,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return time_s[np.minimum(ends, len(time_s) - 1)] - time_s[starts]
