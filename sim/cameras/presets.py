"""Depth cameras that there are, by name."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from peopleboy.sim.cameras.camera_config import DepthConfig, ThermalConfig
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
