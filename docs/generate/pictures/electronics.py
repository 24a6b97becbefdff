"""What a thermal camera's electronics do to one scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from docs.generate.pictures.moments import world_at
from docs.generate.pictures.paper import panels, show
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.electronics.drift import Drift
from peopleboy.sim.cameras.electronics.eye import show_scene
from peopleboy.sim.cameras.electronics.finish import compress, sharpen
from peopleboy.sim.cameras.electronics.gain import Gain
from peopleboy.sim.cameras.thermal import detect, make_detector, surface_image
from peopleboy.sim.random_streams import stream

_USUAL = ThermalConfig(netd_k=0.03, fixed_pattern_k=0.02)  # noise takes most of a picture's bytes
_PLATEAU = replace(_USUAL, gain="plateau")
_DRIFT_S = 60.0
_STEP = 8  # of greys, so that files are small

Grey = NDArray[np.uint8]


def gains() -> Figure:
    """One scene by each gain, and as people are shown it."""
    titles = ("gain: fixed, 24..36 °C", "gain: percentile", "gain: plateau", "thermal_scene, for people")
    figure, axes = panels(titles, 2.0)
    take = _camera()
    show(axes[0], take(_USUAL))
    show(axes[1], take(replace(_USUAL, gain="percentile")))
    show(axes[2], take(_PLATEAU))
    show(axes[3], take(_USUAL, show_scene))
    return figure


def faults() -> Figure:
    """A part of the scene without and with each fault."""
    told: dict[str, dict[str, Any]] = {
        "none": {},
        "column_noise_k: 0.2": {"column_noise_k": 0.2},
        "vignetting_k: 1.5": {"vignetting_k": 1.5},
        "drift by 2 K/min, after 1 min": {"offset_drift_k_per_min": 2.0},
        "sharpening: 1.5": {"sharpening": 1.5},
        "jpeg_quality: 15": {"jpeg_quality": 15},
    }
    figure, axes = panels(tuple(told), 3.4, columns=3)
    take = _camera()
    for panel, keys in zip(axes, told.values(), strict=True):
        show(panel, take(replace(_PLATEAU, **keys)))
    return figure


def _camera() -> Callable[..., Grey]:
    """Give what makes an image of one scene by some settings."""
    with world_at("crossing_2", 0, 3.0) as world:
        config = world.config.robot.cameras["thermal"]
        assert isinstance(config, ThermalConfig)
        seen = world._see(config)
        apparent = surface_image(
            seen.view, world._materials, config, seen.world_from_camera, seen.scene.world_from_part,
            world.config.place.surroundings_c, 0.0,
        )  # fmt: skip

    def take(settings: ThermalConfig, encode: Callable[[NDArray[np.float32]], Grey] | None = None) -> Grey:
        detector = make_detector(settings, stream(0, "thermal.detector"))
        drift_k = Drift(settings, "thermal", 0).offset_k(_DRIFT_S)
        temperature = detect(apparent, detector, settings, stream(0, "thermal.noise"), drift_k)
        crisp = sharpen(temperature, settings.sharpening, settings.sharpening_px)
        grey = Gain(settings).grey(crisp, 0.0) if encode is None else encode(crisp)
        coarse = compress(grey, settings.jpeg_quality) // _STEP * _STEP
        return np.asarray(coarse, np.uint8)[40:200, 60:]

    return take
