"""Pose of the robot in a corridor, and choice of a lane past people."""

import math
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.percept import Points


@dataclass(frozen=True, slots=True, kw_only=True)
class Corridor:
    """Pose of the robot in a straight corridor.

    Attributes:
        offset_m: [m] distance of the robot's origin to the left of the centre line.
        heading_rad: [rad] heading relative to the corridor, positive to the left.
        width_m: [m] from wall to wall.
    """

    offset_m: float
    heading_rad: float
    width_m: float


@dataclass(frozen=True, slots=True)
class Unknown:
    """No corridor was recognised.

    Attributes:
        reason: explanation, for the log.
    """

    reason: str


def drive_on(corridor: Corridor, motion: RobotMotion) -> Corridor:
    """Predict the pose after a motion of the robot."""
    mean_heading = corridor.heading_rad + motion.turn_rad / 2.0
    return replace(
        corridor,
        offset_m=corridor.offset_m + motion.way_m * math.sin(mean_heading),
        heading_rad=corridor.heading_rad + motion.turn_rad,
    )


def blend(expected: Corridor, seen: Corridor, share: float) -> Corridor:
    """Correct the predicted pose by a share of its difference from the measured one."""
    return Corridor(
        offset_m=expected.offset_m + share * (seen.offset_m - expected.offset_m),
        heading_rad=expected.heading_rad + share * (seen.heading_rad - expected.heading_rad),
        width_m=expected.width_m + share * (seen.width_m - expected.width_m),
    )


# Choice of a lane in the corridor, past people in it.


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneConfig:
    """Clearances.

    Attributes:
        ahead_m: [m] range ahead in which people are avoided.
        behind_m: [m] the same behind.
        wish_m: [m] preferred distance between the robot's centre and the nearest echo of a person.
        least_m: [m] least such distance; a lane with less is blocked ...
        squeeze_m: [m] ... or, while the robot is already passing on it, with less than this: beams are wide,
            and echoes of a nearby person spread.
        wall_m: [m] least distance between the robot's centre and a wall.
        step_m: [m] distance of lanes.
    """

    ahead_m: float = 2.2
    behind_m: float = 0.35
    wish_m: float = 0.75
    least_m: float = 0.55
    squeeze_m: float = 0.35
    wall_m: float = 0.55
    step_m: float = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """A lane along the corridor.

    Attributes:
        offset_m: [m] left of the centre line.
        clearance_m: [m] to the nearest echo next to it, infinite without one.
    """

    offset_m: float
    clearance_m: float


def in_corridor(points: Points, corridor: Corridor) -> Points:
    """Transform echoes to the corridor: (N, 2) [m] ahead of the robot, and left of the centre line."""
    cos, sin = math.cos(corridor.heading_rad), math.sin(corridor.heading_rad)
    ahead = points[:, 0] * cos - points[:, 1] * sin
    left = corridor.offset_m + points[:, 0] * sin + points[:, 1] * cos
    return np.stack([ahead, left], axis=1)


def beside(places: Points, corridor: Corridor, config: LaneConfig) -> Points:
    """Return the echoes between the walls, and within range along the corridor: (M, 2) [m]."""
    ahead, left = places.T
    is_near = (ahead > -config.behind_m) & (ahead < config.ahead_m)
    kept: Points = places[is_near & (np.abs(left) < corridor.width_m / 2.0)]
    return kept


def middle_lane(people: Points) -> Lane:
    """Return the centre line."""
    return Lane(offset_m=0.0, clearance_m=float(np.min(np.abs(people[:, 1]), initial=np.inf)))


def best_lane(people: Points, corridor: Corridor, config: LaneConfig, side: int = 0) -> Lane:
    """Return the lane nearest to the centre line with the preferred clearance, or else the clearest one.

    Args:
        people: (M, 2) [m] ahead of the robot, and left of the centre line.
        corridor: for its width.
        config: room to leave.
        side: +1 for lanes to the left of the centre line only, -1 for those to the right, 0 for all.
    """
    room = max(corridor.width_m / 2.0 - config.wall_m, 0.0)
    steps = math.floor(room / config.step_m)
    lanes = config.step_m * np.arange(-steps if side <= 0 else 0, (steps if side >= 0 else 0) + 1)
    clearance = np.abs(lanes[:, None] - people[:, 1]).min(axis=1, initial=np.inf)
    missing = np.maximum(config.wish_m - clearance, 0.0)
    # Clearance first, then distance from the centre line.
    best = int(np.lexsort((np.abs(lanes), np.round(missing, 3)))[0])
    return Lane(offset_m=float(lanes[best]), clearance_m=float(clearance[best]))
