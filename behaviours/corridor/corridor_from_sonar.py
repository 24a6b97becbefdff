"""Localisation in a corridor by sonar: at the right heading, the echoes of each side agree on one wall."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.corridor.corridor_geometry import Corridor, Unknown
from peopleboy.behaviours.percept import Percept, Points, Ranges
from peopleboy.behaviours.sonar_echoes import RING_CENTRE_X_M, RING_HALF_AXES_M

# Range of a sonar's beam to a straight wall.

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class BeamConfig:
    """A sonar's beam.

    Attributes:
        half_cone_rad: [rad] half the beam angle; the echo comes from the wall's nearest point in the cone.
        reach_m: [m] a longer range is not an echo.
        slant_rad: [rad] a beam that hits a wall at a larger angle of incidence is not used.
    """

    half_cone_rad: float = math.radians(7.5)
    reach_m: float = 4.9
    slant_rad: float = math.radians(68.0)


def wall_distances(percept: Percept, normals_rad: Points, beam: BeamConfig) -> tuple[Points, Flags]:
    """Convert each reading to a distance [m] from the robot's origin to the wall, and return its validity.

    A beam at an angle a from the wall's normal measures distance / cos(a - half cone), or the distance itself
    if the cone includes the normal.

    Args:
        percept: with the sonars' ranges.
        normals_rad: (K,) [rad] candidate directions of a wall in the robot frame.
        beam: the sonars' beams.

    Returns:
        (K, N) distances, and whether the beam can have measured that wall.
    """
    off = np.abs(np.angle(np.exp(1j * (percept.sonar_angle_rad - normals_rad[:, None]))))
    slant = np.maximum(off - beam.half_cone_rad, 0.0)
    facing = np.stack([np.cos(normals_rad), np.sin(normals_rad)])  # (2, K)
    distance = percept.sonar_m * np.cos(slant) + (mounts(percept.sonar_angle_rad) @ facing).T
    return distance, (slant < beam.slant_rad) & (percept.sonar_m < beam.reach_m)


def without_walls(percept: Percept, walls: Points, tolerance_m: float, beam: BeamConfig) -> Ranges:
    """Keep only obstacles: ranges explained by a wall become infinite: (N,) [m].

    Args:
        percept: with the sonars' ranges.
        walls: (K, 2) direction [rad] in the robot frame and distance [m] of each wall.
        tolerance_m: [m] an echo less than this in front of a wall, or behind it, belongs to the wall.
        beam: the sonars' beams.
    """
    distance, _ = wall_distances(percept, walls[:, 0], beam)
    off = np.abs(np.angle(np.exp(1j * (percept.sonar_angle_rad - walls[:, :1]))))
    is_wall = (off < math.pi / 2.0) & (distance > walls[:, 1:] - tolerance_m)
    left: Ranges = np.where(is_wall.any(axis=0) | (percept.sonar_m >= beam.reach_m), np.inf, percept.sonar_m)
    return left


def side_walls(corridor: Corridor) -> Points:
    """Return direction [rad] and distance [m] of the left and the right wall: (2, 2), robot frame."""
    half = corridor.width_m / 2.0
    return np.array(
        [
            (math.pi / 2.0 - corridor.heading_rad, half - corridor.offset_m),
            (-math.pi / 2.0 - corridor.heading_rad, half + corridor.offset_m),
        ]
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarCorridorConfig:
    """Thresholds of wall echoes.

    Attributes:
        beam: model of a beam.
        search_rad: [rad] range of candidate headings to either side without a prediction ...
        near_rad: [rad] ... and around a predicted heading.
        step_rad: [rad] step of candidate headings.
        agree_m: [m] limit of an echo's deviation from the wall of the others.
        expected_m: [m] an echo at least this far from the expected wall belongs to a person, a door or a side
            corridor.
        least_echoes: least number of echoes of a wall.
        worst_m: [m] greatest mean deviation of a wall's echoes.
        width_m: [m] least and largest width of a corridor.
    """

    beam: BeamConfig = field(default_factory=BeamConfig)
    search_rad: float = math.radians(45.0)
    near_rad: float = math.radians(12.0)
    step_rad: float = math.radians(0.5)
    agree_m: float = 0.15
    expected_m: float = 0.3
    least_echoes: int = 3
    worst_m: float = 0.08
    width_m: tuple[float, float] = (1.1, 7.0)


@dataclass(frozen=True, slots=True, eq=False)
class _Walls:
    """Wall of one side for every candidate heading.

    Attributes:
        distance_m: (K,) [m] from the robot's origin, NaN where the echoes do not form a wall.
        spread_m: (K,) [m] mean deviation of its echoes.
    """

    distance_m: Points
    spread_m: Points


def corridor_from_sonar(
    percept: Percept, expected: Corridor | None = None, config: SonarCorridorConfig | None = None
) -> Corridor | Unknown:
    """Return the corridor from the side readings.

    Every candidate heading converts each reading to a distance of the wall; at the right heading a side's
    readings agree.

    Without a prediction, both walls must be detected; otherwise one suffices, and the width is kept.

    Args:
        percept: with the sonars' ranges.
        expected: the corridor predicted by dead reckoning; None if unknown.
        config: thresholds.
    """
    config = SonarCorridorConfig() if config is None else config
    headings = _headings(expected, config)
    left = _walls(percept, headings, 1, expected, config)
    right = _walls(percept, headings, -1, expected, config)
    has_left, has_right = np.isfinite(left.distance_m), np.isfinite(right.distance_m)
    enough = has_left & has_right if expected is None else has_left | has_right
    if not enough.any():
        return Unknown("the sonars detect no corridor walls")
    count = has_left.astype(np.float64) + has_right
    spread = np.where(has_left, left.spread_m, 0.0) + np.where(has_right, right.spread_m, 0.0)
    # An undetected wall costs as much as the worst one, so that a heading cannot win by losing echoes.
    cost = np.where(enough, spread + (2.0 - count) * config.worst_m, np.inf)
    best = int(np.argmin(cost))
    width = None if expected is None else expected.width_m
    return _corridor(
        _finest(headings, cost, best), float(left.distance_m[best]), float(right.distance_m[best]),
        width, config,
    )  # fmt: skip


def _headings(expected: Corridor | None, config: SonarCorridorConfig) -> Points:
    """Return the candidate headings: (K,) [rad]."""
    middle = 0.0 if expected is None else expected.heading_rad
    reach = config.search_rad if expected is None else config.near_rad
    steps = round(reach / config.step_rad)
    headings: Points = middle + config.step_rad * np.arange(-steps, steps + 1, dtype=np.float64)
    return headings


def _walls(
    percept: Percept, headings: Points, side: int, expected: Corridor | None, config: SonarCorridorConfig
) -> _Walls:
    """Return each side's wall for every heading; side is +1 for the left, -1 for the right."""
    normals = side * math.pi / 2.0 - headings
    distance, is_echo = wall_distances(percept, normals, config.beam)
    if expected is not None:
        wall_m = expected.width_m / 2.0 - side * expected.offset_m
        is_echo &= np.abs(distance - wall_m) < config.expected_m
    enough = is_echo.sum(axis=1) >= config.least_echoes
    heard = np.where(is_echo & enough[:, None], distance, np.nan)
    heard[~enough, 0] = 0.0  # a row of NaN has no median
    median = np.nanmedian(heard, axis=1)
    off = np.minimum(np.abs(heard - median[:, None]), config.agree_m)
    spread = np.nanmean(off, axis=1)
    is_wall = enough & (spread < config.worst_m)
    return _Walls(np.where(is_wall, median, np.nan), spread)


def _finest(headings: Points, cost: Points, best: int) -> float:
    """Refine the best heading [rad] by the parabola through it and its neighbours."""
    if not 0 < best < len(cost) - 1 or not np.isfinite(cost[best - 1 : best + 2]).all():
        return float(headings[best])
    before, here, after = cost[best - 1 : best + 2]
    bend = before - 2.0 * here + after
    shift = 0.0 if bend <= 0.0 else 0.5 * (before - after) / bend
    return float(headings[best] + shift * (headings[best] - headings[best - 1]))


def _corridor(
    heading: float, left: float, right: float, width: float | None, config: SonarCorridorConfig
) -> Corridor | Unknown:
    """Return the robot's pose between the walls; an undetected wall is placed by the known width."""
    if width is not None and math.isnan(left):
        left = width - right
    if width is not None and math.isnan(right):
        right = width - left
    if not config.width_m[0] <= left + right <= config.width_m[1]:
        return Unknown(f"walls {left + right:.1f} m apart are not a corridor")
    return Corridor(offset_m=(right - left) / 2.0, heading_rad=heading, width_m=left + right)


# Positions of the sonars on the robot.

# Distance of the PeopleBot's sideways units in front of and behind the ellipse of all others.
SIDEWAYS_M = 0.113


def mounts(angle_rad: Points) -> Points:
    """Return the sonars' positions by their directions [rad]: (N, 2) [m], x forward, y left.

    Of two units of the same direction, which only sideways units have, the first is in front.

    Source: ARIA's peoplebot-sh.p, SonarUnit 0..15, within 3 cm.
    """
    places: Points = np.stack([np.cos(angle_rad), np.sin(angle_rad)], axis=1) * RING_HALF_AXES_M
    places[:, 0] += RING_CENTRE_X_M
    is_same = np.abs(angle_rad[:, None] - angle_rad) < 1e-6
    has_later, has_earlier = np.triu(is_same, 1).any(axis=1), np.tril(is_same, -1).any(axis=1)
    places[:, 0] += SIDEWAYS_M * (has_later.astype(np.float64) - has_earlier)
    return places


# Ends of a corridor: a wall across it, and openings next to it.


@dataclass(frozen=True, slots=True, kw_only=True)
class EndConfig:
    """Thresholds of an end wall, and of an open side.

    Attributes:
        beam: model of a beam; only beams that point ahead can detect an end wall.
        side_beam: the same for the side walls, whose echoes do not belong to an end wall.
        farthest_m: [m] greatest distance of an end wall.
        agree_m: [m] the echoes of one wall lie within this distance of their median.
        least_echoes: least number of echoes of the four sonars ahead; a person gives two.
        open_m: [m] a side is open if the sideways sonars have no echo up to this far behind its wall.
        sideways_rad: [rad] greatest angle of those sonars to the side's direction.
    """

    beam: BeamConfig = field(default_factory=lambda: BeamConfig(slant_rad=math.radians(35.0)))
    side_beam: BeamConfig = field(default_factory=BeamConfig)
    farthest_m: float = 3.0
    agree_m: float = 0.12
    least_echoes: int = 3
    open_m: float = 0.6
    sideways_rad: float = math.radians(20.0)


def wall_ahead(percept: Percept, corridor: Corridor, config: EndConfig) -> float | None:
    """Return the distance [m] along the corridor to an end wall; None if there is none near."""
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
    """Return the free distance [m] behind the left and the right wall; 0 for a closed side."""
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
