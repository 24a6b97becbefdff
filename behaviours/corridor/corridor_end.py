"""Where a corridor ends: a wall across it, and the ways that open beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.corridor.corridor_pose import Corridor
from peopleboy.behaviours.corridor.wall_echoes import BeamConfig, side_walls, wall_distances
from peopleboy.behaviours.percept import Percept


@dataclass(frozen=True, slots=True, kw_only=True)
class EndConfig:
    """What counts as a wall across, and as an open side.

    Attributes:
        beam: how a beam hears a wall; across, only those that look ahead count.
        side_beam: the same for the walls at the sides, whose echoes are none of a wall across.
        farthest_m: [m] a wall across is looked for up to here.
        agree_m: [m] the echoes of one wall lie within this of their middle.
        least_echoes: of the four sonars ahead; a person is heard by two.
        open_m: [m] a side is open where the sideways sonars hear nothing up to this far behind its wall.
        sideways_rad: [rad] those sonars look this close to the side's direction.
    """

    beam: BeamConfig = field(default_factory=lambda: BeamConfig(slant_rad=math.radians(35.0)))
    side_beam: BeamConfig = field(default_factory=BeamConfig)
    farthest_m: float = 3.0
    agree_m: float = 0.12
    least_echoes: int = 3
    open_m: float = 0.6
    sideways_rad: float = math.radians(20.0)


def wall_ahead(percept: Percept, corridor: Corridor, config: EndConfig) -> float | None:
    """Give the distance [m] along the corridor to a wall across it; None if there is none near."""
    distances, can_be = wall_distances(percept, np.array([-corridor.heading_rad]), config.beam)
    to_sides, can_be_side = wall_distances(percept, side_walls(corridor)[:, 0], config.side_beam)
    is_side = can_be_side & (np.abs(to_sides - side_walls(corridor)[:, 1:]) < config.agree_m)
    heard = distances[0][can_be[0] & ~is_side.any(axis=0)]
    if len(heard) < config.least_echoes:
        return None
    middle = float(np.median(heard))
    agreeing = int(np.sum(np.abs(heard - middle) < config.agree_m))
    return middle if agreeing >= config.least_echoes and middle < config.farthest_m else None


def open_room(percept: Percept, corridor: Corridor, config: EndConfig) -> tuple[float, float]:
    """Give how far [m] one can go behind where the left and the right wall should be; 0 for a closed side."""
    left, right = (
        _room(percept, float(direction), float(distance), config)
        for direction, distance in side_walls(corridor)
    )
    return left, right


def _room(percept: Percept, direction_rad: float, wall_m: float, config: EndConfig) -> float:
    off = np.abs(np.angle(np.exp(1j * (percept.sonar_angle_rad - direction_rad))))
    ranges = percept.sonar_m[off < config.sideways_rad]
    room = float(np.max(ranges, initial=0.0)) - wall_m
    return room if room > config.open_m else 0.0
