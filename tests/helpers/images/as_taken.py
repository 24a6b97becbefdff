"""Images as trackers get them."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

Image = TypeVar("Image", bound=np.ndarray)


def as_taken(image: Image) -> Image:
    """Give an image that cannot be written to, like those of a frame; kernels are compiled for such ones."""
    image.setflags(write=False)
    return image
