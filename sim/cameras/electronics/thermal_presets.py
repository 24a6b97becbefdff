"""Thermal cameras that there are, by name."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from peopleboy.sim.cameras.camera_config import ThermalConfig

# As sold for cars and drones: a microbolometer behind a shutter, with the gain that its maker sets.
_UNCOOLED: Final = ThermalConfig(
    gain="plateau",
    netd_k=0.06,
    fixed_pattern_k=0.03,
    column_noise_k=0.02,
    vignetting_k=0.3,
    offset_drift_k_per_min=0.2,
    shutter_every_s=30.0,
    shutter_lasts_s=0.4,
    sharpening=0.6,
)

THERMAL_PRESETS: Final[dict[str, ThermalConfig]] = {
    "uncooled": _UNCOOLED,
    # The same recorded by way of a cheap film.
    "uncooled_film": replace(_UNCOOLED, jpeg_quality=75),
}
