"""The settings of the cameras: where each sits, how often it takes an image, and how that is formed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar, Final, Literal, Self, get_args

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.settings import Share
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import CameraGeometry, Pinhole

# The colour camera sits 6 cm to the left of the thermal one and sees an angle narrower by 1.2 (T eq. 6.1).
COLOUR_BASELINE_M = 0.06
COLOUR_ZOOM = 1.2

DEPTH_BASELINE_M: Final = 0.075  # from the projector of a structured-light sensor to its camera
_DEPTH_ROWS = 480  # that such a sensor has, however many of them an image has

FARTHEST_M: Final = 65.0  # that 16 bits of millimetres hold

DepthSensorName = Literal["kinect", "tof"]
GainName = Literal["fixed", "percentile", "plateau"]
Exposure = Annotated[
    float, Field(ge=0.0, le=1.0, description="exposure time, over which rotation blurs the image")
]


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

    `kind` is its name in `peopleboy.sim.cameras.kinds.KINDS`, `camera` its geometry.
    """

    kind: ClassVar[str]

    camera: CameraGeometry = field(default_factory=Pinhole)
    rate_hz: Annotated[
        int | None,
        Field(
            ge=1,
            le=15,
            description="frame rate: 1, 3, 5 or 15; default 15, which `thermal` and `colour` always have",
        ),
    ] = None
    exposure_s: Exposure = 0.0

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
    """A thermal camera; the one named `thermal` is the tracker's input.

    Raises:
        BadInput: no such gain, an empty span, or a shutter that never opens.
    """

    kind: ClassVar[str] = "thermal"

    camera: Pinhole = field(default_factory=Pinhole)
    exposure_s: Exposure = 0.012
    gain: Annotated[
        GainName,
        Field(
            description="how 8-bit grey comes from temperature: `fixed`, linear over `lowest_c` to "
            "`highest_c`; `percentile`, linear over the span of the image; `plateau`, its histogram "
            "equalised as far as a plateau allows"
        ),
    ] = "fixed"
    # The span of a fixed gain: T ch. 3.
    lowest_c: Annotated[
        float, Field(ge=-40.0, le=160.0, description="for gain `fixed`: temperature of black")
    ] = 24.0
    highest_c: Annotated[
        float, Field(ge=-40.0, le=160.0, description="for gain `fixed`: temperature of white")
    ] = 36.0
    gain_follows_s: Annotated[
        float,
        Field(
            ge=0.0,
            le=60.0,
            description="time constant with which an automatic gain follows the images; 0 for at once; a "
            "span grows at once",
        ),
    ] = 1.0
    tail_percent: Annotated[
        float,
        Field(
            ge=0.0,
            le=0.45,
            description="share of the pixels that may lie outside an automatic gain's span, at either end",
        ),
    ] = 0.3
    least_span_k: Annotated[
        float, Field(ge=0.5, le=200.0, description="smallest span of an automatic gain")
    ] = 5.0
    plateau_percent: Annotated[
        float,
        Field(
            ge=0.01,
            le=100.0,
            description="of gain `plateau`: share of the pixels that 0.05 K count for at most; 100 equalises "
            "fully",
        ),
    ] = 0.5
    linear_share: Annotated[
        Share, Field(description="for gain `plateau`: share of the grey values that are linear over the span")
    ] = 0.3
    blur_px: Annotated[float, Field(ge=0.0, le=20.0, description="optical blur, standard deviation")] = 0.7
    netd_k: Annotated[float, Field(ge=0.0, le=5.0, description="temporal noise, standard deviation")] = 0.08
    fixed_pattern_k: Annotated[
        float, Field(ge=0.0, le=5.0, description="fixed-pattern noise, standard deviation")
    ] = 0.03
    dead_pixels: Annotated[Share, Field(description="share of dead pixels, which have a constant value")] = (
        0.0001
    )
    column_noise_k: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="column noise, constant until the next calibration, standard deviation",
        ),
    ] = 0.0
    vignetting_k: Annotated[
        float, Field(ge=0.0, le=10.0, description="how much warmer the corners appear than the centre")
    ] = 0.0
    offset_drift_k_per_min: Annotated[
        float,
        Field(
            ge=0.0,
            le=20.0,
            description="how fast all of the image drifts away after a calibration, a standard deviation; "
            "its patches by half of that, its pixels by a tenth",
        ),
    ] = 0.0
    shutter_every_s: Annotated[
        float,
        Field(
            ge=0.0,
            le=3600.0,
            description="time from one calibration, before a shutter, to the next; 0 for none",
        ),
    ] = 0.0
    shutter_lasts_s: Annotated[
        float, Field(ge=0.0, le=5.0, description="duration of the frozen image during a calibration")
    ] = 0.4
    sharpening: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="how much of what blur would take away is added in 8 bits; halos come with it",
        ),
    ] = 0.0
    sharpening_px: Annotated[float, Field(gt=0.0, le=20.0, description="standard deviation of that blur")] = (
        1.5
    )
    coring_k: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="details of 8 bits that differ by less from what is about them are taken for noise "
            "and evened out",
        ),
    ] = 0.0
    jpeg_quality: Annotated[
        int | None,
        Field(
            ge=1,
            le=100,
            description="JPEG quality of the 8-bit image; no compression by default",
        ),
    ] = None

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
    """A camera that sees light, and its image formation."""

    exposure_s: Exposure = 0.015
    gain: Annotated[
        float,
        Field(
            gt=0.0,
            le=10.0,
            description="fraction of full scale of a white surface facing the light in full light",
        ),
    ] = 0.95
    read_noise: Annotated[
        Share, Field(description="standard deviation of the noise of a black pixel, fraction of full scale")
    ] = 0.004
    shot_noise: Annotated[
        Share, Field(description="standard deviation of the noise of a white pixel, fraction of full scale")
    ] = 0.012

    def noisier(self, factor: float) -> Self:
        """The same camera with so many times the noise."""
        return replace(self, read_noise=factor * self.read_noise, shot_noise=factor * self.shot_noise)


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourConfig(LightConfig):
    """A colour camera; the one named `colour` is the tracker's input."""

    kind: ClassVar[str] = "colour"

    camera: Pinhole = field(default_factory=_colour_camera)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaConfig(LightConfig):
    """A colour camera with a 360-degree view by a mirror above the robot's axis; its image is unrolled."""

    kind: ClassVar[str] = "panorama"

    camera: Panorama = field(default_factory=Panorama)
    raw: Annotated[
        bool,
        Field(
            description="whether the image is unrolled from the round one that the lens sees, coarse where "
            "it looks down steeply, and that one is kept, too; otherwise each pixel is seen by itself"
        ),
    ] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthConfig(LightConfig):
    """A depth camera with colour through the same lens.

    Raises:
        BadInput: no such sensor, one that knows no amplitude, a negative scale, or no depths that it can
            measure.
    """

    kind: ClassVar[str] = "depth"

    camera: Pinhole = field(default_factory=_depth_camera)
    sensor: Annotated[
        DepthSensorName,
        Field(
            description="how it measures: `kinect` by a pattern of light, with noise and steps in disparity, "
            "shadows, frayed edges and holes; `tof` by the time that light takes, with depths between two "
            "surfaces at edges"
        ),
    ] = "kinect"
    scale: Annotated[
        float,
        Field(
            ge=0.0,
            le=100.0,
            description="factor on the depth noise; 0 gives exact depth, with holes beyond the range only",
        ),
    ] = 1.0
    nearest_m: Annotated[float, Field(ge=0.0, le=FARTHEST_M, description="smallest measured depth")] = 0.5
    farthest_m: Annotated[float, Field(gt=0.0, le=FARTHEST_M, description="largest measured depth")] = 10.0
    colour: Annotated[bool, Field(description="whether it gives colour for each depth pixel")] = True
    amplitude: Annotated[
        bool,
        Field(description="for sensor `tof`: whether it also gives the amplitude of the returned light"),
    ] = False
    offset_m: Annotated[float, Field(ge=0.0, le=0.1, description="largest constant error of a pixel")] = 0.0

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


def calibrations_of(cameras: Mapping[str, CameraConfig]) -> Mapping[str, Calibration]:
    """Return the calibration of each camera by its name; cameras whose geometry has none are left out."""
    found = {name: config.camera.calibration for name, config in cameras.items()}
    return {name: calibration for name, calibration in found.items() if calibration is not None}
