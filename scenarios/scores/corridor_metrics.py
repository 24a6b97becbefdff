"""Score corridor following: position and heading relative to the centre line, and contacts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.scores.drive_record import (
    DriveRecord,
    Floats,
    ScoreRecord,
    count_contacts,
    mean,
    metric,
    root_mean_square,
    way_m,
)
from peopleboy.sim.places.floor_plan import FloorPlan, Rectangle


@dataclass(frozen=True, slots=True)
class Leg:
    """The centre line of a straight piece of corridor, from end to end.

    Attributes:
        start_m, end_m: [m] (x, y) in the world frame.
        width_m: [m] from wall to wall.
    """

    start_m: tuple[float, float]
    end_m: tuple[float, float]
    width_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CorridorScore(ScoreRecord):
    """Scores of one run.

    Errors cover the frames on a leg that are at least the leg's width from its ends and junctions, where the
    robot turns. Frames in which it waits for people or passes them are included. Errors are NaN if it was
    never on a leg. The angle to the centre line [rad] is independent of the driving direction.
    """

    lateral_rms_m: float = metric(
        "lateral error RMS", "m", "root mean square of the distance to the centre line"
    )
    lateral_max_m: float = metric("lateral error max", "m", "maximum distance to the centre line")
    heading_error_rad: float = metric("heading error", "deg", "mean angle to the centre line")
    contacts: int = metric("contacts", "", "number of contacts that start during the run")
    mean_speed_m_s: float = metric("mean speed", "m/s", "distance driven divided by time")
    way_m: float = metric("distance driven", "m", "distance driven during the run")
    legs: int = metric("legs", "", "number of straight corridor sections that the robot drove along")


def score_corridor(run: DriveRecord, legs: Sequence[Leg]) -> CorridorScore:
    """Score one run of corridor following.

    Args:
        run: record of the drive.
        legs: straight segments of the corridors.
    """
    robot = run.robot
    errors = [_errors(robot, leg, legs) for leg in legs]
    lateral = np.concatenate([np.zeros(0), *(lateral for lateral, _ in errors)])
    heading = np.concatenate([np.zeros(0), *(heading for _, heading in errors)])
    driven_m, lasted_s = way_m(robot), float(run.time_s[-1] - run.time_s[0])
    return CorridorScore(
        lateral_rms_m=root_mean_square(lateral),
        lateral_max_m=float(np.max(lateral)) if len(lateral) else math.nan,
        heading_error_rad=mean(heading),
        contacts=count_contacts(run.time_s, run.is_contact),
        mean_speed_m_s=driven_m / lasted_s if lasted_s > 0.0 else math.nan,
        way_m=driven_m,
        legs=sum(len(lateral) > 0 for lateral, _ in errors),
    )


def _errors(robot: Floats, leg: Leg, legs: Sequence[Leg]) -> tuple[Floats, Floats]:
    """Return lateral [m] and heading error [rad] of the frames on a leg, away from its ends: (M,) each."""
    way = np.subtract(leg.end_m, leg.start_m)
    place = _along_and_beside(robot[:, :2], leg)
    ends = _along_and_beside(np.array([end for other in legs for end in (other.start_m, other.end_m)]), leg)
    ends = ends[np.abs(ends[:, 1]) < leg.width_m]  # its own ends, and those of legs that branch off
    is_clear = np.all(np.abs(place[:, :1] - ends[:, 0]) > leg.width_m, axis=1)
    is_on = (place[:, 0] > 0.0) & (place[:, 0] < np.hypot(*way)) & (np.abs(place[:, 1]) < leg.width_m / 2.0)
    is_counted = is_on & is_clear
    off = robot[is_counted, 2] - math.atan2(way[1], way[0])
    return np.abs(place[is_counted, 1]), np.abs(np.arcsin(np.sin(off)))


def _along_and_beside(points: Floats, leg: Leg) -> Floats:
    """Return points in the frame of a leg: (N, 2) [m] along it from its start, and to the left of it."""
    way = np.subtract(leg.end_m, leg.start_m)
    x, y = way / np.hypot(*way)
    places: Floats = (points - leg.start_m) @ np.array([[x, -y], [y, x]])
    return places


def legs_of(plan: FloorPlan) -> tuple[Leg, ...]:
    """Return the corridors of a floor plan."""
    return tuple(centre_line(area) for _, area in plan.areas)


def centre_line(area: Rectangle) -> Leg:
    """Return an area as a corridor along its longer side."""
    x, y = area.centre
    across, up = area.max_x - area.min_x, area.max_y - area.min_y
    if across >= up:
        return Leg((area.min_x, y), (area.max_x, y), up)
    return Leg((x, area.min_y), (x, area.max_y), across)
