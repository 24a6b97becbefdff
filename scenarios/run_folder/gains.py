"""What grey means in the 8-bit images of thermal cameras, in words for files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from peopleboy.sim.cameras.camera_config import CameraConfig, ThermalConfig

_KEYS: Mapping[str, tuple[str, ...]] = {
    "fixed": ("lowest_c", "highest_c"),
    "percentile": ("gain_follows_s", "tail_percent", "least_span_k"),
    "plateau": ("gain_follows_s", "tail_percent", "least_span_k", "plateau_percent", "linear_share"),
}


def about_gains(cameras: Mapping[str, CameraConfig]) -> dict[str, dict[str, Any]]:
    """Tell by which gain each thermal camera comes to its grey, and with which settings."""
    return {
        name: {"gain": config.gain} | {key: getattr(config, key) for key in _KEYS[config.gain]}
        for name, config in cameras.items()
        if isinstance(config, ThermalConfig)
    }


def thermal_span_c(config: ThermalConfig) -> list[float] | None:
    """Give the span [degC] of 8-bit images; None where it changes from image to image."""
    return [config.lowest_c, config.highest_c] if config.gain == "fixed" else None
