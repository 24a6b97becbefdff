"""Input of a tracker: the images of one instant, camera calibrations, and odometry."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.notebook import names_of, png_of

Floats = NDArray[np.float64]

THERMAL: Final = "thermal"
COLOUR: Final = "colour"
PANORAMA: Final = "panorama"
DEPTH: Final = "depth"
LASER: Final = "laser"
DEPTH_COLOUR: Final = "depth_colour"
DEPTH_AMPLITUDE: Final = "depth_amplitude"

FIRST_STEP_S: Final = 1 / 15
"""Time step of a tracker's first frame."""

# Motion beyond what the drive can do in a quarter of a second is a jump of the odometry.
FARTHEST_TURN_RAD: Final = math.radians(40.0)
FARTHEST_WAY_M: Final = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """Motion of the robot between two frames, in the robot frame of the first one.

    Attributes:
        advance_m: forward [m].
        aside_m: to the left [m].
        turn_rad: rotation, left positive [rad].

    Raises:
        BadInput: a value is not finite.
    """

    advance_m: float = 0.0
    aside_m: float = 0.0
    turn_rad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values that are not finite."""
        for name in (column.name for column in fields(self)):
            _check_finite(name, getattr(self, name))

    @classmethod
    def from_motion(cls, motion: Pose2) -> Self:
        """Make the motion from the pose after it, in the robot frame before it."""
        return cls(advance_m=motion.x, aside_m=motion.y, turn_rad=motion.heading)

    @classmethod
    def between(cls, before: Pose2, now: Pose2) -> Self | None:
        """Return the motion between two odometry poses; None for a jump that the wheels cannot make."""
        motion = now.relative_to(before)
        if abs(motion.heading) > FARTHEST_TURN_RAD or math.hypot(motion.x, motion.y) > FARTHEST_WAY_M:
            return None
        return cls.from_motion(motion)

    @property
    def motion(self) -> Pose2:
        """Pose of the robot after the motion, in the robot frame before it."""
        return Pose2(self.advance_m, self.aside_m, self.turn_rad)


class ReadOnlyImages(Mapping[str, NDArray[Any]]):
    """Images by camera as read-only views, which are neither copied nor rendered here."""

    __slots__ = ("_images",)

    def __init__(self, images: Mapping[str, NDArray[Any]]) -> None:
        self._images = images

    def __getitem__(self, camera: str) -> Any:
        if camera not in self._images:  # the message names the frame's other cameras
            raise KeyError(lacking(camera, self._images))
        image: object = self._images[camera]
        if not isinstance(image, np.ndarray):  # reported by the method that reads it
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


class SensorReadings(Protocol):
    """Sensor readings of one instant, such as an `Observation` of the simulated world."""

    @property
    def time_s(self) -> float:
        """Time of the readings [s]."""
        ...

    @property
    def images(self) -> Mapping[str, NDArray[Any]]:
        """Images by camera name."""
        ...

    @property
    def calibrations(self) -> Mapping[str, Calibration]:
        """Calibrations by camera name."""
        ...

    @property
    def odometry(self) -> Pose2:
        """Pose in the world by dead reckoning."""
        ...


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Frame:
    """Input of a tracker at one instant.

    Attributes:
        images: by camera name: `thermal`, (H, W) uint8 grey, linear over 24..36 degC by default; `colour`,
            (H, W, 3) uint8 RGB; `depth`, (H, W) uint16 along the optical axis [mm], 0 for no reading. Sizes
            may differ. A camera without an image at this instant is omitted. Images may be rendered on
            demand, and are read-only because they are shared.
        calibrations: of the cameras whose mount is known, by name; empty for footage.
        time_s: time at which the images were taken [s].
        odometry: motion of the robot since the last frame; None if unknown.

    Raises:
        BadInput: the time is not finite.
    """

    images: Mapping[str, NDArray[Any]]
    time_s: float
    calibrations: Mapping[str, Calibration] = field(default_factory=dict)
    odometry: Odometry | None = None

    def __post_init__(self) -> None:
        """Check the time, and make the images read-only; they are validated when read."""
        _check_finite("time_s", self.time_s)
        object.__setattr__(self, "images", ReadOnlyImages(self.images))

    def __repr__(self) -> str:
        """Show the time and the camera names; images may not have been rendered yet."""
        images, calibrated = names_of(self.images), names_of(self.calibrations)
        return f"Frame(time_s={self.time_s:.3f}, images: {images}; calibrations: {calibrated})"

    def _repr_png_(self) -> bytes | None:
        return png_of(self.images)

    @classmethod
    def from_image(cls, image: NDArray[Any], time_s: float, camera: str = THERMAL) -> Self:
        """Make a frame from one camera's image, without calibration, for example from your own footage."""
        return cls(images={camera: image}, time_s=time_s)

    @classmethod
    def from_observation(
        cls,
        observation: SensorReadings,
        before: Pose2 | None = None,
        calibrations: Mapping[str, Calibration] | None = None,
    ) -> Self:
        """Make the frame of an observation.

        Args:
            observation: sensor readings, such as `World.observe()` returns.
            before: `odometry` of the previous observation; None if there was none.
            calibrations: by camera; None for those of the observation.
        """
        return cls(
            images=observation.images,
            calibrations=observation.calibrations if calibrations is None else calibrations,
            time_s=observation.time_s,
            odometry=None if before is None else Odometry.between(before, observation.odometry),
        )

    def grey(self, camera: str) -> NDArray[np.uint8]:
        """Return the (H, W) grey image of a camera.

        Raises:
            BadInput: the image is missing, or has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W) uint8", image, 2)
        return image

    def rgb(self, camera: str) -> NDArray[np.uint8]:
        """Return the (H, W, 3) RGB image of a camera.

        Raises:
            BadInput: the image is missing, or has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W, 3) uint8", image, 3)
        return image

    def depth(self, camera: str) -> NDArray[np.uint16]:
        """Return the (H, W) depth image [mm] of a camera, along its optical axis; 0 for no reading.

        Raises:
            BadInput: the image is missing, or has another shape or type.
        """
        image = self._image(camera)
        _check_image(f"{camera} image must be (H, W) uint16", image, 2, np.uint16)
        return image

    def _image(self, camera: str) -> NDArray[Any]:
        if camera not in self.images:
            raise BadInput(lacking(camera, self.images))
        return self.images[camera]


def check_frame(frame: object) -> None:
    """Refuse anything that is not a frame, such as a bare image.

    Raises:
        BadInput: the object is not a frame; the message explains how to make one.
    """
    if not isinstance(frame, Frame):
        shape = f" {frame.shape} {frame.dtype}" if isinstance(frame, np.ndarray) else ""
        raise BadInput(
            f"update(frame) takes a Frame, got {type(frame).__name__}{shape}; "
            "make one with Frame.from_image(image, time_s) or Frame.from_observation(observation)"
        )


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


def lacking(camera: str, images: Mapping[str, Any]) -> str:
    """Return the message that a frame has no image of a camera."""
    return f"frame has no image of camera {camera!r}; it has {', '.join(images) or 'none'}"


# Which frames have a new image of a camera: it may be missing or repeated.


class FreshImages:
    """Detects new images of one camera.

    Args:
        camera: its name.
    """

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._last: NDArray[Any] | None = None
        self._way: Odometry | None = Odometry()

    def of(self, frame: Frame) -> Frame | None:
        """Return the frame with odometry since the camera's last image; None without a new image.

        An image equal to the last one is a repetition: camera noise never repeats.
        """
        self._way = joined(self._way, frame.odometry)
        image = frame.images.get(self._camera)
        if image is None or (self._last is not None and np.array_equal(image, self._last)):
            return None
        way, self._way, self._last = self._way, Odometry(), image
        return replace(frame, odometry=way)


def joined(first: Odometry | None, then: Odometry | None) -> Odometry | None:
    """Return the composition of two motions; None if either is unknown."""
    if first is None or then is None:
        return None
    return Odometry.from_motion(first.motion.compose(then.motion))


def time_step(time_s: float, last_s: float | None) -> float:
    """Return the time since a tracker's last frame [s]; `FIRST_STEP_S` for the first one, without `last_s`.

    Raises:
        BadInput: the time does not increase.
    """
    if last_s is None:
        return FIRST_STEP_S
    if time_s <= last_s:
        raise BadInput(f"time_s must go forward, got {time_s} after {last_s}")
    return time_s - last_s
