"""What a person looked like lately, and how likely somebody is that person."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from peopleboy.tracker.thermal.colour_config import ColourConfig
from peopleboy.tracker.thermal.filter.particles import Floats


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

    @property
    def is_empty(self) -> bool:
        """Whether no part was ever seen."""
        return bool(np.isnan(self.recent).all())

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
