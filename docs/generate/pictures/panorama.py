"""Pictures of a panoramic camera: the circular image, the panorama, and distance errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from peopleboy.scenarios.drawing.overlay import draw_truth, enlarge, people_parts
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.sim.cameras.camera_config import PanoramaConfig, ThermalConfig
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.studies.reproductions.pictures.panoramic_figures import draw_ranges
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.runner import RESULTS
from peopleboy.studies.reproductions.units import Measurement, Unfinished, open_store, run_units

PEOPLE = {"anna": (6.5, -1.2), "carl": (1.6, 0.1), "dora": (4.2, 1.9)}
SCALE = 1.5


def raw_and_unrolled() -> Image.Image:
    """Draw the circular image above the panorama with ground truth."""
    people = tuple(PersonConfig(name=name, path=(Waypoint(at_m=at),)) for name, at in PEOPLE.items())
    cameras = {"thermal": ThermalConfig(), "panorama": PanoramaConfig(raw=True)}
    robot = RobotConfig(at_m=(4.0, 0.0), cameras=cameras)
    place = build_place(straight_corridor(10.0, 8.0))
    with SimulatedWorld(WorldConfig(place=place, people=people, robot=robot)) as world:
        images, truth = dict(world.observe().images), world.truth("panorama")
    panorama = draw_truth(enlarge(images["panorama"], SCALE), people_parts(truth.people, truth.camera), SCALE)
    raw = enlarge(images["panorama_raw"], SCALE)
    page = np.full((raw.shape[0] + 8 + panorama.shape[0], panorama.shape[1], 3), 255, np.uint8)
    left = (page.shape[1] - raw.shape[1]) // 2
    page[: raw.shape[0], left : left + raw.shape[1]] = raw
    page[-panorama.shape[0] :] = panorama
    return Image.fromarray(page).quantize(128)  # reduced palette, since noise makes the file large


def errors_over_distance() -> Figure:
    """Draw the errors of the paper's network in every room, from the sequences of `peopleboy reproduce`."""
    plan, folder = Plan(cache=Path("runs/films")), Path("runs/reproduce")
    store = open_store(folder / RESULTS)
    try:
        return draw_ranges(Measurement(plan, store))
    except Unfinished as walks:
        run_units(walks.units, store, Workers())
    return draw_ranges(Measurement(plan, store))
