"""The small network that tells people from background by what a pixel and its neighbourhood look like."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.panoramic.foreground.layers import (
    BLOCK,
    DILATIONS,
    INPUTS_TOGETHER,
    UNITS_TOGETHER,
    look_round,
    look_within,
    tell,
)

Linear = NDArray[np.float32]

FEATURES: Final = 6
"""What it is told of each pixel: red, green, blue, unlikeness to the background, its age, its doubt."""
INPUTS: Final = BLOCK * BLOCK * FEATURES
OUTPUTS: Final = BLOCK * BLOCK
TOGETHER: Final = math.lcm(UNITS_TOGETHER, INPUTS_TOGETHER)
"""What the number of units is a multiple of."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MaskNetwork:
    """A trained network: it sees a panorama as R rows of squares, each with U units in every layer.

    Columns go on over the seam, so that an image rolled by whole squares gives the same answer, rolled.

    Attributes:
        first: (INPUTS, U) weights of a square's own pixels.
        rows: (R, U) bias of the first layer, by row of squares.
        between: (L, 9, U, U) weights of the layers between, by neighbour from the upper left one on.
        biases: (L, U) of those layers.
        last: (U + INPUTS, OUTPUTS) weights of the last layer, which sees the square's own pixels again.
        bias: (OUTPUTS,) of the last layer.
    """

    first: Linear
    rows: Linear
    between: Linear
    biases: Linear
    last: Linear
    bias: Linear

    def probability(self, squares: Linear) -> Linear:
        """Tell for each pixel (H, W) the probability that it is a person.

        Args:
            squares: (INPUTS, H / BLOCK, W / BLOCK) features of each square, as `compare` gives them.
        """
        units = look_within(squares, self.first, self.rows)
        for weights, bias, dilation in zip(self.between, self.biases, DILATIONS, strict=True):
            units = look_round(units, squares.shape[1], weights, bias, dilation)
        return tell(units, squares, self.last, self.bias)
