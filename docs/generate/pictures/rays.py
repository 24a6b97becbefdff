"""Pictures of the ray caster's output per pixel."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from docs.generate.pictures.moments import world_at
from docs.generate.pictures.paper import panels, show, zoom
from peopleboy.scenarios.drawing.palette import person_colour

SCENE = ("crossing_4", 0, 3.2)


def layers() -> Figure:
    """Draw depth, part numbers and normals of a frame next to the images formed from them."""
    titles = ("depth", "part", "normal", "thermal image", "colour image", "people and body parts")
    figure, axes = panels(titles, 5.6, columns=3)
    with world_at(*SCENE) as world:
        view = world._see(world.config.robot.cameras["thermal"]).view
        images, truth = dict(world.observe().images), world.truth()
    show(axes[0], np.minimum(view.depth, 12.0), cmap="viridis_r")
    show(axes[1], _shuffled(view.part))
    show(axes[2], (view.normal + 1.0) / 2.0)
    show(axes[3], images["thermal"])
    show(axes[4], images["colour"])
    show(axes[5], _parts(truth.instance, truth.body_part))
    return figure


def silhouettes() -> Figure:
    """Draw the whole silhouette of each person, and its visible part."""
    with world_at(*SCENE) as world:
        view = world._see(world.config.robot.cameras["thermal"]).view
        truth = world.truth()
    rows, columns = np.nonzero(view.cover)
    everybody = (float(columns.min()), float(rows.min()), float(np.ptp(columns)), float(np.ptp(rows)))
    people = sorted(truth.people, key=lambda person: person.distance_m)
    titles = [f"{one.name}: {one.visible_fraction:.0%} visible" for one in people]
    figure, axes = panels(titles, 2.75)
    for panel, person in zip(axes, people, strict=True):
        whole = ((view.cover >> np.uint64(person.id - 1)) & np.uint64(1)).astype(bool)
        picture = np.full((*whole.shape, 3), 30, np.uint8)
        picture[whole] = (150, 60, 60)
        picture[truth.instance == person.id] = person_colour(person.id)
        show(panel, picture)
        zoom(panel, everybody, 10.0, 1.25)
        hidden = ", ".join(f"{name} {share:.0%}" for name, share in person.hidden_by.items() if share > 0.005)
        panel.text(
            0.5, -0.02, hidden and f"hidden by {hidden}", ha="center", va="top", transform=panel.transAxes
        )
    return figure


def _shuffled(part: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Return a separate colour for every part number."""
    colours = np.random.default_rng(4).integers(40, 255, (part.max() + 2, 3), dtype=np.uint8)
    colours[0] = 0
    return np.asarray(colours[part + 1])


def _parts(instance: NDArray[np.uint8], body_part: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Colour people, and vary the brightness by body part."""
    picture = np.full((*instance.shape, 3), 30, np.uint8)
    for person in np.unique(instance[instance > 0]):
        mask = instance == person
        shade = 0.55 + 0.45 * (body_part[mask] % 5) / 4.0
        picture[mask] = (shade[:, None] * np.array(person_colour(int(person)))).astype(np.uint8)
    return picture
