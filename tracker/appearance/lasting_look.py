"""What of a person's look lasts: colours with the light divided out, and the warmth of clothes and skin.

The thesis compares colours as the camera gives them, which change when a lamp goes off or a person walks
into the shade, and are none in the dark. This description is for telling people apart over a longer time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bad_input import BadInput
from tracker.appearance.colour_view import ColourView
from tracker.appearance.moments import WHITE, normalised_moments
from tracker.appearance.power_sums import PowerSums
from tracker.appearance.regions import PARTS, part_rectangles, pixel_bounds
from tracker.particles import Floats

FEATURES = 12
"""Per part: red against green, blue against green, brightness; then the warmth of each part."""

# How much each feature of one person varies from one second to another, measured on simulated people who
# turn about, walk 3 to 10 m away and pass under changing light: head, torso, legs.
_USUAL_SPREAD = np.array(
    [[0.06, 0.10, 0.16], [0.05, 0.06, 0.08], [0.10, 0.11, 0.11], [0.15, 0.03, 0.06]], dtype=np.float32
).ravel()

# Added to a level before its logarithm: black clothes and the noise of dark pixels must not make it run away.
_FLOOR = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class LookView:
    """A pair of images, ready to be asked for the lasting look of people in it; build it once a frame.

    Attributes:
        colour: the colour image; None without one, or when it is too dark to tell colours.
        level: mean of the colour image, 0..1.
        warmth: integral image of the thermal one.
        least_seen: share of a part that must lie in the thermal image.
    """

    colour: ColourView | None
    level: float
    warmth: PowerSums
    least_seen: float = 0.5

    @classmethod
    def build(cls, thermal: NDArray[np.uint8], colour: ColourView | None, darkest: float = 0.08) -> LookView:
        """Prepare a thermal image (H, W) and the view of the colour image that was taken with it.

        Args:
            thermal: grey, (H, W) uint8.
            colour: by moments in RGB, or None.
            darkest: mean of the colour image, 0..1, below which colours count as unseen.

        Raises:
            BadInput: a colour view of another kind.
        """
        warmth = PowerSums.build(thermal[..., None], 1)
        if colour is None:
            return cls(None, 0.0, warmth)
        if colour.sums is None or colour.config.space != "rgb":
            config = colour.config
            raise BadInput(
                f"a lasting look needs moments in rgb, got {config.representation} in {config.space}"
            )
        level = float(colour.sums.integral[-1, -1, :, 0].mean()) / (WHITE * colour.pixels)
        return cls(colour if level >= darkest else None, level, warmth)

    def describe(self, state: Floats) -> Floats:
        """Describe people (N, 9) by what lasts, (N, 12); every feature in units of its usual spread.

        The expected squared distance between two descriptions of one person is thus about 24, and about half
        of that from the mean of many. Features of unseen parts are NaN, as those of all colours are in the
        dark.
        """
        look: Floats = np.concatenate([self._colours(state), self._warmth(state)], axis=1)
        look /= _USUAL_SPREAD
        return look

    def _colours(self, state: Floats) -> Floats:
        """Give log ratios (N, 9): per part red to green, blue to green, and all three to the whole image.

        A factor on the light cancels out of all of them; sRGB's gamma turns it into another factor.
        """
        if self.colour is None:
            return np.full((len(state), 3 * PARTS), np.nan, dtype=np.float32)
        mean = self.colour.describe(state).reshape(len(state), PARTS, 3, -1)[..., 0]
        red, green, blue = np.moveaxis(np.log(mean + np.float32(_FLOOR)), 2, 0)
        brightness = (red + green + blue) / 3 - np.float32(np.log(self.level + _FLOOR))
        return np.stack([red - green, blue - green, brightness], axis=2).reshape(len(state), -1)

    def _warmth(self, state: Floats) -> Floats:
        """Give the mean grey (N, 3) of each part in the thermal image, 0..1."""
        sums = self.warmth.over(pixel_bounds(part_rectangles(state)).reshape(-1, 4))
        return normalised_moments(sums, self.least_seen).reshape(len(state), PARTS)
