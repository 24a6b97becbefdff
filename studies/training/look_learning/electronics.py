"""What a camera's electronics and files do to images: they spread greys, sharpen edges, and compress."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.imaging.electronics import compress
from peopleboy.studies.training.people_learning.shots import PeopleShot

Grey = NDArray[np.uint8]

_EQUALISED: Final = 0.25  # of images
_MOST_EQUALISED: Final = 0.8  # of the way to greys that are all as frequent
_SHARPENED: Final = 0.3
_RADII_PX: Final = (0.8, 3.0)
_MOST_SHARPENED: Final = 1.5
_COMPRESSED: Final = 0.4
_QUALITIES: Final = (25, 92)


def through_electronics(shot: PeopleShot, rng: np.random.Generator) -> PeopleShot:
    """Give an image as it is, or as it comes out of a camera that makes it easier for people to look at."""
    if rng.random() < _EQUALISED:
        shot = equalised(shot, rng.uniform(0.0, _MOST_EQUALISED))
    if rng.random() < _SHARPENED:
        shot = replace(
            shot, grey=sharpened(shot.grey, rng.uniform(*_RADII_PX), rng.uniform(0.0, _MOST_SHARPENED))
        )
    if rng.random() < _COMPRESSED:
        shot = replace(shot, grey=compress(shot.grey, int(rng.integers(*_QUALITIES))))
    return shot


def equalised(shot: PeopleShot, share: float) -> PeopleShot:
    """Spread greys by how frequent they are, as an automatic gain with a plateau does, some of the way.

    What changed does by as much more or less as the greys there are spread.
    """
    counts = np.bincount(shot.grey.ravel(), minlength=256)
    rank = 255.0 * np.cumsum(counts) / counts.sum()
    told = (1.0 - share) * np.arange(256.0) + share * rank
    steepness = cv2.GaussianBlur(np.gradient(told)[None], (0, 0), 4.0)[0]
    change = np.clip(shot.change * steepness[shot.grey], 0.0, 255.0)
    return replace(
        shot, grey=np.rint(told).astype(np.uint8)[shot.grey], change=np.rint(change).astype(np.uint8)
    )


def sharpened(grey: Grey, radius_px: float, gain: float) -> Grey:
    """Exaggerate what is finer than a radius, which leaves rims around what is warm.

    The simulated camera does so in kelvin, before greys are told; here nothing but greys is known.
    """
    image = grey.astype(np.float32)
    finer = image - cv2.GaussianBlur(image, (0, 0), radius_px)
    return np.asarray(np.rint(np.clip(image + gain * finer, 0.0, 255.0)), np.uint8)
