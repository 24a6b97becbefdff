"""Properties that distinguish panoramic cameras: image size, height, and vertical angles of the rows."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PanoramaCalibration

_SAME_M, _SAME_DEG = 0.01, 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaView:
    """A panoramic camera for which a network was trained; the network fits no other angles.

    Attributes:
        width_px, height_px: size of the unrolled image.
        centre_m: height of the optical centre above the floor, the lowest and the highest [m].
        depression_deg: angles below the horizon of the top, the middle and the bottom row [deg].
    """

    width_px: int
    height_px: int
    centre_m: tuple[float, float]
    depression_deg: tuple[float, float, float]

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> "PanoramaView":
        """Make a view from plain data, as written by `asdict` and JSON."""
        tuples = {name: tuple(plain[name]) for name in ("centre_m", "depression_deg")}
        return cls(**{**plain, **tuples})

    def refusal(self, other: "PanoramaView") -> str:
        """Return why a network for this camera does not fit another one; empty if it fits."""
        if (self.width_px, self.height_px) != (other.width_px, other.height_px):
            return f"panorama is {other.size}, but the network was trained on {self.size}"
        appearance = np.subtract(self.depression_deg, other.depression_deg)
        is_low = other.centre_m[0] < self.centre_m[0] - _SAME_M
        is_high = other.centre_m[1] > self.centre_m[1] + _SAME_M
        if is_low or is_high or np.any(np.abs(appearance) > _SAME_DEG):
            return f"panorama is of a mirror {other.mirror}, but the network was trained on one {self.mirror}"
        return ""

    @property
    def size(self) -> str:
        """Width and height as text."""
        return f"{self.width_px}x{self.height_px}"

    @property
    def mirror(self) -> str:
        """Angles and height as text."""
        top, _, bottom = self.depression_deg
        low, high = self.centre_m
        height = f"{low:.2f}" if low == high else f"{low:.2f} to {high:.2f}"
        return f"at {height} m that looks {top:.1f} to {bottom:.1f} deg down"


def view_of(calibration: Calibration, width_px: int, height_px: int) -> PanoramaView:
    """Return the view of a camera from its calibration and image size."""
    rows = np.array([0.0, (height_px - 1) / 2.0, height_px - 1.0])
    column = np.full(3, (width_px - 1) / 2.0)
    x, y, z = calibration.rays(np.stack([column, rows], axis=1)).T
    height_m = round(calibration.position_m[2], 4)
    top, middle, bottom = np.round(np.degrees(np.arctan2(-z, np.hypot(x, y))), 3).tolist()
    return PanoramaView(
        width_px=width_px,
        height_px=height_px,
        centre_m=(height_m, height_m),
        depression_deg=(top, middle, bottom),
    )


def view_over(calibrations: Sequence[PanoramaCalibration]) -> PanoramaView:
    """Return the view of cameras that differ only in their heights."""
    views = [view_of(camera, camera.width, camera.height) for camera in calibrations]
    lowest, highest = min(view.centre_m[0] for view in views), max(view.centre_m[1] for view in views)
    return replace(views[0], centre_m=(lowest, highest))


def choose_view(
    trained: Sequence[PanoramaView], size: tuple[int, int], calibration: Calibration | None
) -> int:
    """Return which of the views matches a camera, by image (height, width) and calibration.

    Without a calibration the first view of that size is returned.

    Raises:
        BadInput: none matches; no network was trained for this camera.
    """
    height, width = size
    whys = []
    for number, view in enumerate(trained):
        if calibration is None:
            seen = replace(view, width_px=width, height_px=height)
        else:
            seen = view_of(calibration, width, height)
        why = view.refusal(seen)
        if not why:
            return number
        whys.append(why)
    others = f" (and so for {len(whys) - 1} more)" if len(whys) > 1 else ""
    raise BadInput(f"{whys[0]}{others}; train another with `peopleboy train distance`")


# The views for which networks are trained: that of the default mirror, and one for all other panoramas.

PanoramaName = Literal["mirror", "all-round"]
ALL_ROUND_M: Final = (0.5, 2.0)
"""Heights of the camera above the floor, the lowest and the highest, for which networks were trained [m]."""
_LOWEST_DEG, _HIGHEST_DEG = 50.0, -15.0  # below the horizon
_WIDTH_PX, _HEIGHT_PX = 480, 180


def all_round(height_m: float) -> PanoramaCalibration:
    """Return the calibration of the view from 50 degrees below to 15 degrees above the horizon.

    Args:
        height_m: of the camera above the floor [m].
    """
    angle = math.radians(_LOWEST_DEG - _HIGHEST_DEG)
    return PanoramaCalibration(
        width=_WIDTH_PX,
        height=_HEIGHT_PX,
        focal_px=_HEIGHT_PX / math.tan(angle),
        axis_rad=math.radians(_LOWEST_DEG),
        ring_radius_m=0.0,
        ring_height_m=height_m,
    )
