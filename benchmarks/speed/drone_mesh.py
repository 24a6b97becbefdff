"""A mesh of as many triangles as that of the drone whose world is timed, and of its size."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

Corners = NDArray[np.float64]  # (V, 3) [m], drone frame
Triangles = NDArray[np.int64]  # (T, 3) numbers of corners


@dataclass(frozen=True, slots=True)
class Prism:
    """An upright prism, of 4 triangles a side but for 4.

    Attributes:
        sides: at least 3.
        radius_m, height_m: its size [m].
        centre_m: [m] drone frame.
    """

    sides: int
    radius_m: float
    height_m: float
    centre_m: tuple[float, float, float]


_ARMS_M: Final = tuple(product((0.0326, -0.0326), repeat=2))
# The parts of cf2.dae, as it is drawn: 9434 triangles, of which prisms have 9424.
PARTS: Final = (
    *(Prism(199, 0.023, 0.001, (x, y, 0.012)) for x, y in _ARMS_M),  # propellers
    *(Prism(38, 0.0035, 0.015, (x, y, 0.0)) for x, y in _ARMS_M),  # motors
    *(Prism(83, 0.005, 0.008, (x, y, 0.0)) for x, y in _ARMS_M),  # their mounts
    *(Prism(10, 0.003, 0.003, (0.8 * x, 0.8 * y, 0.0)) for x, y in _ARMS_M),  # arms
    Prism(301, 0.014, 0.002, (0.0, 0.0, 0.0)),  # circuit board
    Prism(14, 0.012, 0.002, (0.0, 0.0, -0.003)),
    Prism(4, 0.012, 0.004, (0.0, 0.0, 0.004)),
    *(Prism(4, 0.01, 0.002, (0.0, y, 0.003)) for y in (-0.01, 0.01)),  # headers
    *(Prism(38 - pin % 2, 0.0005, 0.01, (0.001 * (pin - 10), 0.01, 0.003)) for pin in range(20)),
)


def drone_mesh() -> tuple[Corners, Triangles]:
    """Put all parts together."""
    corners, triangles, start = [], [], 0
    for prism in PARTS:
        ends, faces = _mesh_of(prism)
        corners.append(ends)
        triangles.append(faces + start)
        start += len(ends)
    return np.concatenate(corners), np.concatenate(triangles)


def _mesh_of(prism: Prism) -> tuple[Corners, Triangles]:
    sides = prism.sides
    turn = 2.0 * np.pi * np.arange(sides) / sides
    ring = prism.radius_m * np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
    up = np.array([0.0, 0.0, prism.height_m / 2.0])
    corners = np.concatenate([ring - up, ring + up]) + prism.centre_m
    one, fan = np.arange(sides), np.arange(1, sides - 1)
    other, hub = (one + 1) % sides, np.zeros_like(fan)
    faces = [(one, other, other + sides), (one, other + sides, one + sides), (hub, fan + 1, fan)]
    faces.append((hub + sides, fan + sides, fan + 1 + sides))
    return corners, np.concatenate([np.stack(face, axis=1) for face in faces])
