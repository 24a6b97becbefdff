"""What a surface carries beside its material: folds, a face, straps, on a grid wrapped round its part."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

Grid = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Finish:
    """Differences from a part's material by the direction from its z axis, and by height along it.

    Column c of C looks c / C of a turn from +x towards +y; the first column comes again after the last.

    Attributes:
        lowest_m: [m] z of the first row.
        texel_m: [m] from row to row; rows go up.
        kelvin: (R, C) [K] added to the temperature.
        light: (R, C) factor on what the surface reflects.
        cover: (R, C) share 0..1 that has the finish's colour instead of the material's.
        rgb: (3,) linear reflectance of that colour.
    """

    lowest_m: float
    texel_m: float
    kelvin: Grid
    light: Grid
    cover: Grid
    rgb: Grid = field(default_factory=lambda: np.zeros(3))

    def texels(self) -> NDArray[np.int16]:
        """(R C, 3) kelvin, light and cover in steps of 1 / 256, so that every machine has the same."""
        layers = np.stack([self.kelvin, self.light, self.cover], axis=-1).reshape(-1, 3)
        return np.clip(np.rint(layers / TEXEL_STEP), -32768, 32767).astype(np.int16)


TEXEL_STEP: Final = 1.0 / 256.0
