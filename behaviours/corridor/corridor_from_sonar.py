"""The corridor as the sonars hear it: the heading under which the echoes of each side agree on one wall."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.corridor.corridor_pose import Corridor, Unknown
from peopleboy.behaviours.corridor.wall_echoes import BeamConfig, wall_distances
from peopleboy.behaviours.percept import Percept, Points


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarCorridorConfig:
    """What counts as the echo of a wall.

    Attributes:
        beam: how a beam hears a wall.
        search_rad: [rad] headings tried to either side, with nothing expected ...
        near_rad: [rad] ... and about the expected heading.
        step_rad: [rad] between tried headings.
        agree_m: [m] an echo this far off the wall of the others counts as no worse than one farther off.
        expected_m: [m] an echo this far off the expected wall is a person, a door or a side corridor.
        least_echoes: echoes that a wall takes.
        worst_m: [m] walls whose echoes disagree by more, in the mean, are none.
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
    """One side's wall under every tried heading.

    Attributes:
        distance_m: (K,) [m] from the robot's origin, NaN where the echoes do not make a wall.
        spread_m: (K,) [m] mean disagreement of its echoes.
    """

    distance_m: Points
    spread_m: Points


def corridor_from_sonar(
    percept: Percept, expected: Corridor | None = None, config: SonarCorridorConfig | None = None
) -> Corridor | Unknown:
    """Find the centre line and heading from the side readings.

    Every heading turns each reading into a distance of the wall; the heading that is right is the one under
    which a side's readings agree.

    With nothing expected, both walls must be heard; else one will do, and the width is kept.

    Args:
        percept: with the sonars' ranges.
        expected: the place by dead reckoning; None where nothing is known.
        config: what counts as a wall.
    """
    config = SonarCorridorConfig() if config is None else config
    headings = _headings(expected, config)
    left = _walls(percept, headings, 1, expected, config)
    right = _walls(percept, headings, -1, expected, config)
    has_left, has_right = np.isfinite(left.distance_m), np.isfinite(right.distance_m)
    enough = has_left & has_right if expected is None else has_left | has_right
    if not enough.any():
        return Unknown("the sonars hear no walls along the way")
    count = has_left.astype(np.float64) + has_right
    spread = np.where(has_left, left.spread_m, 0.0) + np.where(has_right, right.spread_m, 0.0)
    # A wall less that is heard costs as much as the worst one, so that no heading wins by losing echoes.
    cost = np.where(enough, spread + (2.0 - count) * config.worst_m, np.inf)
    best = int(np.argmin(cost))
    width = None if expected is None else expected.width_m
    return _corridor(
        _finest(headings, cost, best), float(left.distance_m[best]), float(right.distance_m[best]),
        width, config,
    )  # fmt: skip


def _headings(expected: Corridor | None, config: SonarCorridorConfig) -> Points:
    """Give the headings to try: (K,) [rad]."""
    middle = 0.0 if expected is None else expected.heading_rad
    reach = config.search_rad if expected is None else config.near_rad
    steps = round(reach / config.step_rad)
    headings: Points = middle + config.step_rad * np.arange(-steps, steps + 1, dtype=np.float64)
    return headings


def _walls(
    percept: Percept, headings: Points, side: int, expected: Corridor | None, config: SonarCorridorConfig
) -> _Walls:
    """Take each side's readings for a wall under every heading; side is +1 for the left, -1 for the right."""
    normals = side * math.pi / 2.0 - headings
    distance, is_echo = wall_distances(percept, normals, config.beam)
    if expected is not None:
        wall_m = expected.width_m / 2.0 - side * expected.offset_m
        is_echo &= np.abs(distance - wall_m) < config.expected_m
    enough = is_echo.sum(axis=1) >= config.least_echoes
    heard = np.where(is_echo & enough[:, None], distance, np.nan)
    heard[~enough, 0] = 0.0  # a row of NaN alone has no median
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
    """Put the robot between its walls; a wall that is not heard stands where the known width says."""
    if width is not None and math.isnan(left):
        left = width - right
    if width is not None and math.isnan(right):
        right = width - left
    if not config.width_m[0] <= left + right <= config.width_m[1]:
        return Unknown(f"walls {left + right:.1f} m apart make no corridor")
    return Corridor(offset_m=(right - left) / 2.0, heading_rad=heading, width_m=left + right)
