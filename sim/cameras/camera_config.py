"""The settings of the cameras: where each sits, how often it takes an image, and how that is formed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Pinhole

# The colour camera sits 6 cm to the left of the thermal one and sees an angle narrower by 1.2 (T eq. 6.1).
COLOUR_BASELINE_M = 0.06
COLOUR_ZOOM = 1.2


def _colour_camera() -> Pinhole:
    thermal = Pinhole()
    x, y, z = thermal.position_m
    half_angle = math.atan(math.tan(thermal.vertical_fov_rad / 2.0) / COLOUR_ZOOM)
    return Pinhole(vertical_fov_rad=2.0 * half_angle, position_m=(x, y + COLOUR_BASELINE_M, z))


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraConfig:
    """One camera of the robot; each kind adds what forms its images.

    Attributes:
        kind: its name in `peopleboy.sim.cameras.kinds.KINDS`.
        camera: geometry.
        rate_hz: [Hz] of its images, which divides the control rate; None for that rate.
        exposure_s: [s] time over which rotation blurs the image.
    """

    kind: ClassVar[str]

    camera: CameraGeometry = field(default_factory=Pinhole)
    rate_hz: int | None = None
    exposure_s: float = 0.0

    def resized(self, width: int, height: int) -> Self:
        """The same camera with images of another size [px], of the same height of view."""
        return replace(self, camera=replace(self.camera, width=width, height=height))

    def noisier(self, factor: float) -> Self:  # noqa: ARG002
        """The same camera with so many times the noise; one without any stays as it is."""
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalConfig(CameraConfig):
    """A thermal camera and its image formation.

    Attributes:
        exposure_s: [s] thermal time constant over which rotation blurs the image.
        blur_px: [px] standard deviation of the optics' point spread.
        netd_k: [K] temporal noise, noise-equivalent temperature difference.
        fixed_pattern_k: [K] standard deviation of the offsets between pixels, constant over a run.
        dead_pixels: share of pixels that read one constant value over a run.
        lowest_c, highest_c: [degC] span of the 8-bit image (T ch. 3).
    """

    kind: ClassVar[str] = "thermal"

    camera: Pinhole = field(default_factory=Pinhole)
    exposure_s: float = 0.012
    blur_px: float = 0.7
    netd_k: float = 0.08
    fixed_pattern_k: float = 0.03
    dead_pixels: float = 0.0001
    lowest_c: float = 24.0
    highest_c: float = 36.0

    def resized(self, width: int, height: int) -> Self:
        """The same camera with images of another size [px], of the same height of view and as sharp."""
        camera = replace(self.camera, width=width, height=height)
        return replace(self, camera=camera, blur_px=self.blur_px * height / self.camera.height)

    def noisier(self, factor: float) -> Self:
        """The same camera with so many times the noise, temporal and fixed."""
        return replace(self, netd_k=factor * self.netd_k, fixed_pattern_k=factor * self.fixed_pattern_k)


@dataclass(frozen=True, slots=True, kw_only=True)
class LightConfig(CameraConfig):
    """A camera that sees light, and its image formation.

    Attributes:
        gain: share of full scale that a white surface facing the light has at light level 1.
        read_noise: standard deviation of the noise of a black pixel, share of full scale.
        shot_noise: standard deviation of the noise of a white pixel, share of full scale.
    """

    exposure_s: float = 0.015
    gain: float = 0.95
    read_noise: float = 0.004
    shot_noise: float = 0.012

    def noisier(self, factor: float) -> Self:
        """The same camera with so many times the noise."""
        return replace(self, read_noise=factor * self.read_noise, shot_noise=factor * self.shot_noise)


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourConfig(LightConfig):
    """A colour camera whose image is flat."""

    kind: ClassVar[str] = "colour"

    camera: Pinhole = field(default_factory=_colour_camera)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaConfig(LightConfig):
    """A panoramic colour camera.

    Attributes:
        raw: whether the panorama is unrolled from the round image of the lens, which is given, too: coarse
            where it looks down steeply, as it is there; otherwise each of its pixels is seen by itself.
    """

    kind: ClassVar[str] = "panorama"

    camera: Panorama = field(default_factory=Panorama)
    raw: bool = False
