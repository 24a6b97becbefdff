"""A frame's images as lossless files: 8-bit thermal, 16-bit thermal, colour."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.thermal import encode_16bit
from peopleboy.sim.observation import Observation

Image = NDArray[np.uint8] | NDArray[np.uint16]

IMAGES = ("thermal", "thermal16", "colour")


def make_image_folders(folder: Path) -> None:
    """Make a folder for each kind of image."""
    for name in IMAGES:
        (folder / name).mkdir(parents=True)


def write_images(folder: Path, frame: int, senses: Observation) -> None:
    """Write a frame's images into the folders of their kinds.

    Raises:
        BadInput: one cannot be written.
    """
    images: tuple[Image, ...] = (senses.thermal, encode_16bit(senses.thermal_c), senses.colour)
    for name, image in zip(IMAGES, images, strict=True):
        write_png(folder / name / f"{frame:06d}.png", image)


def write_png(path: Path, image: Image) -> None:
    """Write an (H, W) grey image of 8 or 16 bits, or an (H, W, 3) RGB one.

    Raises:
        BadInput: it cannot be written.
    """
    stored = image[..., ::-1] if image.ndim == 3 else image
    if not cv2.imwrite(str(path), stored, [cv2.IMWRITE_PNG_COMPRESSION, 2]):
        raise BadInput(f"{path}: cannot write this image; is the disk full?")
