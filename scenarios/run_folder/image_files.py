"""Write images as lossless files in the background, and describe their contents."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import write_aside
from peopleboy.sim.cameras.camera_config import CameraConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import Stored, image_folders
from peopleboy.sim.observation import Observation
from peopleboy.sim.world_config import CONTROL_HZ


def make_image_folders(folder: Path, cameras: Mapping[str, CameraConfig]) -> None:
    """Make a folder for each kind of image: thermal, thermal16, colour, ..."""
    for name, _, _ in image_folders(cameras):
        (folder / name).mkdir(parents=True)


def write_images(folder: Path, frame: int, senses: Observation, cameras: Mapping[str, CameraConfig]) -> None:
    """Write a frame's images into their folders.

    Raises:
        BadInput: an image cannot be written.
    """
    for path, image in images_to_write(folder, frame, senses, cameras):
        write_png(path, image)


def images_to_write(
    folder: Path, frame: int, senses: Observation, cameras: Mapping[str, CameraConfig]
) -> Iterator[tuple[Path, Stored]]:
    """Return a frame's images in their stored form, with their paths."""
    for name, image, layer in image_folders(cameras):
        if image in senses.images:
            yield folder / name / image_file(frame), layer.encode(senses.images[image])


def mask_file(folder: Path, camera: str, frame: int) -> Path:
    """Return the file of a frame with the id of the person at each pixel, in the folder of a run."""
    return folder / "truth" / camera / "instance" / image_file(frame)


def image_file(frame: int) -> str:
    """Return the file name of a frame, counted from 1."""
    return f"{frame:06d}.png"


def write_png(path: Path, image: Stored) -> None:
    """Write an (H, W) grey image of 8 or 16 bits, or an (H, W, 3) RGB image.

    Raises:
        BadInput: the image cannot be written.
    """
    try:
        write_aside(path, png_bytes(image))
    except OSError as error:
        raise BadInput(f"{path}: cannot write this image: {error.strerror or error}") from error


def png_bytes(image: Stored) -> bytes:
    """Return the contents of a PNG file with an image, as in `write_png`."""
    stored = image[..., ::-1] if image.ndim == 3 else image
    _, encoded = cv2.imencode(".png", stored, [cv2.IMWRITE_PNG_COMPRESSION, 2])
    return encoded.tobytes()


def millimetres(depth_m: NDArray[np.floating]) -> NDArray[np.uint16]:
    """Convert depth (H, W) [m] to whole millimetres; 0 for no measurement or more than 65 m."""
    whole = np.rint(1000.0 * np.where(np.isfinite(depth_m), depth_m, 0.0))
    return np.where(whole < 65536.0, whole, 0.0).astype(np.uint16)


_KEYS: Mapping[str, tuple[str, ...]] = {
    "fixed": ("lowest_c", "highest_c"),
    "percentile": ("gain_follows_s", "tail_percent", "least_span_k"),
    "plateau": ("gain_follows_s", "tail_percent", "least_span_k", "plateau_percent", "linear_share"),
}


def about_gains(cameras: Mapping[str, CameraConfig]) -> dict[str, dict[str, Any]]:
    """Return the gain of each thermal camera, with its settings."""
    return {
        name: {"gain": config.gain} | {key: getattr(config, key) for key in _KEYS[config.gain]}
        for name, config in cameras.items()
        if isinstance(config, ThermalConfig)
    }


def thermal_span_c(config: ThermalConfig) -> list[float] | None:
    """Return the span [degC] of 8-bit images; None if it changes between images."""
    return [config.lowest_c, config.highest_c] if config.gain == "fixed" else None


MOST: Final = 64
"""Maximum number of waiting jobs; `add` blocks while the queue is full."""


class BackgroundQueue:
    """Execute jobs one after the other in a background thread, in order and without dropping any.

    An error raised by a job is raised again by the next call of `add` or `flush`.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)
        self._waiting: deque[Future[None]] = deque()

    def add(self, work: Callable[[], None]) -> None:
        """Append a job."""
        while self._waiting and (len(self._waiting) >= MOST or self._waiting[0].done()):
            self._waiting.popleft().result()
        self._waiting.append(self._thread.submit(work))

    def flush(self) -> None:
        """Wait until all jobs are done."""
        while self._waiting:
            self._waiting.popleft().result()

    def close(self) -> None:
        """Finish the remaining jobs, and end the thread; their errors are dropped, since one was raised."""
        self._thread.shutdown()


def describe_images(outfits: Iterable[Mapping[str, CameraConfig]]) -> str:
    """Describe size and frame rate of the cameras' images, with the cameras' names if they differ.

    Args:
        outfits: cameras of each robot.
    """
    names: dict[str, dict[str, None]] = {}
    for name, config in (pair for cameras in outfits for pair in cameras.items()):
        camera = config.camera
        words = f"{camera.width}x{camera.height} pixels, {config.rate_hz or CONTROL_HZ} a second"
        names.setdefault(words, {})[name] = None
    if len(names) == 1:
        return next(iter(names))
    return ", or ".join(f"{words} ({', '.join(own)})" for words, own in names.items())
