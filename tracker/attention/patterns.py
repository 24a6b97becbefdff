"""Local binary patterns: which of a pixel's neighbours are brighter than it is."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

BINS: Final = 59
"""58 uniform patterns, in which the ring changes at most twice, and one bin for all others."""


def _uniform_bins() -> NDArray[np.uint8]:
    """Give the bin of each of the 256 patterns."""
    bins = np.full(256, BINS - 1, np.uint8)
    ring = [[(code >> k) & 1 for k in range(8)] for code in range(256)]
    uniform = [c for c in range(256) if sum(ring[c][k] != ring[c][k - 1] for k in range(8)) <= 2]
    bins[uniform] = np.arange(len(uniform))
    return bins


_BIN_OF: Final = _uniform_bins()


def patterns(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Give the bin of the pattern at each pixel (H, W) of an image (H, W, 3); of even areas at the border.

    Source: situation-awareness thesis, section 5.2, which says no more than "uniform".
    """
    grey = image.astype(np.int16).sum(axis=2)
    return np.asarray(_patterns(grey, _BIN_OF))


@njit(cache=True, nogil=True)
def _patterns(grey: NDArray[np.int16], bin_of: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = grey.shape
    found = np.full((height, width), bin_of[255], np.uint8)
    for v in range(1, height - 1):
        for u in range(1, width - 1):
            middle = grey[v, u]
            code = (
                (grey[v - 1, u - 1] >= middle)
                | (grey[v - 1, u] >= middle) << 1
                | (grey[v - 1, u + 1] >= middle) << 2
                | (grey[v, u + 1] >= middle) << 3
                | (grey[v + 1, u + 1] >= middle) << 4
                | (grey[v + 1, u] >= middle) << 5
                | (grey[v + 1, u - 1] >= middle) << 6
                | (grey[v, u - 1] >= middle) << 7
            )
            found[v, u] = bin_of[code]
    return found
