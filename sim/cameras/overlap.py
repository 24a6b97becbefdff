"""Where things of the thermal image are in the colour image."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.geometry.alignment import affine_between
from peopleboy.sim.geometry.pinhole import Matrix

# A track has no depth: its box is mapped as if the person were so far away.
_TYPICAL_DEPTH_M: Final = 4.0


def colour_from_thermal(cameras: Mapping[str, CameraConfig]) -> Matrix:
    """Find the (2, 3) map of pixels of `thermal` to those of `colour`, for people at a typical distance.

    Raises:
        BadInput: one is missing or not flat, or the colour camera does not see what the thermal one sees.
    """
    thermal, colour = (flat_geometry(cameras, name) for name in ("thermal", "colour"))
    return affine_between(thermal, colour, _TYPICAL_DEPTH_M)
