"""Depth cameras that there are, by name."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.geometry.pinhole import Pinhole

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
