"""Write images as lossless files, in the background, and describe what they hold."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import CameraConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import Stored, image_folders
from peopleboy.sim.observation import Observation
from peopleboy.sim.world_config import CONTROL_HZ


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
    """Return a frame's images as they are stored, and where."""
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
    """Return depth (H, W) [m] in whole millimetres; 0 where nothing is, and beyond 65 m."""
    whole = np.rint(1000.0 * np.where(np.isfinite(depth_m), depth_m, 0.0))
    return np.where(whole < 65536.0, whole, 0.0).astype(np.uint16)


_KEYS: Mapping[str, tuple[str, ...]] = {
    "fixed": ("lowest_c", "highest_c"),
    "percentile": ("gain_follows_s", "tail_percent", "least_span_k"),
    "plateau": ("gain_follows_s", "tail_percent", "least_span_k", "plateau_percent", "linear_share"),
}


def about_gains(cameras: Mapping[str, CameraConfig]) -> dict[str, dict[str, Any]]:
    """Return by which gain each thermal camera comes to its grey, and with which settings."""
    return {
        name: {"gain": config.gain} | {key: getattr(config, key) for key in _KEYS[config.gain]}
        for name, config in cameras.items()
        if isinstance(config, ThermalConfig)
    }


def thermal_span_c(config: ThermalConfig) -> list[float] | None:
    """Return the span [degC] of 8-bit images; None where it changes from image to image."""
    return [config.lowest_c, config.highest_c] if config.gain == "fixed" else None


MOST: Final = 64
"""How much work may wait; whoever brings more waits until some is done."""


class BackgroundQueue:
    """Does one piece of work after the other, in the order in which they came, and drops none.

    What a piece of work raises is raised by the next call of `add` or `flush` that finds it.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)
        self._waiting: deque[Future[None]] = deque()

    def add(self, work: Callable[[], None]) -> None:
        """Let this be done after what was added before."""
        while self._waiting and (len(self._waiting) >= MOST or self._waiting[0].done()):
            self._waiting.popleft().result()
        self._waiting.append(self._thread.submit(work))

    def flush(self) -> None:
        """Wait until all is done."""
        while self._waiting:
            self._waiting.popleft().result()

    def close(self) -> None:
        """Do what is left, and end the thread; its errors are dropped, as one is raised already."""
        self._thread.shutdown()


def describe_images(outfits: Iterable[Mapping[str, CameraConfig]]) -> str:
    """Return how large cameras' images are, how many a second, and of which cameras if they differ.

    Args:
        outfits: the cameras of each robot.
    """
    names: dict[str, dict[str, None]] = {}
    for name, config in (pair for cameras in outfits for pair in cameras.items()):
        camera = config.camera
        words = f"{camera.width}x{camera.height} pixels, {config.rate_hz or CONTROL_HZ} a second"
        names.setdefault(words, {})[name] = None
    if len(names) == 1:
        return next(iter(names))
    return ", or ".join(f"{words} ({', '.join(own)})" for words, own in names.items())
