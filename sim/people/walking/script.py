"""Scripts of people, and their progress along them, as arrays for kernels."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.motion.stance import POSTURES
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.people.walking.path import PathPiece, is_about_turn, route

Records = NDArray[Any]

TURN_RATE_RAD_S = math.radians(150.0)

NOTHING, POINT, ROBOT, ABSENT = 0, 1, 2, 3  # target to face in a pause; ABSENT: a person who is away
WAYPOINT: Final = np.dtype(
    [
        ("at", np.float64, 2),  # [m]
        ("pause_s", np.float64),  # inf at the last one
        ("has_pause", np.bool_),
        ("until_robot_within_m", np.float64),  # negative: does not wait for the robot
        ("waits_at_most_s", np.float64),
        ("posture", np.int64),  # during the pause, index in `POSTURES`
        ("faces", np.int64),
        ("face", np.float64, 2),  # [m]
        ("speed", np.float64),  # [m/s] planned, on the way to the waypoint
        ("first_piece", np.int64),  # of the path from here to the next stop
        ("end_piece", np.int64),
    ]
)
"""Record of a `Waypoint`; piece numbers are relative to the script."""

PIECE: Final = np.dtype(
    [
        ("start", np.float64, 2),  # [m]
        ("heading", np.float64),  # [rad] at the start
        ("length", np.float64),  # [m]
        ("curvature", np.float64),  # [1/m]
        ("goal", np.int64),  # number of the waypoint at its end
        ("speed", np.float64),  # [m/s] planned
        ("speed_squared", np.float64),
    ]
)
"""A `PathPiece`."""

WALK: Final = np.dtype(
    [
        ("position", np.float64, 2),  # [m]
        ("velocity", np.float64, 2),  # [m/s]
        ("heading", np.float64),  # [rad]
        ("turn_rate", np.float64),  # [rad/s]
        ("speed", np.float64),  # [m/s]
        ("along", np.float64),  # [m] on the piece
        ("pause_left", np.float64),  # [s]
        ("wait_left", np.float64),  # [s] after the pause, for the robot
        ("on_feet_in", np.float64),  # [s]
        ("blocked_s", np.float64),  # duration of little progress
        ("reached", np.int64),  # number of the last waypoint reached
        ("piece", np.int64),  # the current piece; -1 in a pause
        ("end_piece", np.int64),
        ("posture", np.int64),  # the one to take up, index in `POSTURES`
        ("is_astray", np.bool_),  # off the path of the script
        ("is_homing", np.bool_),  # on the way back to the waypoint reached
        ("is_turned_away", np.bool_),  # from the direction of the path, after a stop
        ("is_present", np.bool_),
        ("has_moved", np.bool_),  # in the last step, present before and after it
        ("now_s", np.float64),  # [s] at the end of the last step
        ("enter_s", np.float64),
        ("leave_s", np.float64),  # inf for never
        ("radius_m", np.float64),
        ("yields", np.bool_),
        # The wish that changes the script during this step, see `Wish`.
        ("goes_to", np.float64, 2),  # [m]
        ("is_sent", np.bool_),  # whether `goes_to` counts
        ("stands", np.bool_),
        ("faces", np.float64, 2),  # [m]
        ("has_face", np.bool_),  # whether `faces` counts
        ("pace", np.float64),
        ("clear_m", np.float64),  # negative for the default
        ("heeds_robot", np.bool_),
    ]
)
"""Record of a person's progress through its script."""


class Script(NamedTuple):
    """Script of one person: (W,) records WAYPOINT and (P,) records PIECE.

    The last pieces are space for one leg that is planned again, see `plan_leg`.
    """

    waypoints: Records
    pieces: Records


class Scripts(NamedTuple):
    """The scripts of Q people, one after the other.

    Attributes:
        waypoints, pieces: records of all people.
        first_waypoint, first_piece: (Q,) index of each person's first record.
    """

    waypoints: Records
    pieces: Records
    first_waypoint: NDArray[np.int64]
    first_piece: NDArray[np.int64]


def is_scripted(config: PersonConfig) -> bool:
    """Return whether a person only follows its script and gives way, without a reaction, lead or group."""
    is_alone = config.reacts is None and config.leads is None and config.group is None
    return is_alone and all(
        waypoint.until_robot_within_m is None
        and (not isinstance(waypoint.face, str) or waypoint.face == "robot")
        for waypoint in config.path
    )


def has_pause(path: Sequence[Waypoint], index: int) -> bool:
    """Return whether a person stays at a waypoint."""
    waypoint = path[index]
    is_kept = waypoint.pause_s > 0.0 or waypoint.until_robot_within_m is not None
    return index == len(path) - 1 or is_kept


def stops_at(path: Sequence[Waypoint], index: int) -> bool:
    """Return whether a person stops at a waypoint."""
    if has_pause(path, index):
        return True
    before, corner, after = (w.at_m for w in path[index - 1 : index + 2])
    return is_about_turn(before, corner, after)


def write_script(path: Sequence[Waypoint]) -> Script:
    """Plan the paths between all stops."""
    stops = [0, *(index for index in range(1, len(path)) if stops_at(path, index))]
    pieces: list[PathPiece] = []
    waypoints = np.zeros(len(path), WAYPOINT)
    for index, (waypoint, row) in enumerate(zip(path, waypoints, strict=True)):
        within_m = waypoint.until_robot_within_m
        row["at"], row["speed"] = waypoint.at_m, waypoint.speed_m_s
        row["pause_s"] = math.inf if index == len(path) - 1 else waypoint.pause_s
        row["has_pause"], row["posture"] = has_pause(path, index), POSTURES[Posture(waypoint.posture)]
        row["until_robot_within_m"] = -1.0 if within_m is None else within_m
        row["waits_at_most_s"] = waypoint.waits_at_most_s
        if isinstance(waypoint.face, str):
            row["faces"] = ROBOT if waypoint.face == "robot" else ABSENT
        elif waypoint.face is not None:
            row["faces"], row["face"] = POINT, waypoint.face
    for start, stop in pairwise(stops):
        leg = route([each.at_m for each in path[start : stop + 1]], start + 1)
        for index in range(start, stop):  # a person who left the path may continue from between two stops
            skipped = next(k for k, piece in enumerate(leg) if piece.goal == index + 1)
            waypoints[index]["first_piece"] = len(pieces) + skipped
            waypoints[index]["end_piece"] = len(pieces) + len(leg)
        pieces += leg
    rows = _piece_rows(path, pieces)
    return Script(waypoints, join_records([rows, np.zeros(2 * len(path), PIECE)], PIECE))


def plan_leg(path: Sequence[Waypoint], script: Script, start: tuple[float, float], reached: int) -> slice:
    """Plan the path from a point [m] near a waypoint to the next stop, into the last pieces of a script.

    Returns:
        Which of the pieces they are.
    """
    stop = reached + 1
    while not stops_at(path, stop):
        stop += 1
    rows = _piece_rows(path, route([start, *(w.at_m for w in path[reached + 1 : stop + 1])], reached + 1))
    first = len(script.pieces) - 2 * len(path)
    script.pieces[first : first + len(rows)] = rows
    return slice(first, first + len(rows))


def _piece_rows(path: Sequence[Waypoint], pieces: Sequence[PathPiece]) -> Records:
    speeds = [_piece_speed(path, piece) for piece in pieces]
    rows = [
        (piece.start, piece.heading_rad, piece.length_m, piece.curvature, piece.goal, speed, speed**2)
        for piece, speed in zip(pieces, speeds, strict=True)
    ]
    return np.array(rows, PIECE)


def _piece_speed(path: Sequence[Waypoint], piece: PathPiece) -> float:
    """Return the planned speed [m/s], reduced on arcs that are too tight for it."""
    speed = path[piece.goal].speed_m_s
    return speed if piece.curvature == 0.0 else min(speed, TURN_RATE_RAD_S * 0.8 / abs(piece.curvature))


def face_people(path: Sequence[Waypoint], script: Script, places: Mapping[str, NDArray[np.float64]]) -> None:
    """Write the current positions, by name (2,) [m], of the people that a script faces."""
    for waypoint, row in zip(path, script.waypoints, strict=True):
        if isinstance(waypoint.face, str) and waypoint.face != "robot":
            place = places.get(waypoint.face)
            row["faces"] = ABSENT if place is None else POINT
            if place is not None:
                row["face"] = place


def start_walk(path: Sequence[Waypoint], script: Script, *, yields: bool, radius_m: float) -> Records:
    """Return (1,) records WALK of a person who is always present and has not moved yet."""
    walks, first = np.zeros(1, WALK), script.waypoints[0]
    walk = walks[0]
    walk["position"], walk["pause_left"], walk["piece"] = first["at"], first["pause_s"], -1
    walk["wait_left"] = first["waits_at_most_s"]
    walk["posture"] = first["posture"] if first["has_pause"] else POSTURES[Posture.STANDING]
    walk["radius_m"], walk["yields"], walk["leave_s"] = radius_m, yields, math.inf
    walk["is_present"], walk["pace"], walk["clear_m"], walk["heeds_robot"] = True, 1.0, -1.0, True
    if first["has_pause"] and first["faces"] == POINT:
        target = path[0].face
    elif len(path) > 1:
        target = path[1].at_m
    else:
        return walks
    assert isinstance(target, tuple)
    walk["heading"] = math.atan2(target[1] - path[0].at_m[1], target[0] - path[0].at_m[0])
    return walks


def join_records(records: Sequence[Records], kind: np.dtype[Any]) -> Records:
    """Concatenate records of one kind, as bytes: otherwise numpy compares dtypes field by field."""
    return np.concatenate([np.zeros(0, np.uint8), *(each.view(np.uint8) for each in records)]).view(kind)


def join_scripts(scripts: Sequence[Script]) -> Scripts:
    """Concatenate scripts."""
    return Scripts(
        waypoints=join_records([script.waypoints for script in scripts], WAYPOINT),
        pieces=join_records([script.pieces for script in scripts], PIECE),
        first_waypoint=np.cumsum([0, *(len(script.waypoints) for script in scripts)])[:-1].astype(np.int64),
        first_piece=np.cumsum([0, *(len(script.pieces) for script in scripts)])[:-1].astype(np.int64),
    )
