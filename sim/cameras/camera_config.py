"""The settings of the cameras: where each sits, how often it takes an image, and how that is formed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, Final, Literal, Self, get_args

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Pinhole

# The colour camera sits 6 cm to the left of the thermal one and sees an angle narrower by 1.2 (T eq. 6.1).
COLOUR_BASELINE_M = 0.06
COLOUR_ZOOM = 1.2

DEPTH_BASELINE_M: Final = 0.075  # from the projector of a structured-light sensor to its camera
_DEPTH_ROWS = 480  # that such a sensor has, however many of them an image has

FARTHEST_M: Final = 65.0  # that 16 bits of millimetres hold

DepthSensorName = Literal["kinect", "tof"]
GainName = Literal["fixed", "percentile", "plateau"]


def _colour_camera() -> Pinhole:
    thermal = Pinhole()
    x, y, z = thermal.position_m
    half_angle = math.atan(math.tan(thermal.vertical_fov_rad / 2.0) / COLOUR_ZOOM)
    return Pinhole(vertical_fov_rad=2.0 * half_angle, position_m=(x, y + COLOUR_BASELINE_M, z))


def _depth_camera() -> Pinhole:
    return Pinhole(width=640, height=480, vertical_fov_rad=math.radians(43.0))


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

    @property
    def remembers(self) -> bool:
        """Whether images depend on those before, so that it must take each, also if nobody asks for it."""
        return False

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
        gain: how 8-bit grey comes from temperature: "fixed", linear over `lowest_c` to `highest_c`;
            "percentile", linear over the image's own span; or "plateau", its histogram equalised.
        lowest_c, highest_c: [degC] span of a fixed gain (T ch. 3).
        gain_follows_s: [s] time constant with which an automatic gain follows the images; 0 for at once. A
            span grows at once.
        tail_percent: [%] of the pixels that may lie outside an automatic gain's span, at either end.
        least_span_k: [K] that an automatic gain spreads over all greys at least.
        plateau_percent: [%] of the pixels, the most that a bin of 0.05 K counts for in a plateau gain.
        linear_share: of the greys that a plateau gain shares out linearly over its span.
        column_noise_k: [K] standard deviation of the offsets between columns, until the next calibration.
        vignetting_k: [K] by which corners seem warmer than the middle.
        offset_drift_k_per_min: [K/min] standard deviation of the common offset's drift since a calibration;
            that of the pattern is in proportion.
        shutter_every_s: [s] from one calibration, before a shutter, to the next; 0 for none.
        shutter_lasts_s: [s] for which the image stands still then.
        sharpening: amount of the unsharp mask in 8 bits; 0 for none.
        sharpening_px: [px] standard deviation of its blur.
        coring_k: [K] that a pixel of 8 bits must differ from its blurred neighbourhood to be more than noise,
            which is evened out; 0 for none.
        jpeg_quality: 1..100, of the compression that the 8-bit image went through; None for none.

    Raises:
        BadInput: no such gain, an empty span, or a shutter that never opens.
    """

    kind: ClassVar[str] = "thermal"

    camera: Pinhole = field(default_factory=Pinhole)
    exposure_s: float = 0.012
    blur_px: float = 0.7
    netd_k: float = 0.08
    fixed_pattern_k: float = 0.03
    dead_pixels: float = 0.0001
    gain: GainName = "fixed"
    lowest_c: float = 24.0
    highest_c: float = 36.0
    gain_follows_s: float = 1.0
    tail_percent: float = 0.3
    least_span_k: float = 5.0
    plateau_percent: float = 0.5
    linear_share: float = 0.3
    column_noise_k: float = 0.0
    vignetting_k: float = 0.0
    offset_drift_k_per_min: float = 0.0
    shutter_every_s: float = 0.0
    shutter_lasts_s: float = 0.4
    sharpening: float = 0.0
    sharpening_px: float = 1.5
    coring_k: float = 0.0
    jpeg_quality: int | None = None

    def __post_init__(self) -> None:
        """Refuse what no camera does."""
        if self.gain not in get_args(GainName):
            known = ", ".join(get_args(GainName))
            raise BadInput(f"no such gain: {self.gain!r}; choose from {known}", key=("gain",))
        if not self.lowest_c < self.highest_c:
            raise BadInput(
                f"{self.highest_c} must be more than lowest_c, {self.lowest_c}", key=("highest_c",)
            )
        if 0.0 < self.shutter_every_s <= self.shutter_lasts_s:
            raise BadInput(
                f"{self.shutter_every_s} must be more than shutter_lasts_s, {self.shutter_lasts_s}, or 0",
                key=("shutter_every_s",),
            )

    @property
    def remembers(self) -> bool:
        """Whether an automatic gain follows the images, or a shutter stops them."""
        return self.shutter_every_s > 0.0 or (self.gain != "fixed" and self.gain_follows_s > 0.0)

    @property
    def is_simple(self) -> bool:
        """Whether an image is its scene, its noise and a fixed gain, and nothing else."""
        changes = self.offset_drift_k_per_min, self.column_noise_k, self.shutter_every_s, self.sharpening
        has_changes = any(value > 0.0 for value in (*changes, self.coring_k))
        return self.gain == "fixed" and self.jpeg_quality is None and not has_changes

    def resized(self, width: int, height: int) -> Self:
        """The same camera with images of another size [px], of the same height of view and as sharp."""
        camera, larger = replace(self.camera, width=width, height=height), height / self.camera.height
        return replace(
            self,
            camera=camera,
            blur_px=self.blur_px * larger,
            sharpening_px=self.sharpening_px * larger,
        )

    def noisier(self, factor: float) -> Self:
        """The same camera with so many times the noise, temporal and fixed."""
        return replace(
            self,
            netd_k=factor * self.netd_k,
            fixed_pattern_k=factor * self.fixed_pattern_k,
            column_noise_k=factor * self.column_noise_k,
        )


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


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthConfig(LightConfig):
    """A camera that measures depth, and sees colours through the same lens: an RGB-D camera.

    Attributes:
        sensor: "kinect", structured light, whose noise is in disparity; or "tof", time of flight.
        scale: of the noise: 0 for exact depth without holes, 1 as it usually is.
        nearest_m, farthest_m: [m] depths that it can measure.
        colour: whether it gives colour, too.
        amplitude: whether it gives the strength of the light that came back, too, as time of flight can.
        offset_m: [m] largest error of a pixel that is the same in all images.

    Raises:
        BadInput: no such sensor, one that knows no amplitude, a negative scale, or no depths that it can
            measure.
    """

    kind: ClassVar[str] = "depth"

    camera: Pinhole = field(default_factory=_depth_camera)
    sensor: DepthSensorName = "kinect"
    scale: float = 1.0
    nearest_m: float = 0.5
    farthest_m: float = 10.0
    colour: bool = True
    amplitude: bool = False
    offset_m: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no sensor does."""
        if self.sensor not in get_args(DepthSensorName):
            known = ", ".join(get_args(DepthSensorName))
            raise BadInput(f"no such sensor: {self.sensor!r}; choose from {known}", key=("sensor",))
        if self.amplitude and self.sensor != "tof":
            raise BadInput(f"only a sensor 'tof' gives it, not {self.sensor!r}", key=("amplitude",))
        if not 0.0 <= self.scale < math.inf:
            raise BadInput(f"{self.scale} must be 0 or more, and finite", key=("scale",))
        if not 0.0 <= self.nearest_m < self.farthest_m <= FARTHEST_M:
            raise BadInput(
                f"{self.farthest_m} must be more than nearest_m, {self.nearest_m}, and at most {FARTHEST_M}",
                key=("farthest_m",),
            )

    @property
    def disparity_px_m(self) -> float:
        """Disparity [px] of what is 1 m away, in pixels of the sensor, which has 480 rows."""
        return self.camera.focal_px * _DEPTH_ROWS / self.camera.height * DEPTH_BASELINE_M

    def noisier(self, factor: float) -> Self:
        """The same camera with so many times the noise, of depth and of colour."""
        brighter = LightConfig.noisier(self, factor)
        return replace(brighter, scale=factor * self.scale)
