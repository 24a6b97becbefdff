"""What stands still in a world: walls, floor, ceiling, and the things between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shapes import UPRIGHT, Part, Quaternion, Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixture:
    """One thing that stands still: a wall, a radiator, one part of a desk, or furniture from a URDF file.

    Attributes:
        name: unique; what comes before a "/" names the thing that it is part of ("monitor_1/screen").
        part: shapes and look; None for a URDF.
        urdf: file known to PyBullet, such as "table/table.urdf"; None for parts.
        material: of every surface of a URDF, its colours being the file's own; None for parts.
        scale: of a URDF.
        position: [m] world frame.
        orientation: x, y, z, w quaternion, world from fixture.
        is_solid: whether it stops robot, people and sonar.
    """

    name: str
    part: Part | None = None
    urdf: str | None = None
    material: Material | None = None
    scale: float = 1.0
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = UPRIGHT
    is_solid: bool = True


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """A room or corridor with everything that stands in it.

    Attributes:
        fixtures: all of it, drawn in this order.
        obstacles: (K, 4) [m] min x, min y, max x, max y of everything solid that stands on the floor.
        obstacle_names: the K names, for messages.
        bounds: [m] min x, min y, max x, max y of the floor and the walls around it.
        surroundings_c: [degC] what surfaces of low emissivity mirror.
        light: (time [s], level) steps of the room's light; level 1 is full, 0 is dark.
    """

    fixtures: tuple[Fixture, ...]
    obstacles: NDArray[np.float64]
    obstacle_names: tuple[str, ...]
    bounds: tuple[float, float, float, float]
    surroundings_c: float = 21.0
    light: tuple[tuple[float, float], ...] = ((0.0, 1.0),)
