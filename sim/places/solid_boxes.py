"""Upright boxes, turned about the vertical: which of them overlap, and how far off points are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.places.extent import shape_extents
from peopleboy.sim.places.moving import Stance
from peopleboy.sim.places.place import Fixture

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class BoxSet:
    """N upright boxes.

    Attributes:
        centre: (N, 3) [m] world frame.
        half: (N, 3) [m] half of their sides, along their own axes.
        heading: (N,) [rad] where their own x axis points.
    """

    centre: Array
    half: Array
    heading: Array

    def moved(self, stance: Stance) -> BoxSet:
        """Boxes given in a thing's frame, where they are when the thing is there."""
        return BoxSet(stance.place(self.centre), self.half, self.heading + stance.heading_rad)

    def between(self, low_m: float, high_m: float) -> BoxSet:
        """Those that reach into a span of heights."""
        bottom, top = self.centre[:, 2] - self.half[:, 2], self.centre[:, 2] + self.half[:, 2]
        kept = (bottom < high_m) & (top > low_m)
        return BoxSet(self.centre[kept], self.half[kept], self.heading[kept])

    def distance(self, point: tuple[float, float]) -> float:
        """How far a point on the floor [m] is from the nearest box; 0 inside, infinite without any."""
        if not len(self.centre):
            return np.inf
        gap = np.abs(_own(np.array(point) - self.centre[:, :2], self.heading)) - self.half[:, :2]
        return float(np.hypot(*np.maximum(gap, 0.0).T).min())


def boxes_of(fixtures: Sequence[Fixture], origin: Stance | None = None) -> BoxSet:
    """The boxes round all solid shapes of some fixtures, in the world or in the frame of a thing.

    Args:
        fixtures: turned about the vertical at most.
        origin: where the frame is that all of them share; None for boxes in the world.
    """
    found = [
        (extent.mean(axis=0), (extent[1] - extent[0]) / 2.0, _stance_of(fixture))
        for fixture in fixtures
        if fixture.is_solid
        for extent in shape_extents(fixture)
    ]
    centre = np.array([box[0] if origin else box[2].place(box[0]) for box in found]).reshape(-1, 3)
    heading = np.array([0.0 if origin else box[2].heading_rad for box in found])
    return BoxSet(centre, np.array([box[1] for box in found]).reshape(-1, 3), heading)


def overlaps(a: BoxSet, b: BoxSet, by_m: float) -> NDArray[np.bool_]:
    """(N, M) whether each box of one reaches farther into each of the other than by_m [m].

    Two boxes are apart where an axis of either keeps them apart (separating axis theorem).
    """
    gap = b.centre[None] - a.centre[:, None]
    deep = a.half[:, None, 2] + b.half[None, :, 2] - np.abs(gap[..., 2]) > by_m
    for boxes, shape in ((a, (-1, 1)), (b, (1, -1))):
        for turn in (0.0, np.pi / 2.0):
            angle = boxes.heading.reshape(shape) + turn
            apart = np.abs(gap[..., 0] * np.cos(angle) + gap[..., 1] * np.sin(angle))
            deep &= _reach(a, angle, (-1, 1)) + _reach(b, angle, (1, -1)) - apart > by_m
    return deep


def _reach(boxes: BoxSet, angle: Array, shape: tuple[int, int]) -> Array:
    """How far boxes reach from their middle in a direction."""
    own = angle - boxes.heading.reshape(shape)
    x, y = boxes.half[:, 0].reshape(shape), boxes.half[:, 1].reshape(shape)
    return np.asarray(x * np.abs(np.cos(own)) + y * np.abs(np.sin(own)))


def _own(offset: Array, heading: Array) -> Array:
    """(N, 2) offsets of the world in frames of these headings (N,)."""
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]], axis=1)


def _stance_of(fixture: Fixture) -> Stance:
    _, _, z, w = fixture.orientation
    return Stance(fixture.position, 2.0 * float(np.arctan2(z, w)))
