"""Views: parts, depths and normals behind the pixels of one image."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

NO_PERSON = -1
BLIND = "none"  # in place of a renderer's name: a world without images


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Surface behind each pixel's centre, from 0.05 m to 100 m.

    Attributes:
        part: (H, W) part number, -1 for none.
        depth: (H, W) [m] along the optical axis, inf for none.
        normal: (H, W, 3) unit normal that faces the camera, world frame; 0 for none.
        cover: (H, W) bit k is set inside person k's silhouette, whether occluded or not.
        surface: (H, W) number of the surface in the `ShapeTable`, undefined without a part; None if the
            renderer does not provide it.
    """

    part: NDArray[np.int32]
    depth: NDArray[np.float32]
    normal: NDArray[np.float32]
    cover: NDArray[np.uint64]
    surface: NDArray[np.int32] | None = None


def person_bits(person_of_part: NDArray[np.int64]) -> NDArray[np.uint64]:
    """Return (P,) the bit of the person to which a part belongs, 0 for none."""
    bits = np.uint64(1) << np.maximum(person_of_part, 0).astype(np.uint64)
    return np.where(person_of_part == NO_PERSON, np.uint64(0), bits)


# Occlusion counts of a view (a numba kernel).


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """Numbers of pixels that each person hides of each other person.

    Attributes:
        seen: (N, M) pixels of person n's silhouette inside the image at which owner m is seen.
        bounds: (N, 4) first and last column and row of each person's visible pixels; last < first for none.
    """

    seen: NDArray[np.int64]
    bounds: NDArray[np.int64]


def count_cover(
    part: NDArray[np.int32],
    cover: NDArray[np.uint64],
    owner_of_part: NDArray[np.int64],
    people: int,
    owners: int,
) -> Cover:
    """Count the visible owners on each person's silhouette.

    Args:
        part: (H, W) part seen.
        cover: (H, W) bit n where person n's silhouette lies, hidden or not.
        owner_of_part: (P,) owner of each part; person n is owner n.
        people: N.
        owners: M, persons first.
    """
    return Cover(*_count(part, cover, owner_of_part, people, owners))


@njit(cache=True)
def _count(
    part: NDArray[np.int32],
    cover: NDArray[np.uint64],
    owner_of_part: NDArray[np.int64],
    people: int,
    owners: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    height, width = part.shape
    seen = np.zeros((people, owners), np.int64)
    bounds = np.empty((people, 4), np.int64)
    bounds[:, 0], bounds[:, 1], bounds[:, 2], bounds[:, 3] = width, -1, height, -1
    for v in range(height):
        for u in range(width):
            bits = cover[v, u]
            if bits == 0:
                continue
            owner = owner_of_part[part[v, u]]
            for person in range(people):
                if (bits >> np.uint64(person)) & np.uint64(1):
                    seen[person, owner] += 1
            if owner < people:
                bounds[owner, 0], bounds[owner, 1] = min(bounds[owner, 0], u), max(bounds[owner, 1], u)
                bounds[owner, 2], bounds[owner, 3] = min(bounds[owner, 2], v), max(bounds[owner, 3], v)
    return seen, bounds
