"""What a tracker takes in: one instant of the robot's cameras and odometry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.calibration import Calibration

THERMAL: Final = "thermal"
COLOUR: Final = "colour"


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


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Frame:
    """What the tracker sees at one instant.

    Attributes:
        images: by the camera's name, such as `thermal`, (H, W) uint8 grey, linear over 24..36 degC by
            default, and `colour`, (H, W, 3) uint8 RGB; their sizes may differ. A camera that takes no image
            at this instant is left out. An image may be made only when it is asked for.
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
        """Refuse a time that is none; images are checked when they are read."""
        _check_finite("time_s", self.time_s)

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

    def _image(self, camera: str) -> NDArray[Any]:
        if camera not in self.images:
            raise BadInput(
                f"frame has no image of camera {camera!r}; it has {', '.join(self.images) or 'none'}"
            )
        return self.images[camera]


def _check_finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise BadInput(f"{name} must be a finite number, got {value}")


def _check_image(rule: str, image: object, dimensions: int) -> None:
    if not isinstance(image, np.ndarray):
        raise BadInput(f"{rule}, got {type(image).__name__}")
    is_right_shape = image.ndim == dimensions and image.size > 0 and (dimensions == 2 or image.shape[2] == 3)
    if not is_right_shape or image.dtype != np.uint8:
        raise BadInput(f"{rule}, got {image.shape} {image.dtype}")
