"""What people look like, in colour and in their thermal pattern, and how likely somebody is who."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.alignment import alignment
from peopleboy.tracker.thermal.appearance.colour_view import ColourView, PowerSums
from peopleboy.tracker.thermal.appearance.regions import PARTS, part_rectangles
from peopleboy.tracker.thermal.colour_config import SAME_VIEW, ColourConfig
from peopleboy.tracker.thermal.config import AppearanceConfig
from peopleboy.tracker.thermal.particles import Floats
from peopleboy.tracker.thermal.whereabouts import Regions

# By how much the mean colours, 0..1, of one person's head, torso and legs differ from frame to frame after
# the light has been divided out.
COLOUR_SPREAD = (0.06, 0.02, 0.035)
BRIGHTNESS = 80.0  # mean of the colour image [grey] to which all are scaled
DARKEST = 12.0  # mean below which colours are noise
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
        picture = image[..., None]
        same = alignment(image.shape, image.shape, SAME_VIEW, 0.0)
        thermal = ColourView(picture, PowerSums.build(picture, 1), same)
        return cls(colour if light > DARKEST else None, thermal, _scale(light, config))

    def describe(self, state: Floats) -> Floats:
        """Describe people (N, 9) by the colours and the grey of each part, (N, 12); NaN outside."""
        each = np.full((len(state), PARTS, 4), np.nan, dtype=np.float32)
        if self.colour is not None:
            moments = self.colour.describe(state).reshape(len(state), PARTS, 3, -1)
            each[:, :, :3] = moments[..., 0]
        each[:, :, 3] = self.thermal.describe(state)
        return (each * self.scale).reshape(len(state), -1)


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
    scale[:, :3] = BRIGHTNESS / max(light, 1.0) / np.array(COLOUR_SPREAD)[:, None]
    scale[:, 3] = 1 / np.array(config.grey_spread)
    return scale


@dataclass(frozen=True, slots=True, eq=False)
class ColourModel:
    """The mean of a person's last descriptions.

    Attributes:
        recent: (K, F) float32 up to n_k descriptions, the newest last; NaN where a part was never seen.
            Becomes read-only.
        frames: n_k.

    Source: thesis, section 6.1.3; its sum in equation 6.2 has one term too many for its n_k.
    """

    recent: Floats
    frames: int

    def __post_init__(self) -> None:
        self.recent.setflags(write=False)

    @classmethod
    def begin(cls, features: Floats, config: ColourConfig) -> ColourModel:
        """Start with one description (F,)."""
        return cls(np.array(features, dtype=np.float32)[None], config.frames)

    @property
    def mean(self) -> Floats:
        """Return c* of equation 6.2, (F,); NaN for parts that were never seen."""
        # Later descriptions hold no NaN where an earlier one had a value, so the newest tells what is known.
        is_known = ~np.isnan(self.recent)
        total = np.where(is_known, self.recent, np.float32(0)).sum(axis=0)
        known = is_known.sum(axis=0).astype(np.float32)
        mean: Floats = np.where(known > 0, total / np.maximum(known, np.float32(1)), np.float32(np.nan))
        return mean

    def updated(self, features: Floats) -> ColourModel:
        """Take in the description (F,) of one more frame.

        What is unseen in it keeps its present mean; where nothing is seen, the model stays as it is.
        """
        if np.isnan(features).all():
            return self
        newest = np.where(np.isnan(features), self.mean, features).astype(np.float32)
        return ColourModel(np.concatenate([self.recent, newest[None]])[-self.frames :], self.frames)


def squared_distances(features: Floats, model: ColourModel) -> Floats:
    """Compare descriptions (N, F) with a model: squared Euclidean distance (N,).

    Unseen features are taken to differ as the seen ones do on average, so that it does not pay to be unseen;
    NaN where no feature can be compared.

    Source: thesis, equation 6.3.
    """
    distances: Floats = _squared_distances(features, model.mean)
    return distances


def likelihood(features: Floats, model: ColourModel, config: ColourConfig) -> Floats:
    """Tell how likely people (N,) with these features (N, F) are the person of the model.

    Whoever cannot be compared at all is as likely as the others are on average, or 1 where nobody can.

    Source: thesis, equation 6.4.
    """
    chance: Floats = np.exp(np.float32(-config.sharpness) * squared_distances(features, model))
    is_unseen = np.isnan(chance)
    if is_unseen.any():
        chance[is_unseen] = 1.0 if is_unseen.all() else chance[~is_unseen].mean()
    return chance


@njit(cache=True, nogil=True)
def _squared_distances(features: Floats, mean: Floats) -> Floats:
    result = np.empty(len(features), dtype=np.float32)
    for i in range(len(features)):
        total, seen = 0.0, 0
        for j in range(len(mean)):
            away = features[i, j] - mean[j]
            if not np.isnan(away):
                total += away * away
                seen += 1
        result[i] = total * len(mean) / seen if seen > 0 else np.nan
    return result
