"""Score person following: finding the person, tracking, distance and contacts."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.scores.drive_record import (
    TARGET,
    DriveRecord,
    Flags,
    Floats,
    ScoreRecord,
    count_contacts,
    mean,
    metric,
    root_mean_square,
    way_m,
)
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.truth.truth import Box
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.floor import floor_squares
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingTask:
    """The following task; distances are between the origins of robot and person, on the floor.

    Attributes:
        keep_m: [m] distance to keep; at 3.9 a person of 1.75 m is 0.58 image heights tall in a level camera
            of 44 degrees, 0.14 m in front of the robot's origin.
        within_m: [m] tolerance of the distance on either side.
        facing_rad: [rad] bearing within which the robot faces the person.
        lost_s: [s] a person without a track for this long is lost; shorter gaps are drop-outs.
        reached_s: [s] last part of the run, which decides whether the person was followed to the end.
    """

    keep_m: float = 3.9
    within_m: float = 1.2
    facing_rad: float = math.radians(10.0)
    lost_s: float = 0.5
    reached_s: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingScore(ScoreRecord):
    """Scores of one run; shares and means cover frames with the person present, from the first track on.

    Shares are 0..1, angles [rad]. `min_distance_m` and `collisions` are over the whole run. A period without
    a track counts as lost if it takes `lost_s` or longer. `path_efficiency` covers the time until the person
    is first in the band. `wrong_person_s` is NaN if the followed person is unknown.
    """

    found: bool = metric("found", "", "1 if the person was tracked at least once, otherwise 0")
    time_to_find_s: float = metric(
        "time to find", "s", "time from the start to the first track of the person"
    )
    followed: float = metric("followed", "%", "share of the time with a track, since the person was found")
    in_band: float = metric(
        "in band", "%", "share of the time at a good distance, since the person was found"
    )
    facing: float = metric("facing", "%", "share of the time facing the person, since the person was found")
    in_band_and_facing: float = metric(
        "in band and facing", "%", "share of the time with both, since the person was found"
    )
    mean_distance_error_m: float = metric(
        "distance error", "m", "mean absolute distance error, since the person was found"
    )
    rms_distance_error_m: float = metric(
        "distance error RMS", "m", "root mean square of the distance error, since the person was found"
    )
    min_distance_m: float = metric(
        "nearest", "m", "minimum distance to the person to follow, between centres"
    )
    collisions: int = metric("collisions", "", "number of contacts that start during the run")
    times_lost: int = metric(
        "times lost", "", "number of periods without a track, since the person was found"
    )
    longest_lost_s: float = metric(
        "longest lost", "s", "longest period without a track, since the person was found"
    )
    followed_to_end: bool = metric(
        "to the end", "", "1 if the robot followed the right person at the end, otherwise 0"
    )
    path_efficiency: float = metric(
        "path efficiency", "%", "straight distance to the band, divided by the distance driven"
    )
    mean_heading_error_rad: float = metric(
        "heading error", "deg", "mean absolute heading error, since the person was found"
    )
    wrong_person_s: float = metric("wrong person", "s", "time spent following another person")
    identity_changes: int = metric(
        "identity changes", "", "number of changes of the id of the person's track"
    )


def score_following(run: DriveRecord, task: FollowingTask | None = None) -> FollowingScore:
    """Score one run of person following.

    Args:
        run: record of the drive.
        task: the following task.
    """
    task = FollowingTask() if task is None else task
    time_s, is_tracked = run.time_s, run.is_tracked
    first = int(np.argmax(is_tracked)) if is_tracked.any() else len(time_s)
    distance, bearing = _person_from_robot(run.robot, run.target)
    is_there = np.isfinite(distance)
    since = is_there & (np.arange(len(time_s)) >= first)
    nearest_m, farthest_m = task.keep_m - task.within_m, task.keep_m + task.within_m
    is_kept = (distance >= nearest_m) & (distance <= farthest_m)  # NaN compares as outside the band
    is_facing = np.abs(bearing) < task.facing_rad
    error = np.abs(distance[since] - task.keep_m)
    lost = _periods(time_s, since & ~is_tracked)
    return FollowingScore(
        found=bool(is_tracked.any()),
        time_to_find_s=float(time_s[first] - time_s[0]) if is_tracked.any() else math.nan,
        followed=mean(is_tracked[since]),
        in_band=mean(is_kept[since]),
        facing=mean(is_facing[since]),
        in_band_and_facing=mean((is_kept & is_facing)[since]),
        mean_distance_error_m=mean(error),
        rms_distance_error_m=root_mean_square(error),
        min_distance_m=float(np.min(distance[is_there])) if is_there.any() else math.nan,
        collisions=count_contacts(time_s, run.is_contact),
        times_lost=int(np.sum(lost >= task.lost_s)),
        longest_lost_s=float(np.max(lost, initial=0.0)),
        followed_to_end=_is_at_end(run, task.reached_s),
        path_efficiency=_path_efficiency(run.robot[first:], is_kept[first:]),
        mean_heading_error_rad=mean(np.abs(bearing[since])),
        wrong_person_s=math.nan if run.is_wrong is None else float(np.sum(_periods(time_s, run.is_wrong))),
        identity_changes=_changes(run.track),
    )


def _is_at_end(run: DriveRecord, last_s: float) -> bool:
    """Return whether the person was tracked for most of the last part, and no other person was followed."""
    last = run.time_s >= run.time_s[-1] - last_s
    is_there = last & np.isfinite(run.target[:, 0])
    is_wrong = run.is_wrong is not None and bool(run.is_wrong[last].any())
    return bool(np.mean(run.is_tracked[is_there]) > 0.5) and not is_wrong if is_there.any() else False


def _path_efficiency(robot: Floats, is_kept: Flags) -> float:
    """Return straight / driven distance until first in the band; NaN if never, or there from the start."""
    if not is_kept.any():
        return math.nan
    way = robot[: int(np.argmax(is_kept)) + 1, :2]
    driven = way_m(way)
    return float(np.hypot(*(way[-1] - way[0]))) / driven if driven > 0.1 else math.nan


def _changes(track: NDArray[np.int64]) -> int:
    """Count the changes of the number of the person's track."""
    return int(np.sum(np.diff(track[track > 0]) != 0))


def _person_from_robot(robot: Floats, person: Floats) -> tuple[Floats, Floats]:
    """Return distance [m] and bearing [rad, -pi..pi, positive left], (T,) each."""
    x, y = (person - robot[:, :2]).T
    bearing = np.arctan2(y, x) - robot[:, 2]
    return np.hypot(x, y), np.arctan2(np.sin(bearing), np.cos(bearing))


def _periods(time_s: Floats, flags: Flags) -> Floats:
    """Return the length [s] of each span of true values, up to the next frame or the end: (N,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return time_s[np.minimum(ends, len(time_s) - 1)] - time_s[starts]


# Person following, instant by instant, for runs and environments.

_LEAST_IOU = 0.5  # a track with a higher overlap is on the person


class Spot(NamedTuple):
    """True position of a person.

    Attributes:
        box: left, top, width, height [px] in the thermal image.
        place_m: [m] forward, left, in the robot's frame.
    """

    box: Box
    place_m: tuple[float, float]


def tracks_on_target(tick: Tick, boxes: BoxKind = BoxKind.TORSO, before: int = 0) -> tuple[int, bool]:
    """Return the track number of the person to follow, 0 for none; and whether another one is followed.

    Args:
        tick: the instant.
        boxes: what the tracker's boxes enclose.
        before: see `track_on`.
    """
    robot, is_whole = tick.truth.robot, boxes is BoxKind.WHOLE
    spots = {
        person.id: Spot(box, robot.to_local(person.position_m))
        for person in tick.truth.people
        if (box := person.whole_box if is_whole else person.box) is not None
    }
    return track_on(spots.get(TARGET), tick.tracks, before), _is_wrong(spots, tick)


def track_on(spot: Spot | None, tracks: Iterable[Track], before: int = 0) -> int:
    """Return the number of the track on a person, 0 if none overlaps enough.

    Args:
        spot: true position of the person.
        tracks: tracks of the instant.
        before: the person's last track, 0 for none: it is kept as long as it is on the person, even if
            another one overlaps more.
    """
    if spot is None:
        return 0
    lying = [
        (track.id == before, overlap, track.id)
        for track in _sure(tracks)
        if (overlap := _overlap(track, spot)) > _LEAST_IOU
    ]
    return max(lying)[2] if lying else 0


def _is_wrong(spots: dict[int, Spot], tick: Tick) -> bool:
    """Return whether the track that the robot follows is on another person than the person to follow."""
    for track in _sure(tick.tracks):
        if track.id == tick.following:
            overlaps = [(_overlap(track, spot), number) for number, spot in spots.items()]
            overlap, whose = max(overlaps, default=(0.0, 0))
            return whose != TARGET and overlap > _LEAST_IOU
    return False


def _sure(tracks: Iterable[Track]) -> Iterable[Track]:
    return (track for track in tracks if track.status is not Status.TENTATIVE)


def _overlap(track: Track, spot: Spot) -> float:
    """Return the overlap of a track with a person, 0..1: in the thermal image, or else on the floor."""
    if THERMAL in track.boxes:
        return float(iou(np.array(track.boxes[THERMAL]), np.array(spot.box)))
    if track.place is None:
        return 0.0
    said, true = np.array(track.place.position_m), np.array(spot.place_m)
    return float(iou(floor_squares(said), floor_squares(true)))


def following_task(config: WorldConfig, keep_height: float) -> FollowingTask:
    """Convert the desired height of a person [image heights] to a following distance.

    The first person is followed; without people, the distance is the default one.
    """
    if not config.people:
        return FollowingTask()
    camera = flat_geometry(config.robot.cameras, "thermal")
    shown_px = keep_height * camera.height
    return FollowingTask(keep_m=camera.focal_px * config.people[0].height_m / shown_px + camera.position_m[0])
