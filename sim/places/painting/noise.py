"""Clouds: smooth noise that has structure at all scales, as stains, drafts and moisture have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SIDE = 512
_SLOPE = 2.0  # amplitude falls with frequency to this power: conduction evens out what is small; 1 is grainy
_COARSEST = 4  # blotches a side: none larger, or a wall could be all one of them


@dataclass(frozen=True, slots=True, eq=False)
class Clouds:
    """A square of noise of deviation 1 that repeats seamlessly."""

    square: Array

    def at(self, across: Array, up: Array, metres: float) -> Array:
        """(H, W) noise at points (1, W) and (H, 1) [m], linear between samples, its blotches so wide [m]."""
        scale = _SIDE / (_COARSEST * metres)
        left, right, a = _between(across[0] * scale)
        low, high, b = _between(up[:, 0] * scale)
        rows = self.square[low] + b[:, None] * (self.square[high] - self.square[low])
        before = rows[:, left]
        return np.asarray(before + a * (rows[:, right] - before))


def _between(at: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """The samples (N,) before and after each place, and how far it is from the first to the second."""
    whole = np.floor(at)
    before = whole.astype(np.int64) % _SIDE
    return before, (before + 1) % _SIDE, at - whole


def draw_clouds(rng: np.random.Generator) -> Clouds:
    """Draw noise whose amplitude falls with frequency (spectral synthesis)."""
    frequency = np.hypot(np.fft.fftfreq(_SIDE)[:, None], np.fft.rfftfreq(_SIDE)[None, :]) * _SIDE
    amplitude = np.where(frequency >= _COARSEST, np.maximum(frequency, 1.0) ** -_SLOPE, 0.0)
    spectrum = amplitude * np.fft.rfft2(rng.standard_normal((_SIDE, _SIDE)))
    square = np.fft.irfft2(spectrum, (_SIDE, _SIDE))
    return Clouds(square / square.std())
