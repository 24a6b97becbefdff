"""What a tracker takes in: one instant of the robot's cameras and odometry."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Frame:
    """What the tracker sees at one instant.

    Attributes:
        thermal: (H, W) uint8 grey, linear over 24..36 degC by default.
        time_s: when both images were taken [s].
        colour: (H, W, 3) uint8 RGB, or None without a colour camera; its size may differ from the thermal
            one.
        turn_rad: how the robot turned since the last frame, left positive [rad]; None if unknown.
        advance_m: how far it drove forward since the last frame [m]; None if unknown.

    Raises:
        BadInput: an image of another shape or type, an empty one, or a number that is not finite.
    """

    thermal: NDArray[np.uint8]
    time_s: float
    colour: NDArray[np.uint8] | None = None
    turn_rad: float | None = None
    advance_m: float | None = None

    def __post_init__(self) -> None:
        _check_image("thermal image must be (H, W) uint8", self.thermal, 2)
        if self.colour is not None:
            _check_image("colour image must be (H, W, 3) uint8", self.colour, 3)
        for name in ("time_s", "turn_rad", "advance_m"):
            value = getattr(self, name)
            if value is not None and not math.isfinite(value):
                raise BadInput(f"{name} must be a finite number, got {value}")

    @property
    def height_px(self) -> int:
        """Rows of the thermal image."""
        return int(self.thermal.shape[0])

    @property
    def width_px(self) -> int:
        """Columns of the thermal image."""
        return int(self.thermal.shape[1])


def _check_image(rule: str, image: object, dimensions: int) -> None:
    if not isinstance(image, np.ndarray):
        raise BadInput(f"{rule}, got {type(image).__name__}")
    is_right_shape = image.ndim == dimensions and image.size > 0 and (dimensions == 2 or image.shape[2] == 3)
    if not is_right_shape or image.dtype != np.uint8:
        raise BadInput(f"{rule}, got {image.shape} {image.dtype}")
