"""The kinds of cameras: all that the rest of the project asks of one."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.small_matrices import inverse
from peopleboy.settings import with_keys
from peopleboy.sim.cameras.camera_config import (
    CameraConfig,
    ColourConfig,
    DepthConfig,
    PanoramaConfig,
    ThermalConfig,
)
from peopleboy.sim.cameras.depth import show_amplitude, show_depth
from peopleboy.sim.cameras.imaging.electronics import show_scene
from peopleboy.sim.cameras.sensors import (
    ColourSensor,
    DepthSensor,
    Image,
    PanoramaSensor,
    Sensor,
    ThermalSensor,
)
from peopleboy.sim.cameras.thermal import encode_16bit
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose, transform
from peopleboy.sim.observation import OnDemand
from peopleboy.sim.rendering.panoramic_renderer import PanoramicRenderer
from peopleboy.sim.rendering.renderer import PINHOLE_RENDERER, Renderer

# Depth cameras that there are, by name.

_KINECT: Final = DepthConfig(camera=Pinhole(width=320, height=240, vertical_fov_rad=math.radians(43.0)))

DEPTH_PRESETS: Final[dict[str, DepthConfig]] = {
    "tof": DepthConfig(
        # After the SwissRanger SR4000 at 15 MHz.
        camera=Pinhole(
            width=176, height=144, vertical_fov_rad=math.radians(34.6), pitch_rad=math.radians(12.0)
        ),
        sensor="tof",
        nearest_m=0.3,
        farthest_m=10.0,
        colour=False,
        amplitude=True,
    ),
    "kinect": _KINECT,
    # Four times the noise: 7 cm at 3.5 m and 55 cm at 10 m, as coarse as early users found a Kinect.
    "kinect_rough": replace(_KINECT, scale=4.0),
}


# Thermal cameras that there are, by name.

# As sold for cars and drones: a microbolometer behind a shutter and a fast lens, whose electronics even out
# noise over time and in space, fill in dead pixels, and sharpen what is left, and with a gain that a low
# plateau and its largest slope keep from making noise of walls.
_UNCOOLED: Final = ThermalConfig(
    blur_px=0.8,
    gain="plateau",
    plateau_percent=0.1,
    linear_share=0.7,
    least_span_k=12.0,
    netd_k=0.03,
    fixed_pattern_k=0.015,
    dead_pixels=0.0,
    column_noise_k=0.01,
    vignetting_k=0.3,
    offset_drift_k_per_min=0.2,
    shutter_every_s=30.0,
    shutter_lasts_s=0.4,
    sharpening=1.8,
    coring_k=0.12,
)

THERMAL_PRESETS: Final[dict[str, ThermalConfig]] = {
    "uncooled": _UNCOOLED,
    # The same recorded by way of a cheap film.
    "uncooled_film": replace(_UNCOOLED, jpeg_quality=75),
}


SCENE: Final = "_scene"
"""Suffix of the image by which people are shown what a thermal camera sees."""

Stored = NDArray[np.uint8] | NDArray[np.uint16]


def _as_it_is(image: Image) -> Image:
    return image


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """One of the images that a camera gives at an instant.

    Attributes:
        what: it holds, in words.
        suffix: of its name, behind that of the camera.
        folder: suffix of the folder that its files lie in, behind the name of the camera.
        encode: gives what a PNG file can hold of it, without loss: (H, W) of 8 or 16 bits, or (H, W, 3) RGB.
        show: gives what people are shown of it: (H, W) grey or (H, W, 3) RGB, of 8 bits.
        source: suffix of the image that it is made from; None for one that the sensor gives itself.
        make: gives it from that.
    """

    what: str = "8-bit, as the robot sees it"
    suffix: str = ""
    folder: str = ""
    encode: Callable[[Image], Stored] = _as_it_is
    show: Callable[[Image], NDArray[np.uint8]] = _as_it_is
    source: str | None = None
    make: Callable[[Image], Image] = _as_it_is


def _thermal_images(config: ThermalConfig) -> tuple[Layer, ...]:
    """Grey as the robot sees it; temperatures; and a grey for people, made when a person asks for it."""
    if config.gain == "fixed":
        what = f"8-bit, {config.lowest_c:g}..{config.highest_c:g} degC, as the robot sees it"
    else:
        what = f"8-bit, by automatic gain ({config.gain}), as the robot sees it"
    return (
        Layer(what=what),
        Layer(what="16-bit, hundredths of a kelvin", suffix="_c", folder="16", encode=encode_16bit),
        Layer(
            what="8-bit, greys shared out so that people see the whole scene, made from the temperatures",
            suffix=SCENE,
            folder=SCENE,
            source="_c",
            make=show_scene,
        ),
    )


def _round_image(config: PanoramaConfig) -> tuple[Layer, ...]:
    what = "8-bit colour, the round image that a panorama is unrolled from"
    return (Layer(what=what, suffix="_raw", folder="_raw"),) if config.raw else ()


def _beside_depth(config: DepthConfig) -> tuple[Layer, ...]:
    colour = Layer(what="8-bit colour, of the same pixels as the depth", suffix="_colour", folder="_colour")
    amplitude = Layer(
        what="16-bit, strength of the sensor's own light, 10000 for white 1 m away",
        suffix="_amplitude",
        folder="_amplitude",
        show=show_amplitude,
    )
    return (*((colour,) if config.colour else ()), *((amplitude,) if config.amplitude else ()))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraKind:
    """A kind of camera.

    Attributes:
        config: class of its settings, from which its keys in scenario files come.
        what: it sees, in words.
        presets: settings by name that may stand in for the usual ones.
        presets_are: what each of them is like.
        sensor: opens a camera by settings, name and seed; the name is that of its streams of noise, too.
        renderer: draws what it sees, and outlines the boxes of the truth; by default that of a pinhole.
        layers: its images; the first of all, without suffixes, is what controllers are shown.
        more_layers: what cameras of some settings give besides.
        shown: suffix of the image that people are shown.
        channels: of that first image: 1 for (H, W), 3 for (H, W, 3) RGB.
        dtype, unit: of that first image.
        has_boxes: whether a box round a person makes sense in it.
    """

    config: type[CameraConfig]
    what: str = ""
    presets: Mapping[str, CameraConfig] = field(default_factory=dict)
    presets_are: str = ""
    sensor: Callable[[Any, str, int], Sensor]
    renderer: Renderer = PINHOLE_RENDERER
    layers: tuple[Layer, ...] = (Layer(),)
    more_layers: Callable[[Any], tuple[Layer, ...]] = lambda config: ()  # noqa: ARG005
    shown: str = ""
    channels: int = 1
    dtype: type[np.unsignedinteger[Any]] = np.uint8
    unit: str = "grey"
    has_boxes: bool = True


KINDS: Final[dict[str, CameraKind]] = {
    "thermal": CameraKind(
        config=ThermalConfig,
        what="temperature, in 8 bits and in hundredths of a kelvin",
        presets=THERMAL_PRESETS,
        presets_are="`uncooled`, with a plateau gain, sharpened edges, columns, warm corners, drift and a "
        "shutter; `uncooled_film`, that by way of JPEG",
        sensor=ThermalSensor,
        layers=(),
        more_layers=_thermal_images,
        shown=SCENE,
    ),
    "colour": CameraKind(
        config=ColourConfig,
        what="colour",
        sensor=ColourSensor,
        layers=(Layer(what="8-bit colour"),),
        channels=3,
    ),
    "panorama": CameraKind(
        config=PanoramaConfig,
        what="colour, 360 degrees",
        sensor=PanoramaSensor,
        renderer=PanoramicRenderer(),
        layers=(Layer(what="8-bit colour all round, from the robot's back by its left, front and right"),),
        more_layers=_round_image,
        channels=3,
    ),
    "depth": CameraKind(
        config=DepthConfig,
        what="depth and colour",
        presets=DEPTH_PRESETS,
        presets_are="`tof`, 176x144 by time of flight, pitched down by 12 degrees, with amplitude instead of "
        "colour; `kinect`, 320x240; `kinect_rough`, that with four times the noise",
        sensor=DepthSensor,
        layers=(Layer(what="16-bit, depth in millimetres, 0 where none is read", show=show_depth),),
        more_layers=_beside_depth,
        dtype=np.uint16,
        unit="mm",
    ),
}


def configure_camera(given: Mapping[str, Any], control_hz: int) -> CameraConfig:
    """Return the settings of a camera: those of its preset or usual for its kind, but for what is given.

    Args:
        given: `kind`, and perhaps `preset`; values by the keys of the settings and of the geometry.
        control_hz: [Hz] the control rate, which the camera's own must divide.

    Raises:
        BadInput: with the key of a value that does not fit the others.
    """
    kind = KINDS[given["kind"]]
    usual = kind.presets[given["preset"]] if "preset" in given else kind.config()
    check_rate(given.get("rate_hz"), control_hz)
    return with_keys(replace(usual, camera=with_keys(usual.camera, given)), given)


def kind_of(config: CameraConfig) -> CameraKind:
    """Find the kind of a camera by its settings.

    Raises:
        BadInput: there is none of that name.
    """
    if config.kind not in KINDS:
        raise BadInput(f"camera kind {config.kind!r}: there is none; choose from {', '.join(KINDS)}")
    return KINDS[config.kind]


def flat_geometry(cameras: Mapping[str, CameraConfig], name: str) -> Pinhole:
    """Return the geometry of a camera whose image must be flat.

    Raises:
        BadInput: there is none of that name, or it is no pinhole camera.
    """
    geometry = cameras[name].camera if name in cameras else None
    if not isinstance(geometry, Pinhole):
        raise BadInput(f"camera {name!r}: there must be one of that name, with the image of a pinhole")
    return geometry


def layers_of(config: CameraConfig) -> tuple[Layer, ...]:
    """Return which images a camera of these settings gives at an instant."""
    kind = kind_of(config)
    return (*kind.layers, *kind.more_layers(config))


def shown_to_people(images: Mapping[str, Image], name: str, config: CameraConfig) -> NDArray[np.uint8]:
    """Return what people are shown of a camera's images: (H, W) grey or (H, W, 3) RGB, of 8 bits."""
    suffix = kind_of(config).shown
    layer = next(layer for layer in layers_of(config) if layer.suffix == suffix)
    return layer.show(images[f"{name}{suffix}"])


def name_images(name: str, config: CameraConfig, taken: Sequence[Image]) -> Mapping[str, Image]:
    """Name the images that a sensor gives, and beside them those made from them when first asked for."""
    layers = {f"{name}{layer.suffix}": layer for layer in layers_of(config)}
    own = [image for image, layer in layers.items() if layer.source is None]
    given = dict(zip(own, taken, strict=True))
    return OnDemand(layers, lambda image: layers[image].make(given[f"{name}{layers[image].source}"]), given)


def image_names(name: str, config: CameraConfig) -> tuple[str, ...]:
    """Name the images that a camera gives, such as thermal and thermal_c."""
    return tuple(f"{name}{layer.suffix}" for layer in layers_of(config))


def image_folders(cameras: Mapping[str, CameraConfig]) -> Iterator[tuple[str, str, Layer]]:
    """Yield folder, name and layer of every image that cameras give."""
    for name, config in cameras.items():
        for layer in layers_of(config):
            yield f"{name}{layer.folder}", f"{name}{layer.suffix}", layer


def with_boxes(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Name the cameras in whose images boxes make sense."""
    return tuple(name for name, config in cameras.items() if kind_of(config).has_boxes)


def check_rate(rate_hz: int | None, control_hz: int) -> None:
    """Refuse a camera's rate that does not divide the control rate.

    Raises:
        BadInput: about the key rate_hz.
    """
    if rate_hz is not None and (rate_hz < 1 or control_hz % rate_hz):
        fits = [str(rate) for rate in range(1, control_hz + 1) if control_hz % rate == 0]
        raise BadInput(
            f"{rate_hz} must divide the control rate, {control_hz} Hz; choose from {', '.join(fits)}",
            key=("rate_hz",),
        )


def check_cameras(cameras: Mapping[str, CameraConfig]) -> None:
    """Refuse cameras that are not distinguished by the names of their images and folders.

    Raises:
        BadInput: a name is none or taken, or there is no thermal camera.
    """
    if not isinstance(cameras.get("thermal"), ThermalConfig):
        raise BadInput("cameras: there must be one of the name and kind 'thermal', by which people count")
    for name in cameras:
        if re.fullmatch("[a-z][a-z0-9_]{0,39}", name) is None:
            raise BadInput(f"camera {name!r}: is not a name: use small letters, digits and _, a letter first")
    folders, images = zip(*((folder, image) for folder, image, _ in image_folders(cameras)), strict=True)
    for names in (folders, images):
        for taken in (name for name in cameras if names.count(name) > 1):
            raise BadInput(f"camera {taken!r}: another camera gives images of that name; choose another")


# From pixels of one camera to pixels of the other, for things at one depth.


def affine_between(thermal: Pinhole, colour: Pinhole, depth_m: float) -> Matrix:
    """Find the (2, 3) map of thermal pixels u, v, 1 to colour pixels, for things at a depth.

    The depth is that along the thermal camera's axis. The map is exact where the optical axes are parallel,
    as they are by default; where they are not, it is the best fit, in least squares, over the thermal image.

    Source: thesis, equation 6.1, which fixes the map by hand; here it follows from the cameras.

    Raises:
        BadInput: the depth is not positive, or the colour camera does not see the plane.
    """
    if not depth_m > 0.0:
        raise BadInput(f"depth {depth_m} m must be positive")
    columns, rows = np.linspace(0.0, thermal.width - 1.0, 9), np.linspace(0.0, thermal.height - 1.0, 9)
    u, v = (grid.ravel() for grid in np.meshgrid(columns, rows))
    pixels = np.stack([u, v, np.ones_like(u)], axis=1)
    points = depth_m * pixels @ inverse(thermal.intrinsics).T
    colour_from_thermal = invert_pose(colour.robot_from_camera) @ thermal.robot_from_camera
    seen = colour.project(transform(colour_from_thermal, points))
    if not np.isfinite(seen).all():
        raise BadInput(f"the colour camera does not see the plane {depth_m} m before the thermal camera")
    # Least squares, as projections: columns and rows of a grid about its middle are orthogonal.
    middle, away = pixels.mean(axis=0), pixels - pixels.mean(axis=0)
    slopes = [(away[:, axis, None] * seen).sum(axis=0) / np.square(away[:, axis]).sum() for axis in (0, 1)]
    offset = seen.mean(axis=0) - slopes[0] * middle[0] - slopes[1] * middle[1]
    return np.stack([*slopes, offset], axis=1)


# Where things of the thermal image are in the colour image.

# A track has no depth: its box is mapped as if the person were so far away.
_TYPICAL_DEPTH_M: Final = 4.0


def colour_from_thermal(cameras: Mapping[str, CameraConfig]) -> Matrix:
    """Find the (2, 3) map of pixels of `thermal` to those of `colour`, for people at a typical distance.

    Raises:
        BadInput: one is missing or not flat, or the colour camera does not see what the thermal one sees.
    """
    thermal, colour = (flat_geometry(cameras, name) for name in ("thermal", "colour"))
    return affine_between(thermal, colour, _TYPICAL_DEPTH_M)
