"""Appearance model: colours and thermal pattern, and their likelihood."""

import math
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import exponential
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView, PowerSums
from peopleboy.tracker.reproductions.contour.appearance.regions import PARTS, alignment, part_rectangle
from peopleboy.tracker.reproductions.contour.box_interaction import Regions
from peopleboy.tracker.reproductions.contour.colour_config import SAME_VIEW, ColourDescriptorConfig
from peopleboy.tracker.reproductions.contour.contour_config import AppearanceConfig
from peopleboy.tracker.reproductions.contour.particles import D, Floats, H, W, X, Y

# Standard deviation between frames of the mean colours, 0..1, of one person's head, torso and legs after
# normalisation of the light.
COLOUR_SPREAD = (0.06, 0.02, 0.035)
BRIGHTNESS = 80.0  # mean of the colour image [grey] to which all are scaled
DARKEST = 12.0  # mean below which colours are noise
HIDDEN_PART = 0.3  # covered share of a part from which its colour is ignored


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceView:
    """One frame for appearance comparison.

    Attributes:
        colour: the colour image; None without one, or in the dark.
        thermal: the thermal image, described in the same way.
        scale: (3, 4) factors on the means of red, green, blue and thermal grey of head, torso and legs, so
            that one person's differ by about 1 from frame to frame.
    """

    colour: ColourView | None
    thermal: ColourView
    scale: Floats

    @classmethod
    def build(
        cls, image: NDArray[np.uint8], colour: ColourView | None, config: AppearanceConfig
    ) -> "AppearanceView":
        """Prepare a thermal image (H, W), and the colour image if there is one."""
        light = 0.0 if colour is None else float(colour.picture[::8, ::8].mean())
        picture = image[..., None]
        same = alignment(image.shape, image.shape, SAME_VIEW, 0.0)
        thermal = ColourView(picture, PowerSums.build(picture, 1), same)
        return cls(colour if light > DARKEST else None, thermal, _scale(light, config))

    def describe(self, state: Floats) -> Floats:
        """Describe people (N, 9) by the colours and the grey of each part, (N, 12); NaN outside."""
        means = np.full((len(state), PARTS, 4), np.nan, dtype=np.float32)
        if self.colour is not None:
            means[..., :3] = self.colour.means(state)
        means[..., 3:] = self.thermal.means(state)
        means *= self.scale
        return means.reshape(len(state), -1)


def visible(features: Floats, state: Floats, hiding: Regions) -> Floats:
    """Set to NaN, in place, the features (N, F) of parts behind people with regions (M, 4)."""
    if len(hiding):
        _blank_hidden(features.reshape(len(state), PARTS, -1), state, hiding)
    return features


@njit(cache=True, nogil=True)
def _blank_hidden(features: Floats, state: Floats, hiding: Regions) -> None:
    least, share = np.float32(1e-6), np.float32(HIDDEN_PART)
    for i in range(len(state)):
        x, y, w, h, d = state[i, X], state[i, Y], state[i, W], state[i, H], state[i, D]
        for part in range(PARTS):
            left, top, right, bottom = part_rectangle(x, y, w, h, d, part)
            hidden = share * max((right - left) * (bottom - top), least)
            for j in range(len(hiding)):
                across = min(right, hiding[j, 0] + hiding[j, 2]) - max(left, hiding[j, 0])
                down = min(bottom, hiding[j, 1] + hiding[j, 3]) - max(top, hiding[j, 1])
                if across > 0 and down > 0 and across * down > hidden:
                    features[i, part] = np.nan


def _scale(light: float, config: AppearanceConfig) -> Floats:
    """Normalise by the variation between frames of one person's appearance, and colours by the light."""
    scale = np.empty((PARTS, 4), dtype=np.float32)
    scale[:, :3] = BRIGHTNESS / max(light, 1.0) / np.array(COLOUR_SPREAD)[:, None]
    scale[:, 3] = 1 / np.array(config.grey_spread)
    return scale


@dataclass(frozen=True, slots=True, eq=False)
class ColourModel:
    """The mean of a person's last descriptions.

    Attributes:
        recent: (K, F) float32 up to n_k descriptions, the newest last; NaN where a part was never visible.
            Becomes read-only.
        frames: n_k.
        mean: (F,) c* of equation 6.2; NaN for parts that were never visible.

    Source: thesis, section 6.1.3; its sum in equation 6.2 has one term too many for its n_k.
    """

    recent: Floats
    frames: int
    mean: Floats = field(init=False)

    def __post_init__(self) -> None:
        # Later descriptions have no NaN where an earlier one had a value, so the newest is complete.
        object.__setattr__(self, "mean", _mean_of_known(self.recent))
        self.recent.setflags(write=False)

    @classmethod
    def begin(cls, features: Floats, config: ColourDescriptorConfig) -> "ColourModel":
        """Start with one description (F,)."""
        return cls(np.array(features, dtype=np.float32)[None], config.frames)

    def updated(self, features: Floats) -> "ColourModel":
        """Update with the description (F,) of one more frame.

        Invisible parts keep their mean; if nothing is visible, the model does not change.
        """
        is_unseen = np.isnan(features)
        if is_unseen.all():
            return self
        newest = np.where(is_unseen, self.mean, features) if is_unseen.any() else features
        kept = self.recent[max(len(self.recent) + 1 - self.frames, 0) :]
        return ColourModel(np.concatenate([kept, newest[None]], dtype=np.float32), self.frames)


def squared_distances(features: Floats, model: ColourModel) -> Floats:
    """Compare descriptions (N, F) with a model: squared Euclidean distance (N,).

    Invisible features are assumed to differ as the visible ones do on average, so that invisibility is no
    advantage; NaN where no feature can be compared.

    Source: thesis, equation 6.3.
    """
    distances: Floats = _squared_distances(features, model.mean)
    return distances


def likelihood(
    features: Floats, model: ColourModel, config: ColourDescriptorConfig, unseen_spread: float = math.nan
) -> Floats:
    """Return the likelihood that people (N,) with features (N, F) are the person of the model.

    People who cannot be compared get the average of the others, or 1 if none can.

    Args:
        features: of the people.
        model: of the person.
        config: sharpness of the comparison.
        unseen_spread: assumed deviation in every feature of people without visible parts; NaN to treat them
            as people who cannot be compared.

    Source: thesis, equation 6.4.
    """
    unseen = features.shape[1] * unseen_spread**2
    chance: Floats = _likelihood(features, model.mean, config.sharpness, unseen)
    return chance


@njit(cache=True, nogil=True, error_model="numpy")
def _likelihood(features: Floats, mean: Floats, sharpness: float, unseen: float) -> Floats:
    """Convert distances to likelihoods (N,); `unseen` is the squared distance of invisible people."""
    chance, sharp = _squared_distances(features, mean), np.float32(-sharpness)
    total, known = 0.0, 0
    for i in range(len(chance)):
        chance[i] = exponential(sharp * chance[i])
    for i in range(len(chance)):
        is_known = not np.isnan(chance[i])
        total += np.float64(chance[i]) if is_known else 0.0
        known += is_known
    if known < len(chance):
        usual = np.float32(total / known if known > 0 else 1.0)
        none = usual if np.isnan(unseen) else exponential(np.float32(-sharpness * unseen))
        for i in range(len(chance)):
            if np.isnan(chance[i]):
                chance[i] = none if np.isnan(features[i]).all() else usual
    return chance


@njit(cache=True, nogil=True, error_model="numpy")
def _mean_of_known(recent: Floats) -> Floats:
    mean = np.empty(recent.shape[1], dtype=np.float32)
    for j in range(recent.shape[1]):
        total, known = np.float32(0), np.float32(0)
        for k in range(len(recent)):
            if not np.isnan(recent[k, j]):
                total += recent[k, j]
                known += np.float32(1)
        mean[j] = total / known if known > 0 else np.nan
    return mean


@njit(cache=True, nogil=True, error_model="numpy")
def _squared_distances(features: Floats, mean: Floats) -> Floats:
    result = np.empty(len(features), dtype=np.float32)
    for i in range(len(features)):
        total, seen = 0.0, 0.0
        for j in range(len(mean)):
            away = features[i, j] - mean[j]
            if not np.isnan(away):
                total += away * away
                seen += 1.0
        result[i] = total * len(mean) / seen  # 0 / 0 is NaN where nothing is visible
    return result
