"""What lies behind the pixels of one image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NOBODY = -1
BLIND = "none"  # in place of a renderer's name: a world without images


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What lies behind each pixel's centre, from 0.05 m to 100 m.

    Attributes:
        part: (H, W) part number, -1 where nothing is.
        depth: (H, W) [m] along the optical axis, inf where nothing is.
        normal: (H, W, 3) unit normal that faces the camera, world frame; 0 where nothing is.
        cover: (H, W) bit k is set where person k's silhouette lies, whether it is hidden or not.
        surface: (H, W) number of the surface in the `ShapeTable`, of no meaning where nothing is; None if
            what drew the view does not tell.
    """

    part: NDArray[np.int32]
    depth: NDArray[np.float32]
    normal: NDArray[np.float32]
    cover: NDArray[np.uint64]
    surface: NDArray[np.int32] | None = None


def person_bits(person_of_part: NDArray[np.int64]) -> NDArray[np.uint64]:
    """(P,) the bit of the person that a part belongs to, 0 for none."""
    bits = np.uint64(1) << np.maximum(person_of_part, 0).astype(np.uint64)
    return np.where(person_of_part == NOBODY, np.uint64(0), bits)
