"""A frame's images as lossless files, a folder for each image of each camera."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import Stored, image_folders
from peopleboy.sim.observation import Observation


def make_image_folders(folder: Path, cameras: Mapping[str, CameraConfig]) -> None:
    """Make a folder for each image that the cameras give: thermal, thermal16, colour, ..."""
    for name, _, _ in image_folders(cameras):
        (folder / name).mkdir(parents=True)


def write_images(folder: Path, frame: int, senses: Observation, cameras: Mapping[str, CameraConfig]) -> None:
    """Write a frame's images into their folders.

    Raises:
        BadInput: one cannot be written.
    """
    for path, image in images_to_write(folder, frame, senses, cameras):
        write_png(path, image)


def images_to_write(
    folder: Path, frame: int, senses: Observation, cameras: Mapping[str, CameraConfig]
) -> Iterator[tuple[Path, Stored]]:
    """Give a frame's images as they are stored, and where."""
    for name, image, layer in image_folders(cameras):
        if image in senses.images:
            yield folder / name / image_file(frame), layer.encode(senses.images[image])


def image_file(frame: int) -> str:
    """Name the file of a frame, from 1."""
    return f"{frame:06d}.png"


def write_png(path: Path, image: Stored) -> None:
    """Write an (H, W) grey image of 8 or 16 bits, or an (H, W, 3) RGB one.

    Raises:
        BadInput: it cannot be written.
    """
    stored = image[..., ::-1] if image.ndim == 3 else image
    if not cv2.imwrite(str(path), stored, [cv2.IMWRITE_PNG_COMPRESSION, 2]):
        raise BadInput(f"{path}: cannot write this image; is the disk full?")


def millimetres(depth_m: NDArray[np.floating]) -> NDArray[np.uint16]:
    """Give depth (H, W) [m] in whole millimetres; 0 where nothing is, and beyond 65 m."""
    whole = np.rint(1000.0 * np.where(np.isfinite(depth_m), depth_m, 0.0))
    return np.where(whole < 65536.0, whole, 0.0).astype(np.uint16)
