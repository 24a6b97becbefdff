"""Pictures of a depth camera: depth with different noise, and the truth behind moved objects."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.drawing.palette import person_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import DepthConfig, ThermalConfig
from peopleboy.sim.cameras.depth import show_depth
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig

PEOPLE = {"anna": (3.9, -0.8), "carl": (5.6, 0.6), "dora": (8.2, -0.35)}
ROWS = slice(120, 400)
SCALES = {"plain": 0.0, "depth": 1.0, "rough": 3.0}
MOVED, MOVED_AT_S = "bears_4", 13.4
MOVED_TITLES = (
    "registered colour",
    "depth",
    "people and objects",
    "background",
)


def scales() -> Figure:
    """Draw three people in a corridor whose end is out of range."""
    people = tuple(PersonConfig(name=name, path=(Waypoint(at_m=at),)) for name, at in PEOPLE.items())
    depth = {name: DepthConfig(scale=scale) for name, scale in SCALES.items()}
    robot = RobotConfig(at_m=(0.5, 0.0), cameras={"thermal": ThermalConfig(), **depth})
    with SimulatedWorld(
        WorldConfig(place=build_place(straight_corridor(14.0, 4.0)), people=people, robot=robot)
    ) as world:
        images = dict(world.observe().images)
    figure, axes = panels([f"scale {scale:g}" for scale in SCALES.values()], 2.0)
    for panel, name in zip(axes, SCALES, strict=True):
        show(panel, show_depth(images[name][ROWS]))
    return figure


def moved() -> Figure:
    """Draw a man who carries a teddy bear."""
    for world, observation in blind_drive(load_scenario(MOVED), 0):
        if observation.time_s >= MOVED_AT_S:
            truth = world.truth("depth")
            colour, depth = (observation.images[name] for name in ("depth_colour", "depth"))
            break
    behind = np.rint(1000.0 * truth.background_m()).astype(np.uint16)
    figure, axes = panels(list(MOVED_TITLES), 1.9)
    for panel, image in zip(
        axes, (colour, show_depth(depth), _owners(truth), show_depth(behind)), strict=True
    ):
        show(panel, image)
    return figure


def _owners(truth: Truth) -> np.ndarray:
    """Return the grey image with people and moved objects in separate colours."""
    image = np.full((*truth.depth_m.shape, 3), 225, np.uint8)
    names = [*(person.name for person in truth.people), *(thing.name for thing in truth.things)]
    for number, name in enumerate(names, start=1):
        image[truth.owners.mask(name)] = person_colour(number)
    return image
