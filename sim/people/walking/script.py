"""Scripts and who follows them, as arrays for kernels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.body.stance import POSTURES
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.people.walking.path import PathPiece, route
from peopleboy.sim.people.walking.walker import Walker

Records = NDArray[Any]

NOTHING, POINT, ROBOT = 0, 1, 2  # what to face while pausing
WAYPOINT: Final = np.dtype(
    [
        ("at", np.float64, 2),  # [m]
        ("pause_s", np.float64),  # inf at the last one
        ("has_pause", np.bool_),
        ("posture", np.int64),  # there, its number in `POSTURES`
        ("faces", np.int64),
        ("face", np.float64, 2),  # [m]
        ("speed", np.float64),  # [m/s] on the way there, as planned
        ("first_piece", np.int64),  # of the way on from here to the next stop
        ("end_piece", np.int64),
    ]
)
"""A `Waypoint`; numbers of pieces are those within a script."""

PIECE: Final = np.dtype(
    [
        ("start", np.float64, 2),  # [m]
        ("heading", np.float64),  # [rad] at the start
        ("length", np.float64),  # [m]
        ("curvature", np.float64),  # [1/m]
        ("goal", np.int64),  # number of the waypoint to which it leads
        ("speed", np.float64),  # [m/s] as planned
        ("speed_squared", np.float64),
    ]
)
"""A `PathPiece`."""

WALK: Final = np.dtype(
    [
        ("position", np.float64, 2),  # [m]
        ("velocity", np.float64, 2),  # [m/s]
        ("heading", np.float64),  # [rad]
        ("speed", np.float64),  # [m/s]
        ("along", np.float64),  # [m] on the piece
        ("pause_left", np.float64),  # [s]
        ("on_feet_in", np.float64),  # [s]
        ("reached", np.int64),
        ("piece", np.int64),  # under way on it; -1 in a pause
        ("end_piece", np.int64),
        ("turn_rate", np.float64),  # [rad/s]
        ("posture", np.int64),  # the one to take up, its number in `POSTURES`
        ("is_present", np.bool_),
        ("has_moved", np.bool_),  # in the last step, there before and after it
        ("enter_s", np.float64),
        ("leave_s", np.float64),  # inf for never
        ("radius_m", np.float64),
        ("yields", np.bool_),
        ("blocked_s", np.float64),  # for how long it has got on badly
    ]
)
"""What a `Walker` knows of itself while its script and who is in its way alone decide where it goes."""


class Script(NamedTuple):
    """What somebody is to do: (W,) records WAYPOINT and (P,) records PIECE."""

    waypoints: Records
    pieces: Records

    @classmethod
    def nothing(cls) -> Script:
        """That of somebody who has none."""
        return cls(np.zeros(0, WAYPOINT), np.zeros(0, PIECE))


class ScriptedWalk(NamedTuple):
    """What the people of one world are to do, and (N,) records WALK of how far they are.

    Its walls are (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    scripts: list[Script]
    records: Records
    walls: NDArray[np.float64]


def is_scripted(config: PersonConfig) -> bool:
    """Whether nothing decides where a person goes and looks but its script and who is in its way."""
    is_alone = config.reacts is None and config.leads is None and config.group is None
    return is_alone and all(
        waypoint.until_robot_within_m is None
        and (not isinstance(waypoint.face, str) or waypoint.face == "robot")
        for waypoint in config.path
    )


def write_script(config: PersonConfig, walker: Walker) -> Script:
    """Plan all ways between stops at once; the walker is that of the person."""
    path = config.path
    pieces: list[PathPiece] = []
    waypoints = np.zeros(len(path), WAYPOINT)
    for index, (waypoint, row) in enumerate(zip(path, waypoints, strict=True)):
        row["at"], row["pause_s"] = waypoint.at_m, walker.pause_of(index)
        row["speed"] = waypoint.speed_m_s
        row["has_pause"] = walker.has_pause(index)
        row["posture"] = POSTURES[Posture(waypoint.posture)]
        if waypoint.face is not None:
            row["faces"] = ROBOT if isinstance(waypoint.face, str) else POINT
            row["face"] = (0.0, 0.0) if isinstance(waypoint.face, str) else waypoint.face
        row["first_piece"] = len(pieces)
        if index < len(path) - 1 and (index == 0 or walker.stops_at(index)):
            stop = index + 1
            while not walker.stops_at(stop):
                stop += 1
            pieces += route([each.at_m for each in path[index : stop + 1]], index + 1)
        row["end_piece"] = len(pieces)
    speeds = [walker.piece_speed(piece) for piece in pieces]
    rows = [
        (piece.start, piece.heading_rad, piece.length_m, piece.curvature, piece.goal, speed, speed**2)
        for piece, speed in zip(pieces, speeds, strict=True)
    ]
    return Script(waypoints, np.array(rows, PIECE))


def start_walk(config: PersonConfig, walker: Walker, radius_m: float, walk: np.void) -> None:
    """Fill the record WALK of a person who has not moved yet."""
    walk["position"], walk["heading"] = walker.position, walker.heading
    walk["pause_left"], walk["piece"] = walker.pause_of(0), -1
    walk["posture"] = POSTURES[walker.posture]
    walk["is_present"] = config.enter_s <= 0.0
    walk["enter_s"] = config.enter_s
    walk["leave_s"] = np.inf if config.leave_s is None else config.leave_s
    walk["radius_m"], walk["yields"] = radius_m, config.yields


class Scripts(NamedTuple):
    """The scripts of Q people, one after the other.

    Attributes:
        waypoints, pieces: of all of them.
        first_waypoint, first_piece: (Q,) where each one's begin.
    """

    waypoints: Records
    pieces: Records
    first_waypoint: NDArray[np.int64]
    first_piece: NDArray[np.int64]


def join_records(records: Sequence[Records], kind: np.dtype[Any]) -> Records:
    """Put records of one kind one after the other, as bytes: else numpy compares kinds field by field."""
    return np.concatenate([np.zeros(0, np.uint8), *(each.view(np.uint8) for each in records)]).view(kind)


def join_scripts(scripts: Sequence[Script]) -> Scripts:
    """Put scripts one after the other."""
    return Scripts(
        waypoints=join_records([script.waypoints for script in scripts], WAYPOINT),
        pieces=join_records([script.pieces for script in scripts], PIECE),
        first_waypoint=np.cumsum([0, *(len(script.waypoints) for script in scripts)])[:-1].astype(np.int64),
        first_piece=np.cumsum([0, *(len(script.pieces) for script in scripts)])[:-1].astype(np.int64),
    )
