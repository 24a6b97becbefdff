"""Sensors: from a camera's view at an instant to its images, including noise."""

from dataclasses import replace
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import (
    ColourConfig,
    DepthConfig,
    LaserConfig,
    PanoramaConfig,
    ThermalConfig,
)
from peopleboy.sim.cameras.colour import colour_image, expose
from peopleboy.sim.cameras.depth import (
    add_offsets,
    amplitude_of,
    draw_offsets,
    rays_of,
    skip_structured_light,
    structured_light,
    time_of_flight,
    to_millimetres,
)
from peopleboy.sim.cameras.imaging.camera_view import CameraView
from peopleboy.sim.cameras.imaging.electronics import Gain, compress, sharpen
from peopleboy.sim.cameras.imaging.noise import Drift, random_words, skip_gaussian
from peopleboy.sim.cameras.laser import measure_ranges
from peopleboy.sim.cameras.panoramic import finer, panorama_image, roll_up, unroll
from peopleboy.sim.cameras.thermal import detect, make_detector, surface_image

Image = NDArray[Any]


class Sensor(Protocol):
    """One camera with its own noise streams."""

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the images of an instant, one for each layer of the camera's kind."""
        ...

    def skip(self) -> None:
        """Skip the noise of an image that is not read."""
        ...


class ThermalSensor:
    """Thermal camera: 8-bit grey, and float32 [degC] before the encoding.

    While the shutter is closed it repeats the last images. Drift and shutter depend on time.

    Attributes:
        detector: its fixed errors throughout a run.
    """

    def __init__(self, config: ThermalConfig, name: str, seed: int) -> None:
        self._config = config
        self.detector = make_detector(config, stream(seed, f"{name}.detector"))
        self._noise = stream(seed, f"{name}.noise")
        self._drift = Drift(config, name, seed)
        self._gain = Gain(config)
        self._last: tuple[Image, ...] = ()

    def draw_noise(self) -> NDArray[np.uint64]:
        """Return random words for the noise of one image."""
        return random_words(self.detector.dead.shape, self._noise)

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the (H, W) images of an instant: uint8, float32."""
        if not self._last or not self._drift.is_closed(seen.time_s):
            temperature = self._read_out(seen)
            self._last = self._grey(temperature, seen.time_s), temperature
        return self._last

    def skip(self) -> None:
        """Skip the noise of an image."""
        skip_gaussian(self.detector.dead.shape, self._noise)

    def _read_out(self, seen: CameraView) -> NDArray[np.float32]:
        """Return the scene with the detector's errors [degC]."""
        config = self._config
        apparent = surface_image(seen, config)
        return detect(apparent, self.detector, config, self._noise, self._drift.offset_k(seen.time_s))

    def _grey(self, temperature_c: NDArray[np.float32], time_s: float) -> NDArray[np.uint8]:
        config = self._config
        crisp = sharpen(temperature_c, config.sharpening, config.sharpening_px, config.coring_k)
        return compress(self._gain.grey(crisp, time_s), config.jpeg_quality)


class ColourSensor:
    """Colour camera: 8-bit sRGB."""

    def __init__(self, config: ColourConfig, name: str, seed: int) -> None:
        self._config = config
        self._noise = stream(seed, f"{name}.noise")

    def draw_noise(self) -> NDArray[np.uint64]:
        """Return random words for the noise of one image."""
        camera = self._config.camera
        return random_words((camera.height, camera.width, 3), self._noise)

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the (H, W, 3) uint8 image of an instant."""
        return (expose(colour_image(seen, self._config), self._config, self._noise),)

    def skip(self) -> None:
        """Skip the noise of an image."""
        skip_gaussian((self._config.camera.height, self._config.camera.width, 3), self._noise)


class PanoramaSensor:
    """Panoramic camera: an 8-bit sRGB panorama, optionally unrolled from the lens's round image."""

    def __init__(self, config: PanoramaConfig, name: str, seed: int) -> None:
        self._config = config
        self._noise = stream(seed, f"{name}.noise")

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the (H, W, 3), and the (2 H, 2 H, 3), uint8 images of an instant."""
        config, camera = self._config, self._config.camera
        if not config.raw:
            return (expose(panorama_image(seen, config, camera), config, self._noise),)
        fine = finer(camera)
        disc = roll_up(panorama_image(replace(seen, view=seen.draw(fine)), config, fine), camera)
        raw = expose(disc, config, self._noise)
        return unroll(raw, camera), raw

    def skip(self) -> None:
        """Skip the noise of an image."""
        height = self._config.camera.height
        size = (2 * height, 2 * height) if self._config.raw else (height, self._config.camera.width)
        skip_gaussian((*size, 3), self._noise)


_LEAST_GLASS_COSINE: Final = 0.5  # more obliquely, glass reflects a fifth of the sensor's light and more


class DepthSensor:
    """Depth camera: depth in millimetres, optionally 8-bit sRGB and amplitude of the same pixels."""

    def __init__(self, config: DepthConfig, name: str, seed: int) -> None:
        self._config = config
        self._noise = stream(seed, f"{name}.noise")
        self._colour_noise = stream(seed, f"{name}.colour.noise")
        self._amplitude_noise = stream(seed, f"{name}.amplitude.noise")
        self._offsets = draw_offsets(config, stream(seed, f"{name}.offsets")) if config.offset_m else None

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the images of an instant: (H, W) uint16, (H, W, 3) uint8 and (H, W) uint16."""
        config = self._config
        depth, amplitude = self._measure(seen)
        if seen.glass_cosine is not None and config.scale > 0.0:
            depth = np.where(seen.glass_cosine < _LEAST_GLASS_COSINE, 0, depth).astype(np.uint16)
        return (
            depth if self._offsets is None else add_offsets(depth, self._offsets),
            *((expose(colour_image(seen, config), config, self._colour_noise),) if config.colour else ()),
            *((amplitude,) if amplitude is not None else ()),
        )

    def skip(self) -> None:
        """Skip the noise of an image."""
        config, shape = self._config, (self._config.camera.height, self._config.camera.width)
        if config.scale > 0.0 and config.sensor == "kinect":
            skip_structured_light(config.camera, self._noise)
        elif config.scale > 0.0:
            skip_gaussian(shape, self._noise)
        if config.colour:
            skip_gaussian((*shape, 3), self._colour_noise)
        if config.amplitude:
            skip_gaussian(shape, self._amplitude_noise)

    def _measure(self, seen: CameraView) -> tuple[Image, Image | None]:
        """Return depth, and amplitude if it is enabled."""
        config, is_exact = self._config, self._config.scale == 0.0
        if config.sensor == "kinect" and not is_exact:
            return structured_light(seen.view, config, self._noise), None
        if is_exact and not config.amplitude:
            return to_millimetres(seen.view.depth, config), None
        fine = replace(seen, view=seen.draw(rays_of(config.camera)))
        if is_exact:
            depth = to_millimetres(seen.view.depth, config)
        else:
            depth = time_of_flight(fine, config, self._noise)
        return depth, amplitude_of(fine, config, self._amplitude_noise) if config.amplitude else None


class RangeFinder:
    """Laser range finder: ranges in millimetres."""

    def __init__(self, config: LaserConfig, name: str, seed: int) -> None:
        self._config = config
        self._noise = stream(seed, f"{name}.noise")

    def take(self, seen: CameraView) -> tuple[Image, ...]:
        """Take the scan (1, N) uint16 of an instant."""
        return (measure_ranges(seen.view.depth, self._config, self._noise),)

    def skip(self) -> None:
        """Skip the noise of a scan."""
        if self._config.is_noisy:
            skip_gaussian((1, self._config.camera.width), self._noise)
