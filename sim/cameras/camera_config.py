"""The settings of the cameras: their mounting, frame rates, and image formation."""

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
from peopleboy.sim.geometry.scan_plane import ScanPlane

# The colour camera sits 6 cm to the left of the thermal one and sees an angle narrower by 1.2 (T eq. 6.1).
COLOUR_BASELINE_M = 0.06
COLOUR_ZOOM = 1.2

DEPTH_BASELINE_M: Final = 0.075  # distance from the projector of a structured-light sensor to its camera
_DEPTH_ROWS = 480  # rows of such a sensor, whatever the size of its image

FARTHEST_M: Final = 65.0  # largest depth in 16 bits of millimetres

DepthSensorName = Literal["kinect", "tof"]
GainName = Literal["fixed", "percentile", "plateau"]
Exposure = Annotated[
    float,
    Field(
        ge=0.0, le=1.0, description="exposure time; rotation of the robot during this time blurs the image"
    ),
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
    """One camera of the robot; each kind adds the settings of its image formation.

    `kind` is its name in `peopleboy.sim.cameras.kinds.KINDS`, `camera` its geometry.
    """

    kind: ClassVar[str]

    camera: CameraGeometry = field(default_factory=Pinhole)
    rate_hz: Annotated[
        int | None,
        Field(
            ge=1,
            le=15,
            description="frame rate: 1, 3, 5 or 15. `thermal` and `colour` always have the default, 15",
        ),
    ] = None

    @property
    def remembers(self) -> bool:
        """Whether an image depends on earlier ones, so that every image must be rendered."""
        return False

    @property
    def is_noisy(self) -> bool:
        """Whether each image has new noise, so that no two images are equal."""
        return True

    def resized(self, width: int, height: int) -> Self:
        """Return the camera with another image size [px] and the same vertical field of view."""
        return replace(self, camera=replace(self.camera, width=width, height=height))

    def noisier(self, factor: float) -> Self:  # noqa: ARG002
        """Return the camera with its noise multiplied by a factor; without noise it is unchanged."""
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalConfig(CameraConfig):
    """A thermal camera. Trackers use the one named `thermal`.

    Raises:
        BadInput: the gain is unknown, the span is empty, or the shutter never opens.
    """

    kind: ClassVar[str] = "thermal"

    camera: Pinhole = field(default_factory=Pinhole)
    exposure_s: Exposure = 0.012
    gain: Annotated[
        GainName,
        Field(
            description="mapping from temperature to 8-bit grey levels: `fixed` is linear from "
            "`lowest_c` to `highest_c`; `percentile` is linear over the span of the image; "
            "`plateau` is a histogram equalisation with a limited slope"
        ),
    ] = "fixed"
    # The span of a fixed gain: T ch. 3.
    lowest_c: Annotated[
        float, Field(ge=-40.0, le=160.0, description="with gain `fixed`: temperature of black")
    ] = 24.0
    highest_c: Annotated[
        float, Field(ge=-40.0, le=160.0, description="with gain `fixed`: temperature of white")
    ] = 36.0
    gain_follows_s: Annotated[
        float,
        Field(
            ge=0.0,
            le=60.0,
            description="time constant of an automatic gain; 0 adapts immediately. The span always grows "
            "immediately",
        ),
    ] = 1.0
    tail_percent: Annotated[
        float,
        Field(
            ge=0.0,
            le=0.45,
            description="share of pixels below the span of an automatic gain, and of pixels above it",
        ),
    ] = 0.3
    least_span_k: Annotated[
        float, Field(ge=0.5, le=200.0, description="minimum span of an automatic gain")
    ] = 5.0
    plateau_percent: Annotated[
        float,
        Field(
            ge=0.01,
            le=100.0,
            description="with gain `plateau`: maximum share of pixels that a histogram bin of 0.05 K "
            "counts; 100 is full equalisation",
        ),
    ] = 0.5
    linear_share: Annotated[
        Share,
        Field(
            description="with gain `plateau`: share of the grey levels that is mapped linearly over the span"
        ),
    ] = 0.3
    blur_px: Annotated[
        float, Field(ge=0.0, le=20.0, description="standard deviation of the optical blur")
    ] = 0.7
    netd_k: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="standard deviation of the temporal noise, which is independent in every image",
        ),
    ] = 0.08
    fixed_pattern_k: Annotated[
        float,
        Field(ge=0.0, le=5.0, description="standard deviation of the fixed-pattern noise between pixels"),
    ] = 0.03
    dead_pixels: Annotated[Share, Field(description="share of dead pixels, which have a constant value")] = (
        0.0001
    )
    column_noise_k: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="standard deviation of the offsets between columns, which change at each shutter "
            "calibration",
        ),
    ] = 0.0
    vignetting_k: Annotated[
        float, Field(ge=0.0, le=10.0, description="apparent temperature excess in the image corners")
    ] = 0.0
    offset_drift_k_per_min: Annotated[
        float,
        Field(
            ge=0.0,
            le=20.0,
            description="standard deviation of the drift rate of the whole image after a calibration. "
            "Patches of the image drift at half of this rate, single pixels at a tenth",
        ),
    ] = 0.0
    shutter_every_s: Annotated[
        float,
        Field(
            ge=0.0,
            le=3600.0,
            description="time between shutter calibrations; 0 disables the shutter",
        ),
    ] = 0.0
    shutter_lasts_s: Annotated[
        float,
        Field(
            ge=0.0, le=5.0, description="duration of a shutter calibration, during which the image is frozen"
        ),
    ] = 0.4
    sharpening: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="amount of unsharp masking before the 8-bit conversion, which causes halos",
        ),
    ] = 0.0
    sharpening_px: Annotated[
        float, Field(gt=0.0, le=20.0, description="standard deviation of the blur in the unsharp mask")
    ] = 1.5
    coring_k: Annotated[
        float,
        Field(
            ge=0.0,
            le=5.0,
            description="coring threshold: smaller differences from the surroundings are smoothed as noise",
        ),
    ] = 0.0
    jpeg_quality: Annotated[
        int | None,
        Field(
            ge=1,
            le=100,
            description="JPEG quality of the 8-bit image; by default, no compression",
        ),
    ] = None

    def __post_init__(self) -> None:
        """Refuse an unknown gain, an empty span, and a shutter that never opens."""
        if self.gain not in get_args(GainName):
            known = ", ".join(get_args(GainName))
            raise BadInput(f"unknown gain {self.gain!r}; choose from {known}", key=("gain",))
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
        """Whether the gain is automatic or there is a shutter, so that an image depends on earlier ones."""
        return self.shutter_every_s > 0.0 or (self.gain != "fixed" and self.gain_follows_s > 0.0)

    @property
    def is_simple(self) -> bool:
        """Whether an image consists only of the scene, noise and a fixed gain."""
        changes = self.offset_drift_k_per_min, self.column_noise_k, self.shutter_every_s, self.sharpening
        has_changes = any(value > 0.0 for value in (*changes, self.coring_k))
        return self.gain == "fixed" and self.jpeg_quality is None and not has_changes

    @property
    def is_noisy(self) -> bool:
        """Whether each image has new noise."""
        return self.netd_k > 0.0

    def resized(self, width: int, height: int) -> Self:
        """Return the camera with another image size [px], the same vertical field of view and sharpness."""
        camera, larger = replace(self.camera, width=width, height=height), height / self.camera.height
        return replace(
            self,
            camera=camera,
            blur_px=self.blur_px * larger,
            sharpening_px=self.sharpening_px * larger,
        )

    def noisier(self, factor: float) -> Self:
        """Return the camera with temporal and fixed noise multiplied by a factor."""
        return replace(
            self,
            netd_k=factor * self.netd_k,
            fixed_pattern_k=factor * self.fixed_pattern_k,
            column_noise_k=factor * self.column_noise_k,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LightConfig(CameraConfig):
    """A camera for visible light, and its image formation."""

    exposure_s: Exposure = 0.015
    gain: Annotated[
        float,
        Field(
            gt=0.0,
            le=10.0,
            description="pixel value of a white surface that faces the light at full level, as a share "
            "of full scale",
        ),
    ] = 0.95
    read_noise: Annotated[
        Share, Field(description="noise of a black pixel: standard deviation, as a share of full scale")
    ] = 0.004
    shot_noise: Annotated[
        Share, Field(description="noise of a white pixel: standard deviation, as a share of full scale")
    ] = 0.012

    @property
    def is_noisy(self) -> bool:
        """Whether each image has new noise."""
        return self.read_noise > 0.0 or self.shot_noise > 0.0

    def noisier(self, factor: float) -> Self:
        """Return the camera with its noise multiplied by a factor."""
        return replace(self, read_noise=factor * self.read_noise, shot_noise=factor * self.shot_noise)


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourConfig(LightConfig):
    """A colour camera. Trackers use the one named `colour`."""

    kind: ClassVar[str] = "colour"

    camera: Pinhole = field(default_factory=_colour_camera)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaConfig(LightConfig):
    """A panoramic colour camera with a mirror above the robot's axis and an unrolled image."""

    kind: ClassVar[str] = "panorama"

    camera: Panorama = field(default_factory=Panorama)
    raw: Annotated[
        bool,
        Field(
            description="whether the image is unrolled from the round image of the lens, which is also "
            "stored. Such an image is coarse at steep angles. Otherwise, each pixel is rendered "
            "directly"
        ),
    ] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthConfig(LightConfig):
    """A depth camera that also provides colour through the same lens.

    Raises:
        BadInput: the sensor is unknown or has no amplitude, the scale is negative, or the range of depths is
            empty.
    """

    kind: ClassVar[str] = "depth"

    camera: Pinhole = field(default_factory=_depth_camera)
    sensor: Annotated[
        DepthSensorName,
        Field(
            description="measuring principle. `kinect` is structured light, with noise, quantised "
            "disparity, shadows, frayed edges and holes. `tof` is time of flight, with mixed "
            "depths at edges"
        ),
    ] = "kinect"
    scale: Annotated[
        float,
        Field(
            ge=0.0,
            le=100.0,
            description="factor on the depth noise. With 0, depth is exact, and only pixels beyond the "
            "range are empty",
        ),
    ] = 1.0
    nearest_m: Annotated[float, Field(ge=0.0, le=FARTHEST_M, description="minimum measurable depth")] = 0.5
    farthest_m: Annotated[float, Field(gt=0.0, le=FARTHEST_M, description="maximum measurable depth")] = 10.0
    colour: Annotated[
        bool, Field(description="whether the camera also provides colour, registered with the depth")
    ] = True
    amplitude: Annotated[
        bool,
        Field(
            description="with sensor `tof`: whether the camera also provides the amplitude of the "
            "returned light"
        ),
    ] = False
    offset_m: Annotated[
        float, Field(ge=0.0, le=0.1, description="maximum constant error of a pixel, the same in all images")
    ] = 0.0

    def __post_init__(self) -> None:
        """Refuse an unknown sensor, amplitude without `tof`, a negative scale, and an empty range."""
        if self.sensor not in get_args(DepthSensorName):
            known = ", ".join(get_args(DepthSensorName))
            raise BadInput(f"unknown sensor {self.sensor!r}; choose from {known}", key=("sensor",))
        if self.amplitude and self.sensor != "tof":
            raise BadInput(f"only sensor 'tof' has an amplitude, not {self.sensor!r}", key=("amplitude",))
        if not 0.0 <= self.scale < math.inf:
            raise BadInput(f"{self.scale} must be 0 or more, and finite", key=("scale",))
        if not 0.0 <= self.nearest_m < self.farthest_m <= FARTHEST_M:
            raise BadInput(
                f"{self.farthest_m} must be more than nearest_m, {self.nearest_m}, and at most {FARTHEST_M}",
                key=("farthest_m",),
            )

    @property
    def disparity_px_m(self) -> float:
        """Disparity [px] at a depth of 1 m, in pixels of the sensor, which has 480 rows."""
        return self.camera.focal_px * _DEPTH_ROWS / self.camera.height * DEPTH_BASELINE_M

    @property
    def is_noisy(self) -> bool:
        """Whether each depth image has new noise."""
        return self.scale > 0.0

    def noisier(self, factor: float) -> Self:
        """Return the camera with the noise of depth and colour multiplied by a factor."""
        brighter = LightConfig.noisier(self, factor)
        return replace(brighter, scale=factor * self.scale)


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserConfig(CameraConfig):
    """A laser range finder, whose scan is an image of one row.

    The light passes through glass.

    Raises:
        BadInput: the range is empty.
    """

    kind: ClassVar[str] = "laser"

    camera: ScanPlane = field(default_factory=ScanPlane)
    nearest_m: Annotated[float, Field(ge=0.0, le=FARTHEST_M, description="minimum measurable range")] = 0.05
    farthest_m: Annotated[float, Field(gt=0.0, le=FARTHEST_M, description="maximum measurable range")] = 10.0
    # SICK LMS 200 up to 8 m: 5 mm. Small scanners have two to three times as much.
    noise_m: Annotated[float, Field(ge=0.0, le=1.0, description="standard deviation of a range")] = 0.01

    def __post_init__(self) -> None:
        """Refuse an empty range."""
        if not 0.0 <= self.nearest_m < self.farthest_m <= FARTHEST_M:
            raise BadInput(
                f"{self.farthest_m} must be more than nearest_m, {self.nearest_m}, and at most {FARTHEST_M}",
                key=("farthest_m",),
            )

    @property
    def is_noisy(self) -> bool:
        """Whether each scan has new noise."""
        return self.noise_m > 0.0

    def resized(self, width: int, height: int) -> Self:  # noqa: ARG002
        """Return the range finder as it is, since its beams do not depend on the size of images."""
        return self

    def noisier(self, factor: float) -> Self:
        """Return the range finder with its noise multiplied by a factor."""
        return replace(self, noise_m=factor * self.noise_m)


def calibrations_of(cameras: Mapping[str, CameraConfig]) -> Mapping[str, Calibration]:
    """Return the calibration of each camera by its name, without cameras whose geometry has none."""
    found = {name: config.camera.calibration for name, config in cameras.items()}
    return {name: calibration for name, calibration in found.items() if calibration is not None}
