"""The place of a world: walls, floor, ceiling and things."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.settings import Degrees
from peopleboy.sim.places.moving import Mover
from peopleboy.sim.shapes.materials import Covering, Material
from peopleboy.sim.shapes.shapes import UPRIGHT, Part, Quaternion, Vector

# Objects lower than a step or above head height are not obstacles.
STEP_M = 0.03
HEAD_M = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixture:
    """One object of a place: a wall, a radiator, one part of a desk, or furniture from a URDF file.

    Attributes:
        name: unique; the part before a "/" is the name of its thing ("monitor_1/screen").
        part: shapes and appearance; None for a URDF.
        urdf: file known to PyBullet, such as "table/table.urdf"; None for parts.
        material: material of every surface of a URDF, with the colours of the file; None for parts.
        scale: scale of a URDF.
        position: [m] world frame.
        orientation: x, y, z, w quaternion, world from fixture.
        is_solid: whether robot, people and sonar rays collide with it.
    """

    name: str
    part: Part | None = None
    urdf: str | None = None
    material: Material | None = None
    scale: float = 1.0
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = UPRIGHT
    is_solid: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Sun:
    """The sun, and its effect on floor and walls that it reaches through windows."""

    azimuth_deg: Annotated[Degrees, Field(description="azimuth; 0 is the direction of x, and 90 that of y")]
    elevation_deg: Annotated[float, Field(ge=5.0, le=85.0, description="elevation above the horizon")]
    warms_k: Annotated[float, Field(ge=0.0, le=40.0, description="temperature rise of sunlit surfaces")] = 8.0
    brightens: Annotated[
        float,
        Field(ge=0.0, le=5.0, description="increase in brightness, as a share of the light without sun"),
    ] = 0.9

    @property
    def azimuth_rad(self) -> float:
        """Azimuth [rad], from +x towards +y."""
        return math.radians(self.azimuth_deg)

    @property
    def elevation_rad(self) -> float:
        """Elevation above the horizon [rad]."""
        return math.radians(self.elevation_deg)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """A room, corridor or street with its static and moving objects.

    Attributes:
        fixtures: all objects in drawing order; moving ones at their initial poses.
        obstacles: (K, 4) [m] min x, min y, max x, max y of all static solid objects
            on the floor.
        obstacle_names: the K names of the obstacles, for messages.
        bounds: [m] min x, min y, max x, max y of the floor and the walls around it.
        surroundings_c: [degC] temperature of the surroundings, which surfaces of low emissivity reflect.
        light: (time [s], level) steps of the room's light; level 1 is full, 0 is dark.
        movers: the moving things.
        sun: the sun, if there is any; visible only with `detail: full`.
        things: names of the things, in the given order.
        seats: names of the things that people can sit on.
    """

    fixtures: tuple[Fixture, ...]
    obstacles: NDArray[np.float64]
    obstacle_names: tuple[str, ...]
    bounds: tuple[float, float, float, float]
    surroundings_c: float = 21.0
    light: tuple[tuple[float, float], ...] = ((0.0, 1.0),)
    movers: tuple[Mover, ...] = ()
    sun: Sun | None = None
    things: tuple[str, ...] = ()
    seats: frozenset[str] = frozenset()

    def obstacles_at(self, time_s: float) -> NDArray[np.float64]:
        """Return (K, 4) [m] rectangles as in `obstacles`, including moving things at a time."""
        boxes = [box for mover in self.movers if (box := _ground_box(mover, time_s)) is not None]
        return np.concatenate([self.obstacles, boxes]) if boxes else self.obstacles


def air_of(place: Place) -> float:
    """Return the air temperature [degC] of a place, which people's surfaces follow."""
    return place.surroundings_c


def is_outdoors(place: Place) -> bool:
    """Return whether the place is a street, which has wind."""
    floors = (fixture.part.material.covering for fixture in place.fixtures if fixture.part is not None)
    return Covering.STREET in floors


def _ground_box(mover: Mover, time_s: float) -> NDArray[np.float64] | None:
    """Return the rectangle (4,) around a thing at a time; None if it is no obstacle."""
    state = mover.at(time_s)
    corners = state.stance.place(mover.corners())
    low, high = corners.min(axis=0), corners.max(axis=0)
    if not state.is_there or not is_in_the_way(low[2], high[2]):
        return None
    return np.concatenate([low[:2], high[:2]])


def is_in_the_way(low_m: float, high_m: float) -> bool:
    """Return whether an object between two heights is an obstacle: neither a step nor overhead."""
    return low_m < HEAD_M and high_m > STEP_M
