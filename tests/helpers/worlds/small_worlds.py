"""Places, people and settings that the tests of the world share."""

import math
from functools import cache

from peopleboy.sim.cameras.camera_config import ColourConfig, ThermalConfig
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig, SonarConfig
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shapes import Part, Shape, ShapeKind
from peopleboy.sim.world_config import WorldConfig

SMALL = Pinhole(width=160, height=120)
EXACT_SONAR = SonarConfig(noise_m=0.0, drop_out=0.0)
NO_NOISE = ThermalConfig(netd_k=0.0, fixed_pattern_k=0.0, dead_pixels=0.0)


@cache
def hall(*things: Fixture) -> Place:
    """A hall of 16 x 12 m, x from 0, centred on y = 0."""
    return build_place(straight_corridor(16.0, 12.0), things=things)


def box_thing(name: str, size: tuple, position: tuple, material: Material | None = None) -> Fixture:
    shape = Shape(kind=ShapeKind.BOX, size=size)
    part = Part(
        name=name, shapes=(shape,), material=Material(temperature_c=21.0) if material is None else material
    )
    return Fixture(name=name, part=part, position=position)


def pillar(x: float, y: float, width: float) -> Fixture:
    """A pillar from floor to ceiling."""
    return box_thing("pillar", (0.4, width, 2.8), (x, y, 1.35))


def person(name: str, *path: tuple[float, float], **settings: object) -> PersonConfig:
    return PersonConfig(name=name, path=tuple(Waypoint(at_m=at) for at in path), **settings)


def robot(
    x: float = 1.0,
    y: float = 0.0,
    heading_deg: float = 0.0,
    camera: Pinhole = SMALL,
    thermal: ThermalConfig | None = None,
) -> RobotConfig:
    return RobotConfig(
        at_m=(x, y),
        heading_rad=math.radians(heading_deg),
        sonar=EXACT_SONAR,
        cameras={
            "thermal": ThermalConfig(camera=camera) if thermal is None else thermal,
            "colour": ColourConfig(camera=camera),
        },
    )


def config(*people: PersonConfig, place: Place | None = None, **settings: object) -> WorldConfig:
    settings = {"robot": robot(), **settings}
    return WorldConfig(place=hall() if place is None else place, people=people, **settings)
