"""What a surface has beyond its material: fine differences of temperature and brightness, on a grid."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Unrolling(IntEnum):
    """How a painting lies on its part: which sums of the part's coordinates are its own."""

    LEVEL = 0  # across is x, up is y: floors and ceilings
    UPRIGHT = 1  # across is x + y, up is z: walls, and whatever stands on the floor
    ASLANT = 2  # across is x + y, up is z + (x - y) / 2: what is round, which has no side without a pattern


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Painting:
    """Differences from a part's material over its surface, in the frame of the part.

    Attributes:
        unrolling: how it lies on the part.
        origin_m: [m] where the middle of the first texel is, across and up.
        texel_m: [m] from texel to texel.
        kelvin: (H, W) [K] added to the temperature; rows go up, columns across.
        light: (H, W) factor on what the surface reflects and glows.
    """

    unrolling: Unrolling
    origin_m: tuple[float, float]
    texel_m: float
    kelvin: NDArray[np.float32]
    light: NDArray[np.float32]
