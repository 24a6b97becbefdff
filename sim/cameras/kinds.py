"""Registry of camera kinds, the interface to the rest of the project."""

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
    LaserConfig,
    PanoramaConfig,
    ThermalConfig,
)
from peopleboy.sim.cameras.depth import show_amplitude, show_depth
from peopleboy.sim.cameras.imaging.electronics import show_scene
from peopleboy.sim.cameras.laser import show_scan
from peopleboy.sim.cameras.sensors import (
    ColourSensor,
    DepthSensor,
    Image,
    PanoramaSensor,
    RangeFinder,
    Sensor,
    ThermalSensor,
)
from peopleboy.sim.cameras.thermal import encode_16bit
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose, transform
from peopleboy.sim.observation import OnDemand
from peopleboy.sim.rendering.panoramic_renderer import PanoramicRenderer
from peopleboy.sim.rendering.renderer import PINHOLE_RENDERER, Renderer
from peopleboy.sim.rendering.scan_renderer import ScanRenderer

# Real depth cameras, by name.

_KINECT: Final = DepthConfig(camera=Pinhole(width=320, height=240, vertical_fov_rad=math.radians(43.0)))

DEPTH_PRESETS: Final[dict[str, DepthConfig]] = {
    "tof": DepthConfig(
        # Modelled on the SwissRanger SR4000 at 15 MHz.
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
    # Four times the noise: 7 cm at 3.5 m and 55 cm at 10 m, as early users reported for the Kinect.
    "kinect_rough": replace(_KINECT, scale=4.0),
}


# Real thermal cameras, by name.

# Like cameras for cars and drones: a microbolometer behind a shutter and a fast lens, whose electronics
# reduce temporal and spatial noise, replace dead pixels and sharpen the image. A low plateau and a slope
# limit prevent the gain from amplifying noise on walls.
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
    # The same, recorded as low-quality JPEG.
    "uncooled_film": replace(_UNCOOLED, jpeg_quality=75),
}


SCENE: Final = "_scene"
"""Suffix of a thermal camera's image for display to people."""

Stored = NDArray[np.uint8] | NDArray[np.uint16]


def _as_it_is(image: Image) -> Image:
    return image


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """One of the images of a camera per frame.

    Attributes:
        what: description of its content.
        suffix: suffix of its name, after the name of the camera.
        folder: suffix of the folder of its files, after the name of the camera.
        encode: lossless conversion for a PNG file: (H, W) of 8 or 16 bits, or (H, W, 3) RGB.
        show: conversion for display: (H, W) grey or (H, W, 3) RGB, of 8 bits.
        source: suffix of the image from which it is derived; None for a direct output of the sensor.
        make: function that derives it from that image.
    """

    what: str = "8-bit, as the robot sees it"
    suffix: str = ""
    folder: str = ""
    encode: Callable[[Image], Stored] = _as_it_is
    show: Callable[[Image], NDArray[np.uint8]] = _as_it_is
    source: str | None = None
    make: Callable[[Image], Image] = _as_it_is


def _thermal_images(config: ThermalConfig) -> tuple[Layer, ...]:
    """Return the layers of a thermal camera: the robot's grey, temperatures, and grey for display."""
    if config.gain == "fixed":
        what = f"8-bit, {config.lowest_c:g}..{config.highest_c:g} degC, as the robot sees it"
    else:
        what = f"8-bit, by automatic gain ({config.gain}), as the robot sees it"
    return (
        Layer(what=what),
        Layer(what="16-bit, hundredths of a kelvin", suffix="_c", folder="16", encode=encode_16bit),
        Layer(
            what="8-bit, for display: greys equalised over the whole scene, derived from the temperatures",
            suffix=SCENE,
            folder=SCENE,
            source="_c",
            make=show_scene,
        ),
    )


def _round_image(config: PanoramaConfig) -> tuple[Layer, ...]:
    what = "8-bit colour, the circular image from which the panorama is unrolled"
    return (Layer(what=what, suffix="_raw", folder="_raw"),) if config.raw else ()


def _beside_depth(config: DepthConfig) -> tuple[Layer, ...]:
    colour = Layer(what="8-bit colour, registered with the depth", suffix="_colour", folder="_colour")
    amplitude = Layer(
        what="16-bit, amplitude of the sensor's own light, 10000 for white 1 m away",
        suffix="_amplitude",
        folder="_amplitude",
        show=show_amplitude,
    )
    return (*((colour,) if config.colour else ()), *((amplitude,) if config.amplitude else ()))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraKind:
    """A kind of camera.

    Attributes:
        config: class of its settings, which defines its keys in scenario files.
        what: description of what it measures.
        presets: named settings that can replace the defaults.
        presets_are: description of the presets.
        sensor: opens a camera from settings, name and seed; the name also selects its noise streams.
        renderer: draws its view and the outlines for the truth's boxes; by default that of a pinhole.
        layers: its images; the first one, without suffixes, is the observation of controllers.
        more_layers: further images that depend on the settings.
        shown: suffix of the image for display to people.
        channels: channels of the first image: 1 for (H, W), 3 for (H, W, 3) RGB.
        dtype, unit: type and unit of the first image.
        has_boxes: whether bounding boxes of people make sense in it.
        senses_heat: whether it senses heat, which glass blocks; light passes through glass.
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
    senses_heat: bool = False


KINDS: Final[dict[str, CameraKind]] = {
    "thermal": CameraKind(
        config=ThermalConfig,
        what="thermal, with 8-bit images and 16-bit images in hundredths of a kelvin",
        presets=THERMAL_PRESETS,
        presets_are="`uncooled` has a plateau gain, sharpened edges, column noise, warm corners, drift "
        "and a shutter; `uncooled_film` adds JPEG compression",
        sensor=ThermalSensor,
        layers=(),
        more_layers=_thermal_images,
        shown=SCENE,
        senses_heat=True,
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
        what="360-degree colour",
        sensor=PanoramaSensor,
        renderer=PanoramicRenderer(),
        layers=(Layer(what="8-bit colour, 360 degrees, from the robot's back over left, front and right"),),
        more_layers=_round_image,
        channels=3,
    ),
    "depth": CameraKind(
        config=DepthConfig,
        what="depth and colour",
        presets=DEPTH_PRESETS,
        presets_are="`tof` is a 176x144 time-of-flight camera, pitched down by 12 degrees, with "
        "amplitude instead of colour; `kinect` has 320x240 pixels; `kinect_rough` is a `kinect` "
        "with four times the noise",
        sensor=DepthSensor,
        layers=(Layer(what="16-bit, depth in millimetres, 0 for no reading", show=show_depth),),
        more_layers=_beside_depth,
        dtype=np.uint16,
        unit="mm",
    ),
    "laser": CameraKind(
        config=LaserConfig,
        what="laser range finder, which scans a plane near the floor",
        sensor=RangeFinder,
        renderer=ScanRenderer(),
        layers=(
            Layer(
                what="16-bit, one row: range of each beam in millimetres from left to right, 0 for no "
                "reading",
                show=show_scan,
            ),
        ),
        dtype=np.uint16,
        unit="mm",
        has_boxes=False,
    ),
}


def configure_camera(given: Mapping[str, Any], control_hz: int) -> CameraConfig:
    """Return the settings of a camera: given values over those of its preset or its kind's defaults.

    Args:
        given: `kind`, optionally `preset`, and values by the keys of the settings and of the geometry.
        control_hz: [Hz] the control rate, which the camera's own must divide.

    Raises:
        BadInput: a value does not fit the others; with its key.
    """
    kind = KINDS[given["kind"]]
    usual = kind.presets[given["preset"]] if "preset" in given else kind.config()
    check_rate(given.get("rate_hz"), control_hz)
    return with_keys(replace(usual, camera=with_keys(usual.camera, given)), given)


def kind_of(config: CameraConfig) -> CameraKind:
    """Return the kind of a camera by its settings.

    Raises:
        BadInput: the kind is unknown.
    """
    if config.kind not in KINDS:
        raise BadInput(f"unknown camera kind {config.kind!r}; choose from {', '.join(KINDS)}")
    return KINDS[config.kind]


def flat_geometry(cameras: Mapping[str, CameraConfig], name: str) -> Pinhole:
    """Return the geometry of a camera whose image must be flat.

    Raises:
        BadInput: the camera is missing or is not a pinhole camera.
    """
    geometry = cameras[name].camera if name in cameras else None
    if not isinstance(geometry, Pinhole):
        raise BadInput(f"camera {name!r}: a pinhole camera of that name is required")
    return geometry


def layers_of(config: CameraConfig) -> tuple[Layer, ...]:
    """Return the layers of the images per frame of a camera with given settings."""
    kind = kind_of(config)
    return (*kind.layers, *kind.more_layers(config))


def shown_to_people(images: Mapping[str, Image], name: str, config: CameraConfig) -> NDArray[np.uint8]:
    """Return a camera's image for display to people: (H, W) grey or (H, W, 3) RGB, of 8 bits."""
    suffix = kind_of(config).shown
    layer = next(layer for layer in layers_of(config) if layer.suffix == suffix)
    return layer.show(images[f"{name}{suffix}"])


def name_images(name: str, config: CameraConfig, taken: Sequence[Image]) -> Mapping[str, Image]:
    """Return a sensor's images by name; derived images are computed on first access."""
    layers = {f"{name}{layer.suffix}": layer for layer in layers_of(config)}
    own = [image for image, layer in layers.items() if layer.source is None]
    given = dict(zip(own, taken, strict=True))
    return OnDemand(layers, lambda image: layers[image].make(given[f"{name}{layers[image].source}"]), given)


def image_names(name: str, config: CameraConfig) -> tuple[str, ...]:
    """Return the names of a camera's images, such as thermal and thermal_c."""
    return tuple(f"{name}{layer.suffix}" for layer in layers_of(config))


def image_folders(cameras: Mapping[str, CameraConfig]) -> Iterator[tuple[str, str, Layer]]:
    """Yield folder, name and layer of every image of the cameras."""
    for name, config in cameras.items():
        for layer in layers_of(config):
            yield f"{name}{layer.folder}", f"{name}{layer.suffix}", layer


def with_boxes(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the names of the cameras in whose images bounding boxes make sense."""
    return tuple(name for name, config in cameras.items() if kind_of(config).has_boxes)


def check_rate(rate_hz: int | None, control_hz: int) -> None:
    """Check that a camera's rate divides the control rate.

    Raises:
        BadInput: the rate does not divide the control rate; with the key rate_hz.
    """
    if rate_hz is not None and (rate_hz < 1 or control_hz % rate_hz):
        fits = [str(rate) for rate in range(1, control_hz + 1) if control_hz % rate == 0]
        raise BadInput(
            f"{rate_hz} must divide the control rate, {control_hz} Hz; choose from {', '.join(fits)}",
            key=("rate_hz",),
        )


def check_cameras(cameras: Mapping[str, CameraConfig]) -> None:
    """Check that cameras have unique names of images and folders, and that there is a thermal camera.

    Raises:
        BadInput: a name is invalid or taken, or there is no thermal camera.
    """
    if not isinstance(cameras.get("thermal"), ThermalConfig):
        raise BadInput("cameras: a camera with name and kind 'thermal' is required to count people")
    for name in cameras:
        if re.fullmatch("[a-z][a-z0-9_]{0,39}", name) is None:
            raise BadInput(f"camera {name!r}: invalid name; use small letters, digits and _, a letter first")
    folders, images = zip(*((folder, image) for folder, image, _ in image_folders(cameras)), strict=True)
    for names in (folders, images):
        for taken in (name for name in cameras if names.count(name) > 1):
            raise BadInput(f"camera {taken!r}: another camera has images of that name; choose another")


# Map from pixels of one camera to pixels of another, for objects at one depth.


def affine_between(thermal: Pinhole, colour: Pinhole, depth_m: float) -> Matrix:
    """Return the (2, 3) map of thermal pixels u, v, 1 to colour pixels, for objects at a depth.

    The depth is along the thermal camera's axis. The map is exact where the optical axes are parallel,
    as they are by default; otherwise it is the least-squares fit over the thermal image.

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
    # Least squares reduce to projections: columns and rows of a centred grid are orthogonal.
    middle, away = pixels.mean(axis=0), pixels - pixels.mean(axis=0)
    slopes = [(away[:, axis, None] * seen).sum(axis=0) / np.square(away[:, axis]).sum() for axis in (0, 1)]
    offset = seen.mean(axis=0) - slopes[0] * middle[0] - slopes[1] * middle[1]
    return np.stack([*slopes, offset], axis=1)


# Positions of thermal pixels in the colour image.

# [m] assumed distance of people, since a track has no depth
_TYPICAL_DEPTH_M: Final = 4.0


def colour_from_thermal(cameras: Mapping[str, CameraConfig]) -> Matrix:
    """Return the (2, 3) map of pixels of `thermal` to those of `colour`, for people at a typical distance.

    Raises:
        BadInput: a camera is missing or not a pinhole, or their fields of view do not overlap.
    """
    thermal, colour = (flat_geometry(cameras, name) for name in ("thermal", "colour"))
    return affine_between(thermal, colour, _TYPICAL_DEPTH_M)
