"""What a tracker takes in: one instant of the robot's cameras, how they sit, and its odometry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.geometry.small_matrices import inverse

Floats = NDArray[np.float64]

THERMAL: Final = "thermal"
COLOUR: Final = "colour"
PANORAMA: Final = "panorama"
DEPTH: Final = "depth"
DEPTH_COLOUR: Final = "depth_colour"
DEPTH_AMPLITUDE: Final = "depth_amplitude"


class Calibration(Protocol):
    """What a tracker must know of a camera to tell metres from pixels.

    The robot's frame is x forward, y left, z up, with z = 0 on the floor [m]; pixels are u right, v down from
    the middle of the first one.
    """

    @property
    def position_m(self) -> tuple[float, float, float]:
        """Optical centre in the robot's frame [m]."""
        ...

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2); NaN where the camera cannot see them."""
        ...

    def rays(self, pixels: Floats) -> Floats:
        """Return the directions (N, 3) in the robot's frame in which pixels (N, 2) look, of any length."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class PinholeCalibration:
    """Calibration of a camera whose image is flat and free of distortion.

    Attributes:
        intrinsics: (3, 3) [px] camera matrix.
        robot_from_camera: (4, 4) pose of the optical frame, x right, y down, z forward, in the robot's.

    Raises:
        BadInput: a matrix of another shape, or with a number that is not finite.
    """

    intrinsics: Floats
    robot_from_camera: Floats
    _robot_from_pixel: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Refuse what is no calibration."""
        for name, shape in (("intrinsics", (3, 3)), ("robot_from_camera", (4, 4))):
            matrix = getattr(self, name)
            if np.shape(matrix) != shape or not np.isfinite(matrix).all():
                raise BadInput(f"calibration: {name} must be {shape} and finite, got {np.shape(matrix)}")
        unprojected = self.robot_from_camera[:3, :3] @ inverse(self.intrinsics)
        object.__setattr__(self, "_robot_from_pixel", unprojected)

    @property
    def position_m(self) -> tuple[float, float, float]:
        """Optical centre in the robot's frame [m]."""
        x, y, z = self.robot_from_camera[:3, 3].tolist()
        return x, y, z

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2); NaN for those behind the camera."""
        rotation, origin = self.robot_from_camera[:3, :3], self.robot_from_camera[:3, 3]
        seen = (points_m - origin) @ rotation @ self.intrinsics.T
        depth = np.where(seen[:, 2:] > 1e-9, seen[:, 2:], np.nan)
        return np.asarray(seen[:, :2] / depth, np.float64)

    def rays(self, pixels: Floats) -> Floats:
        """Return the directions (N, 3) in the robot's frame in which pixels (N, 2) look; their depth is 1."""
        columns = self._robot_from_pixel.T
        return np.asarray(pixels @ columns[:2] + columns[2], np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """How the robot moved from one frame to the next, in its own frame at the first of them.

    Attributes:
        advance_m: forward [m].
        aside_m: to the left [m].
        turn_rad: how it turned, left positive [rad].

    Raises:
        BadInput: a number that is not finite.
    """

    advance_m: float = 0.0
    aside_m: float = 0.0
    turn_rad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no robot does."""
        for name in (column.name for column in fields(self)):
            _check_finite(name, getattr(self, name))

    @classmethod
    def from_motion(cls, motion: Pose2) -> Self:
        """Take the pose after a movement, in the robot's frame before it."""
        return cls(advance_m=motion.x, aside_m=motion.y, turn_rad=motion.heading)

    @property
    def motion(self) -> Pose2:
        """Pose of the robot after the movement, in its frame before it."""
        return Pose2(self.advance_m, self.aside_m, self.turn_rad)


class ReadOnlyImages(Mapping[str, NDArray[Any]]):
    """Images by camera, each through a view that refuses to be written to; none is copied or made here."""

    __slots__ = ("_images",)

    def __init__(self, images: Mapping[str, NDArray[Any]]) -> None:
        self._images = images

    def __getitem__(self, camera: str) -> Any:
        if camera not in self._images:  # reported in full, as cameras may be slower than frames
            raise KeyError(_lacking(camera, self._images))
        image: object = self._images[camera]
        if not isinstance(image, np.ndarray):  # its reader reports that
            return image
        view = image.view()
        view.setflags(write=False)
        return view

    def __contains__(self, camera: object) -> bool:
        return camera in self._images

    def __iter__(self) -> Iterator[str]:
        return iter(self._images)

    def __len__(self) -> int:
        return len(self._images)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Frame:
    """What the tracker sees at one instant.

    Attributes:
        images: by the camera's name, such as `thermal`, (H, W) uint8 grey, linear over 24..36 degC by
            default, `colour`, (H, W, 3) uint8 RGB, and `depth`, (H, W) uint16 along the optical axis [mm],
            0 where none is read; their sizes may differ. A camera that takes no image at this instant is
            left out. An image may be made only when it is asked for, and none can be written to, as others
            see it too.
        calibrations: of those cameras whose place on the robot is known, by name; none for footage.
        time_s: when the images were taken [s].
        odometry: how the robot moved since the last frame; None if unknown.

    Raises:
        BadInput: a time that is not finite.
    """

    images: Mapping[str, NDArray[Any]]
    time_s: float
    calibrations: Mapping[str, Calibration] = field(default_factory=dict)
    odometry: Odometry | None = None

    def __post_init__(self) -> None:
        """Refuse a time that is none, and guard the images, which are checked when they are read."""
        _check_finite("time_s", self.time_s)
        object.__setattr__(self, "images", ReadOnlyImages(self.images))

    def grey(self, camera: str) -> NDArray[np.uint8]:
        """Read the (H, W) grey image of a camera.

        Raises:
            BadInput: there is none, or it has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W) uint8", image, 2)
        return image

    def rgb(self, camera: str) -> NDArray[np.uint8]:
        """Read the (H, W, 3) RGB image of a camera.

        Raises:
            BadInput: there is none, or it has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W, 3) uint8", image, 3)
        return image

    def depth(self, camera: str) -> NDArray[np.uint16]:
        """Read the (H, W) depth image [mm] of a camera, along its optical axis; 0 where none is read.

        Raises:
            BadInput: there is none, or it has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W) uint16", image, 2, np.uint16)
        return image

    def _image(self, camera: str) -> NDArray[Any]:
        if camera not in self.images:
            raise BadInput(_lacking(camera, self.images))
        return self.images[camera]


def _check_finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise BadInput(f"{name} must be a finite number, got {value}")


def _check_image(
    rule: str, image: object, dimensions: int, dtype: type[np.unsignedinteger[Any]] = np.uint8
) -> None:
    if not isinstance(image, np.ndarray):
        raise BadInput(f"{rule}, got {type(image).__name__}")
    is_right_shape = image.ndim == dimensions and image.size > 0 and (dimensions == 2 or image.shape[2] == 3)
    if not is_right_shape or image.dtype != dtype:
        raise BadInput(f"{rule}, got {image.shape} {image.dtype}")


def _lacking(camera: str, images: Mapping[str, Any]) -> str:
    return f"frame has no image of camera {camera!r}; it has {', '.join(images) or 'none'}"


# Which frames have a new image of a camera: it may be missing, or stand still.


class FreshImages:
    """Watches one camera.

    Args:
        camera: its name.
    """

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._last: NDArray[Any] | None = None
        self._way: Odometry | None = Odometry()

    def of(self, frame: Frame) -> Frame | None:
        """Return a frame whose odometry counts from the camera's last image on; None without a new image.

        An image equal to the last one is no new one: the noise of a camera never repeats.
        """
        self._way = joined(self._way, frame.odometry)
        image = frame.images.get(self._camera)
        if image is None or (self._last is not None and np.array_equal(image, self._last)):
            return None
        way, self._way, self._last = self._way, Odometry(), image
        return replace(frame, odometry=way)


def joined(first: Odometry | None, then: Odometry | None) -> Odometry | None:
    """Return the motion that two after each other make; None if one is unknown."""
    if first is None or then is None:
        return None
    return Odometry.from_motion(first.motion.compose(then.motion))
