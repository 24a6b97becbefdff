"""A body on two driven wheels, read from its URDF: outline, wheels, and how it resists being turned."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.physics.urdf_links import UrdfLink
from peopleboy.sim.shapes.shapes import UPRIGHT, ShapeKind

Array = NDArray[np.float64]


class Vehicle(NamedTuple):
    """What kernels must know of it; the frame is that of its root link, midway between the wheels.

    Attributes:
        middles, halves: (K, 2) [m] of the upright boxes that bump into things.
        heights: (K, 2) [m] lower and upper end of each.
        reach_m: [m] of the circle about the origin that holds them all.
        centre: (2,) [m] of mass.
        gyration_m2: [m2] inertia about the vertical through it, over the mass.
        wheel_radius_m, wheel_distance_m: [m].
    """

    middles: Array
    halves: Array
    heights: Array
    reach_m: float
    centre: Array
    gyration_m2: float
    wheel_radius_m: float
    wheel_distance_m: float


def wheels_of(name: str, links: Sequence[UrdfLink]) -> tuple[int, int]:
    """Numbers of the links that are its left and its right wheel.

    Raises:
        BadInput: it has not exactly two wheels, each a solid cylinder, on either side of its root.
    """
    turning = [number for number, link in enumerate(links) if link.turns]
    turning.sort(key=lambda number: -float(links[number].base_from_link[1, 3]))
    if len(turning) == 2 and all(_is_round(links[number]) for number in turning):
        left, right = turning
        if links[left].base_from_link[1, 3] > 0.0 > links[right].base_from_link[1, 3]:
            return left, right
    raise BadInput(
        f"body {name!r}: kinematic physics moves what rolls on two wheels, cylinders on continuous joints to "
        "the left and to the right of the root link; hold it in place, or choose bullet"
    )


def make_vehicle(name: str, links: Sequence[UrdfLink]) -> Vehicle:
    """Read a vehicle off its links.

    Raises:
        BadInput: it does not roll on two wheels, or its root is not of upright boxes.
    """
    left, right = (links[number] for number in wheels_of(name, links))
    boxes = links[0].solid
    if not boxes or any(box.kind != ShapeKind.BOX or box.orientation != UPRIGHT for box in boxes):
        raise BadInput(f"body {name!r}: kinematic physics bumps with upright boxes; give its root some")
    middles = np.array([box.position[:2] for box in boxes])
    halves = np.array([box.size[:2] for box in boxes]) / 2.0
    rise = np.array([(box.position[2], box.size[2] / 2.0) for box in boxes])
    masses = np.array([link.mass_kg for link in links])
    centres = np.array([link.base_from_link[:3, :3] @ link.centre_m for link in links])[:, :2]
    centres += [link.base_from_link[:2, 3] for link in links]
    centre = masses @ centres / masses.sum()
    own = sum(link.inertia_kg_m2 for link in links)
    return Vehicle(
        middles=middles,
        halves=halves,
        heights=np.stack([rise[:, 0] - rise[:, 1], rise[:, 0] + rise[:, 1]], axis=1),
        reach_m=float(np.linalg.norm(np.abs(middles) + halves, axis=1).max()),
        centre=centre,
        gyration_m2=float((own + masses @ np.square(centres - centre).sum(axis=1)) / masses.sum()),
        wheel_radius_m=left.solid[0].size[1],
        wheel_distance_m=float(left.base_from_link[1, 3] - right.base_from_link[1, 3]),
    )


def _is_round(link: UrdfLink) -> bool:
    return len(link.solid) == 1 and link.solid[0].kind == ShapeKind.CYLINDER
