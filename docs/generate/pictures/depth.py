"""What a depth camera sees: depth without noise, with the usual noise, and with three times that."""

from __future__ import annotations

from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.sim.cameras.camera_config import DepthConfig, ThermalConfig
from peopleboy.sim.cameras.depth_image import show_depth
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.people.walking.walk import Waypoint
from peopleboy.sim.places.rooms import build_place, straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import World

PEOPLE = {"anna": (3.9, -0.8), "carl": (5.6, 0.6), "dora": (8.2, -0.35)}
ROWS = slice(120, 400)
SCALES = {"plain": 0.0, "depth": 1.0, "rough": 3.0}


def scales() -> Figure:
    """Three people in a corridor whose end is beyond the range."""
    people = tuple(PersonConfig(name=name, path=(Waypoint(at_m=at),)) for name, at in PEOPLE.items())
    depth = {name: DepthConfig(scale=scale) for name, scale in SCALES.items()}
    robot = RobotConfig(at_m=(0.5, 0.0), cameras={"thermal": ThermalConfig(), **depth})
    with World(
        WorldConfig(place=build_place(straight_corridor(14.0, 4.0)), people=people, robot=robot)
    ) as world:
        images = dict(world.observe().images)
    figure, axes = panels([f"scale {scale:g}" for scale in SCALES.values()], 2.0)
    for panel, name in zip(axes, SCALES, strict=True):
        show(panel, show_depth(images[name][ROWS]))
    return figure
