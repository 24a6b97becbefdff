"""What people look like: their colours, and their thermal pattern, in numbers that can be compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.alignment import Alignment
from peopleboy.tracker.thermal.appearance.colour_view import ColourView
from peopleboy.tracker.thermal.appearance.power_sums import PowerSums
from peopleboy.tracker.thermal.appearance.regions import PARTS, part_rectangles
from peopleboy.tracker.thermal.colour_config import SAME_VIEW, ColourConfig
from peopleboy.tracker.thermal.config import AppearanceConfig
from peopleboy.tracker.thermal.filter.particles import Floats
from peopleboy.tracker.thermal.interaction import Regions

HIDDEN_PART = 0.3  # share of a part behind others from which its colour is not this person's


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceView:
    """One frame as far as people's looks are concerned.

    Attributes:
        colour: the colour image; None without one, or in the dark.
        thermal: the thermal image, to be described in the same way.
        scale: (3, 4) by which the means of red, green, blue and thermal grey of head, torso and legs are
            multiplied, so that one person's differ by about 1 from frame to frame.
    """

    colour: ColourView | None
    thermal: ColourView
    scale: Floats

    @classmethod
    def build(
        cls, image: NDArray[np.uint8], colour: ColourView | None, config: AppearanceConfig
    ) -> AppearanceView:
        """Prepare a thermal image (H, W), and the colour image if there is one."""
        light = 0.0 if colour is None else float(colour.picture[::8, ::8].mean())
        alignment = Alignment.build(image.shape, image.shape, ColourConfig(affine=SAME_VIEW))
        picture = image[..., None]
        thermal = ColourView(picture, PowerSums.build(picture, 1), alignment, ColourConfig())
        return cls(colour if light > config.darkest else None, thermal, _scale(light, config))

    def describe(self, state: Floats) -> Floats:
        """Describe people (N, 9) by the colours and the grey of each part, (N, 12); NaN outside."""
        each = np.full((len(state), PARTS, 4), np.nan, dtype=np.float32)
        if self.colour is not None:
            moments = self.colour.describe(state).reshape(len(state), PARTS, 3, -1)
            each[:, :, :3] = moments[..., 0]
        each[:, :, 3] = self.thermal.describe(state)
        return (each * self.scale).reshape(len(state), -1)


def knows_colour(features: Floats) -> bool:
    """Tell whether any colour is among the looks (F,) of a person."""
    return not bool(np.isnan(features.reshape(PARTS, 4)[:, :3]).all())


def visible(features: Floats, state: Floats, hiding: Regions) -> Floats:
    """Blank out, in place, the features (N, F) of parts that lie behind people with regions (M, 4)."""
    if len(hiding):
        features.reshape(len(state), PARTS, -1)[are_hidden(state, hiding)] = np.nan
    return features


def are_hidden(state: Floats, hiding: Regions) -> NDArray[np.bool_]:
    """Tell which parts (N, 3) of people lie behind regions (M, 4) of others."""
    parts = part_rectangles(state)
    left, top, right, bottom = (parts[:, :, k, None] for k in range(4))
    across = np.minimum(right, hiding[:, 0] + hiding[:, 2]) - np.maximum(left, hiding[:, 0])
    down = np.minimum(bottom, hiding[:, 1] + hiding[:, 3]) - np.maximum(top, hiding[:, 1])
    shared = np.maximum(across, 0) * np.maximum(down, 0)
    area = np.maximum((right - left) * (bottom - top), 1e-6)
    hidden: NDArray[np.bool_] = (shared > HIDDEN_PART * area).any(axis=2)
    return hidden


def _scale(light: float, config: AppearanceConfig) -> Floats:
    """Divide by what one person's looks differ from frame to frame, and colours by the light."""
    scale = np.empty((PARTS, 4), dtype=np.float32)
    scale[:, :3] = config.brightness / max(light, 1.0) / np.array(config.colour_spread)[:, None]
    scale[:, 3] = 1 / np.array(config.grey_spread)
    return scale
