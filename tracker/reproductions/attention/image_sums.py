"""Integral images of a picture's feature maps, patterns and colours."""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.feature_maps import CELL_PX, Floats, feature_maps

# Local binary patterns: which neighbours of a pixel are brighter than the pixel.

BINS: Final = 59
"""58 uniform patterns, with at most two transitions around the ring, and one bin for all others."""


def _uniform_bins() -> NDArray[np.uint8]:
    """Return the bin of each of the 256 patterns."""
    bins = np.full(256, BINS - 1, np.uint8)
    ring = [[(code >> k) & 1 for k in range(8)] for code in range(256)]
    uniform = [c for c in range(256) if sum(ring[c][k] != ring[c][k - 1] for k in range(8)) <= 2]
    bins[uniform] = np.arange(len(uniform))
    return bins


_BIN_OF: Final = _uniform_bins()


def patterns(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the pattern's bin at each pixel (H, W) of an image (H, W, 3); the border counts as uniform.

    Source: situation-awareness thesis, section 5.2, which only says "uniform".
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


COLOUR_BINS: Final = 512
"""Eight levels each of red, green and blue."""

_LEAST_PX: Final = 16


@dataclass(frozen=True, slots=True, eq=False)
class ImageSums:
    """Features of an image in cells of two by two pixels.

    Attributes:
        image: (H, W, 3) RGB.
        maps: (rows, columns, 23) feature maps; None if not used.
        map_sums: (rows + 1, columns + 1, 23) their integral images; None if not used.
        pattern_sums: (rows + 1, columns + 1, 59) integral images of the patterns; None if not used.
        colours: (H, W) colour bin of each pixel.
    """

    image: NDArray[np.uint8]
    maps: Floats | None
    map_sums: NDArray[np.float64] | None
    pattern_sums: NDArray[np.float32] | None
    colours: NDArray[np.uint16]

    @classmethod
    def of(cls, image: NDArray[np.uint8], config: AttentionConfig) -> "ImageSums":
        """Compute the features of an image.

        Raises:
            BadInput: not an (H, W, 3) uint8 image, or too small.
        """
        check_image(image)
        maps = feature_maps(image, config) if config.maps and (config.plain or config.surround) else None
        found = _pattern_sums(patterns(image)) if config.maps and config.patterns else None
        return cls(image, maps, None if maps is None else _sums(maps), found, colour_bins(image))

    @property
    def rows(self) -> int:
        """Height in cells."""
        return int(self.image.shape[0]) // CELL_PX

    @property
    def columns(self) -> int:
        """Width in cells."""
        return int(self.image.shape[1]) // CELL_PX


def check_image(image: object) -> None:
    """Refuse invalid colour images.

    Raises:
        BadInput: the image is invalid.
    """
    rule = f"attention: image must be (H, W, 3) uint8, at least {_LEAST_PX} px each way"
    if not isinstance(image, np.ndarray):
        raise BadInput(f"{rule}, got {type(image).__name__}")
    is_colour = image.ndim == 3 and image.shape[2] == 3 and min(image.shape[:2]) >= _LEAST_PX
    if not is_colour or image.dtype != np.uint8:
        raise BadInput(f"{rule}, got {image.shape} {image.dtype}")


@njit(cache=True, nogil=True)
def colour_bins(image: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """Return the colour bins (H, W) of an image (H, W, 3)."""
    bins = np.empty(image.shape[:2], np.uint16)
    for v in range(image.shape[0]):
        for u in range(image.shape[1]):
            bins[v, u] = (image[v, u, 0] >> 5) << 6 | (image[v, u, 1] >> 5) << 3 | (image[v, u, 2] >> 5)
    return bins


def _sums(maps: Floats) -> NDArray[np.float64]:
    parts = [cv2.integral(maps[:, :, k : k + 4], sdepth=cv2.CV_64F) for k in range(0, maps.shape[2], 4)]
    return np.ascontiguousarray(np.dstack(parts))


@njit(cache=True, nogil=True)
def _pattern_sums(found: NDArray[np.uint8]) -> NDArray[np.float32]:
    rows, columns = found.shape[0] // CELL_PX, found.shape[1] // CELL_PX
    sums = np.zeros((rows + 1, columns + 1, BINS), np.float32)
    row = np.zeros(BINS, np.float32)
    for y in range(rows):
        row[:] = 0
        for x in range(columns):
            for v in range(CELL_PX * y, CELL_PX * y + CELL_PX):
                for u in range(CELL_PX * x, CELL_PX * x + CELL_PX):
                    row[found[v, u]] += np.float32(1)
            for k in range(BINS):
                sums[y + 1, x + 1, k] = sums[y, x + 1, k] + row[k]
    return sums
