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
        u, v = across * scale, up * scale
        left, low = np.floor(u).astype(int), np.floor(v).astype(int)
        a, b = u - left, v - low
        s, left, low = self.square, left % _SIDE, low % _SIDE
        right, high = (left + 1) % _SIDE, (low + 1) % _SIDE
        lower = s[low, left] * (1.0 - a) + s[low, right] * a
        upper = s[high, left] * (1.0 - a) + s[high, right] * a
        return np.asarray(lower * (1.0 - b) + upper * b)


def draw_clouds(rng: np.random.Generator) -> Clouds:
    """Draw noise whose amplitude falls with frequency (spectral synthesis)."""
    frequency = np.hypot(np.fft.fftfreq(_SIDE)[:, None], np.fft.rfftfreq(_SIDE)[None, :]) * _SIDE
    amplitude = np.where(frequency >= _COARSEST, np.maximum(frequency, 1.0) ** -_SLOPE, 0.0)
    spectrum = amplitude * np.fft.rfft2(rng.standard_normal((_SIDE, _SIDE)))
    square = np.fft.irfft2(spectrum, (_SIDE, _SIDE))
    return Clouds(square / square.std())
