"""A thing that is moved: colour, depth, whose pixels are whose, and the depth behind it all."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.drawing.palette import person_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.studies.blind_drive import blind_drive
from peopleboy.sim.cameras.depth_image import show_depth
from peopleboy.sim.truth.truth import Truth

SCENARIO, AT_S = "bears_4", 13.4
TITLES = ("colours beside the depth", "depth", "whose pixels: people and things", "nobody, nothing movable")


def moved() -> Figure:
    """A man carries a bear."""
    for world, observation in blind_drive(load_scenario(SCENARIO), 0):
        if observation.time_s >= AT_S:
            truth = world.truth("depth")
            colour, depth = (observation.images[name] for name in ("depth_colour", "depth"))
            break
    behind = np.rint(1000.0 * truth.background_m()).astype(np.uint16)
    figure, axes = panels(list(TITLES), 1.9)
    for panel, image in zip(
        axes, (colour, show_depth(depth), _owners(truth), show_depth(behind)), strict=True
    ):
        show(panel, image)
    return figure


def _owners(truth: Truth) -> np.ndarray:
    """Grey, but for people and things that are moved, each in a colour."""
    image = np.full((*truth.depth_m.shape, 3), 225, np.uint8)
    names = [*(person.name for person in truth.people), *(thing.name for thing in truth.things)]
    for number, name in enumerate(names, start=1):
        image[truth.owners.mask(name)] = person_colour(number)
    return image
