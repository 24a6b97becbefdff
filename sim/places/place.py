"""What stands in a world: walls, floor, ceiling, and the things between them."""

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

# What is lower than a step or higher than a head is in nobody's way.
STEP_M = 0.03
HEAD_M = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixture:
    """One thing that stands there: a wall, a radiator, one part of a desk, or furniture from a URDF file.

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Sun:
    """Position of the sun, and its effect on floor and walls that it reaches through windows."""

    azimuth_deg: Annotated[Degrees, Field(description="where it stands: 0 is along x, 90 along y")]
    elevation_deg: Annotated[
        float, Field(ge=5.0, le=85.0, description="how high it stands above the horizon")
    ]
    warms_k: Annotated[
        float, Field(ge=0.0, le=40.0, description="how much warmer it makes what it shines on")
    ] = 8.0
    brightens: Annotated[
        float, Field(ge=0.0, le=5.0, description="how much brighter, as a share of the light without it")
    ] = 0.9

    @property
    def azimuth_rad(self) -> float:
        """[rad] where it stands, from +x towards +y."""
        return math.radians(self.azimuth_deg)

    @property
    def elevation_rad(self) -> float:
        """[rad] above the horizon."""
        return math.radians(self.elevation_deg)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """A room or corridor with everything that stands in it, or is moved there.

    Attributes:
        fixtures: all of it, drawn in this order; of what is moved, where it is at first.
        obstacles: (K, 4) [m] min x, min y, max x, max y of everything solid that stands on the floor and
            that nobody moves.
        obstacle_names: the K names, for messages.
        bounds: [m] min x, min y, max x, max y of the floor and the walls around it.
        surroundings_c: [degC] what surfaces of low emissivity mirror.
        light: (time [s], level) steps of the room's light; level 1 is full, 0 is dark.
        movers: the things to which something happens.
        sun: the sun, where it shines in; only `detail: full` shows it.
        things: names of the things in it, in the order in which they were given.
        seats: names of those that one may sit on.
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
        """(K, 4) [m] as `obstacles`, with what is moved where it is at a time."""
        boxes = [box for mover in self.movers if (box := _ground_box(mover, time_s)) is not None]
        return np.concatenate([self.obstacles, boxes]) if boxes else self.obstacles


def air_of(place: Place) -> float:
    """Return the temperature [degC] of the air of a place, which people's surfaces follow."""
    return place.surroundings_c


def is_outdoors(place: Place) -> bool:
    """Return whether there is a street, over which wind blows."""
    floors = (fixture.part.material.covering for fixture in place.fixtures if fixture.part is not None)
    return Covering.STREET in floors


def _ground_box(mover: Mover, time_s: float) -> NDArray[np.float64] | None:
    """The rectangle (4,) around a thing at a time; None if it is in nobody's way."""
    state = mover.at(time_s)
    corners = state.stance.place(mover.corners())
    low, high = corners.min(axis=0), corners.max(axis=0)
    if not state.is_there or not is_in_the_way(low[2], high[2]):
        return None
    return np.concatenate([low[:2], high[:2]])


def is_in_the_way(low_m: float, high_m: float) -> bool:
    """Whether people bump into what reaches from one height to another: no step, and not overhead."""
    return low_m < HEAD_M and high_m > STEP_M
