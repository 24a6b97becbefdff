"""Soft shadows on the floor where people and things touch it, or are near above it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.surfaces import part_from_pixel
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.rendering.contacts import REACH_M, Contacts, gap
from peopleboy.sim.rendering.view import View

Array = NDArray[np.float64]

_EVERY = 4  # pixels between those whose light is reckoned, in row and column
_LEAST_WIDE_M = 0.05  # takes part in the sum, so that a stick takes some light, too
_SLOWLY_M = 0.12  # a gap of this height below something halves its shadow
_DEEPEST = 0.85  # share of the light from all around that is lost at most
_ALL_AROUND = 0.6  # share of a floor's light that comes from all around, and not from the lamps above


def add_contact_shadows(
    image: NDArray[np.float32], view: View, camera: Pinhole, world_from_camera: Matrix, contacts: Contacts
) -> None:
    """Darken the floor of an (H, W, 3) image near what stands on it, in place."""
    here = part_from_pixel(camera, world_from_camera, np.eye(4)[None])[0]
    _darken(
        image, view.part, contacts.is_floor, here, contacts.prints, contacts.corner, contacts.cell_m,
        contacts.count, contacts.members,
    )  # fmt: skip


@njit(cache=True, fastmath=True)
def _darken(
    image: NDArray[np.float32],
    part: NDArray[np.int32],
    is_floor: NDArray[np.bool_],
    here: Array,
    prints: Array,
    corner: Array,
    cell: float,
    count: NDArray[np.int64],
    members: NDArray[np.int64],
) -> None:
    height, width = part.shape
    # Light on the floor's plane at every fourth pixel, linear between: unknown until it is needed.
    coarse = np.full((height // _EVERY + 2, width // _EVERY + 2), np.float32(-1.0))
    for v in range(height):
        for u in range(width):
            if part[v, u] < 0 or not is_floor[part[v, u]]:
                continue
            j, i = v // _EVERY, u // _EVERY
            for y in range(j, j + 2):
                for x in range(i, i + 2):
                    if coarse[y, x] < 0.0:
                        at_u, at_v = float(_EVERY * x), float(_EVERY * y)
                        coarse[y, x] = _light(at_u, at_v, here, prints, corner, cell, count, members)
            across, down = (u - _EVERY * i) / _EVERY, (v - _EVERY * j) / _EVERY
            above = coarse[j, i] + across * (coarse[j, i + 1] - coarse[j, i])
            below = coarse[j + 1, i] + across * (coarse[j + 1, i + 1] - coarse[j + 1, i])
            light = above + down * (below - above)
            if light < 1.0:
                for c in range(3):
                    image[v, u, c] *= light


@njit(cache=True, fastmath=True)
def _light(
    u: float,
    v: float,
    here: Array,
    prints: Array,
    corner: Array,
    cell: float,
    count: NDArray[np.int64],
    members: NDArray[np.int64],
) -> float:
    """Share of light that the floor gets where a pixel's ray meets it."""
    fall = here[2, 0] * u + here[2, 1] * v + here[2, 2]
    if fall * here[2, 3] >= 0.0:
        return 1.0
    z = -here[2, 3] / fall
    x = (here[0, 0] * u + here[0, 1] * v + here[0, 2]) * z + here[0, 3] - corner[0]
    y = (here[1, 0] * u + here[1, 1] * v + here[1, 2]) * z + here[1, 3] - corner[1]
    if not (0.0 <= x < count.shape[1] * cell and 0.0 <= y < count.shape[0] * cell):
        return 1.0
    i, j = int(x / cell), int(y / cell)
    light = 1.0
    for k in range(count[j, i]):
        row = prints[members[j, i, k]]
        light *= 1.0 - lost_light(row, gap(row, x + corner[0], y + corner[1]))
    return 1.0 - _ALL_AROUND * min(1.0 - light, _DEEPEST)


@njit(cache=True, fastmath=True)
def lost_light(row: Array, away: float) -> float:
    """Share of an even sky's light that a footprint (9,) takes from a place so far [m] from it.

    An endless wall of height h takes (1 - d / sqrt(d^2 + h^2)) / 2 at a distance d. What is narrow takes
    less, the farther the less; what does not touch the floor takes less, the higher it begins.
    """
    if away >= REACH_M:
        return 0.0
    high, low = row[8], max(row[7], 0.0) / _SLOWLY_M
    wide = _LEAST_WIDE_M + row[5] + row[6] + 0.5 * row[4]
    wall = 0.5 * (1.0 - away / math.sqrt(away * away + high * high))
    fade = 1.0 - away / REACH_M
    lost: float = wall * wide / (wide + away) * fade / (1.0 + low * low)
    return lost
