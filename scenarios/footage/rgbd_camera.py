"""Pose and field of view of a recorded RGB-D camera."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Final

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Pinhole

VERTICAL_FOV_DEG: Final = 43.0
"""Of the sensor that the tracker was made for."""
STEEPEST_DEG: Final = 60.0
LEVEL_DEG: Final = 10.0
"""Up to this tilt the tracker's boxes and places are right: it is made for a camera that looks ahead."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdCamera:
    """A camera without distortion, whose principal point is the middle of the image.

    Raises:
        BadInput: both are given, or a number of no camera.
    """

    height_m: Annotated[
        float, Field(alias="camera_height_m", description="Height of the depth camera above the floor.")
    ] = 1.2
    pitch_deg: Annotated[float, Field(description="Tilt of the depth camera; positive looks down.")] = 0.0
    focal_px: Annotated[float | None, Field(description="Focal length of its pictures; or the next.")] = None
    vertical_fov_deg: Annotated[
        float | None, Field(description="From top to bottom of its pictures.  [default: 43]")
    ] = None

    def __post_init__(self) -> None:
        """Refuse what is no camera."""
        if self.focal_px is not None and self.vertical_fov_deg is not None:
            raise BadInput("--focal-px and --vertical-fov-deg say the same; give one")
        _check("--camera-height-m", self.height_m, 0.0, 10.0)
        _check("--pitch-deg", self.pitch_deg, -STEEPEST_DEG, STEEPEST_DEG)
        _check("--focal-px", self.focal_px, 0.0, 1e5)
        _check("--vertical-fov-deg", self.vertical_fov_deg, 0.0, 170.0)

    @property
    def notes(self) -> list[str]:
        """What the tracker cannot make good."""
        if abs(self.pitch_deg) <= LEVEL_DEG:
            return []
        return [
            f"beyond {LEVEL_DEG:g} degrees of pitch boxes and places are off: the camera should look ahead"
        ]

    def geometry(self, width: int, height: int) -> Pinhole:
        """Return its geometry for pictures of a size [px]; x and y begin below its lens."""
        return Pinhole(
            width=width,
            height=height,
            vertical_fov_rad=self._angle_rad(height),
            position_m=(0.0, 0.0, self.height_m),
            pitch_rad=math.radians(self.pitch_deg),
        )

    def _angle_rad(self, height: int) -> float:
        if self.focal_px is not None:
            return 2.0 * math.atan(height / 2.0 / self.focal_px)
        return math.radians(VERTICAL_FOV_DEG if self.vertical_fov_deg is None else self.vertical_fov_deg)


def _check(option: str, value: float | None, low: float, high: float) -> None:
    if value is not None and not low < value < high:
        raise BadInput(f"{option} must be between {low:g} and {high:g}, got {value:g}")
