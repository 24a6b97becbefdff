"""The empty scene as the panoramic camera sees it, and what differs from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

EMPTY_IMAGES = 5
"""How many images of the empty scene make the background (section 4.2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Subtraction:
    """How differences from the background become a silhouette.

    The paper says only that its threshold is "learned during background acquisition". Here it is learned from
    what each empty image differs from the mean of the others, since an image to come is in no mean either.

    Attributes:
        is_colour: whether red, green and blue are compared one by one, or their grey.
        deviations: the threshold, in standard deviations of those differences; None for the greatest of them.
        median_px: width of the median filter over the silhouette; 1 for none.
    """

    is_colour: bool
    deviations: float | None
    median_px: int


LITERAL = Subtraction(is_colour=False, deviations=4.0, median_px=1)
"""What the paper's words say and no more. One pixel of noise in a lower row is then a foot."""

CLEAN = Subtraction(is_colour=True, deviations=None, median_px=3)
"""Sees grey shoes on a grey floor, and lets no lone pixel through."""


@dataclass(frozen=True, slots=True, eq=False)
class Background:
    """The empty scene.

    Attributes:
        mean: (H, W, C) mean of the empty images, C being 1 or 3 as `subtraction` says.
        threshold: (C,) what a pixel must differ by, in grey levels.
        subtraction: how it was learned and is taken away.
    """

    mean: Floats
    threshold: Floats
    subtraction: Subtraction

    def silhouette(self, image: NDArray[np.uint8]) -> Mask:
        """Tell which pixels (H, W) of an RGB image (H, W, 3) differ from the background.

        Raises:
            BadInput: an image of another size.
        """
        if image.shape[:2] != self.mean.shape[:2]:
            (height, width), (rows, columns) = image.shape[:2], self.mean.shape[:2]
            raise BadInput(f"panorama is {width}x{height}, but its background {columns}x{rows}")
        differs = _differs(_planes(image, self.subtraction), self.mean, self.threshold)
        return _smooth(differs, self.subtraction.median_px)


def learn_background(empty: Sequence[NDArray[np.uint8]], subtraction: Subtraction = CLEAN) -> Background:
    """Learn the empty scene from two or more RGB images (H, W, 3) without anybody.

    Source: OMNIVIS 2003, section 4.2.
    """
    planes = np.stack([_planes(image, subtraction) for image in empty]).astype(np.float64)
    mean, count = planes.mean(axis=0), len(planes)
    differences = np.abs(planes - mean) * (count / (count - 1))  # from the mean of all others
    if subtraction.deviations is None:
        threshold = differences.max(axis=(0, 1, 2))
    else:
        threshold = subtraction.deviations * np.sqrt((differences**2).mean(axis=(0, 1, 2)))
    return Background(mean=mean, threshold=threshold, subtraction=subtraction)


def _planes(image: NDArray[np.uint8], subtraction: Subtraction) -> NDArray[np.uint8]:
    planes = image if subtraction.is_colour else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)[..., None]
    return np.ascontiguousarray(planes)


@njit(cache=True)
def _differs(planes: NDArray[np.uint8], mean: Floats, threshold: Floats) -> NDArray[np.uint8]:
    """Give 1 where (H, W) a plane of an image (H, W, C) differs from the mean by more than its threshold."""
    height, width, count = planes.shape
    differs = np.zeros((height, width), np.uint8)
    for v in range(height):
        for u in range(width):
            for c in range(count):
                differs[v, u] |= abs(planes[v, u, c] - mean[v, u, c]) > threshold[c]
    return differs


def _smooth(mask: NDArray[np.uint8], median_px: int) -> Mask:
    """Take the median over squares that go on across the seam."""
    if median_px > 1:
        half = median_px // 2
        ring = np.hstack([mask[:, -half:], mask, mask[:, :half]])
        return cv2.medianBlur(ring, median_px)[:, half:-half].astype(np.bool_)
    return mask.astype(np.bool_)
