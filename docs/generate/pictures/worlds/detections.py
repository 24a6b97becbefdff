"""Picture of the people detector: detections, and feature channels."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.studies.training.detector.world_sequences import ThermalSequence, render_thermal
from peopleboy.tracker.sensors.detections import NO_DETECTIONS
from peopleboy.tracker.sensors.thermal.detector.channels import (
    BESIDE,
    FIRST_DIRECTION,
    GRADIENT,
    MOTION,
    OVER,
)
from peopleboy.tracker.sensors.thermal.detector.detector import SMALLEST_PX, PeopleDetector
from peopleboy.tracker.sensors.thermal.detector.pyramid import pyramid_levels

WORLDS = (3, 24, 28)
"""Seeds of worlds; the picture shows the image of each with the most clearly visible people."""

_STEP = 24  # [grey] quantisation, for small files
_CHANNELS = {GRADIENT: "gradient", FIRST_DIRECTION: "gradient to the right", MOTION: "motion"}


def detections() -> Figure:
    """Draw three images with detections, and below the channels of the first."""
    figure, axes = panels(
        [f"world {seed}" for seed in WORLDS]
        + [f"{name} in world {WORLDS[0]}" for name in _CHANNELS.values()],
        4.2,
        3,
    )
    for seed, channel, panel, below in zip(WORLDS, _CHANNELS, axes[:3], axes[3:], strict=True):
        film = render_thermal(random_scenario(seed), seed)
        _found(panel, film, k := _plainest(film))
        if seed == WORLDS[0]:
            cells = next(pyramid_levels(film.grey[k], film.change[k], None, SMALLEST_PX)).cells
        _channel(below, cells, channel)
    return figure


def _plainest(film: ThermalSequence) -> int:
    plain = film.is_upright & (film.visible > 0.8) & (film.box[:, 3] > SMALLEST_PX)
    return int(np.bincount(film.image[plain], minlength=len(film.grey)).argmax())


def _found(panel: Axes, film: ThermalSequence, k: int) -> None:
    show(panel, film.grey[k] // _STEP * _STEP)
    found = PeopleDetector().detect(
        film.grey[k], film.change[k], film.camera_mount(), NO_DETECTIONS, everywhere=True
    )
    for (left, top, width, height), score in zip(found.box.tolist(), found.score.tolist(), strict=True):
        panel.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor="tab:orange", lw=1.5))
        panel.text(left, max(top - 2.0, 12.0), f"{score:.1f}", color="tab:orange", fontsize=8)


def _channel(panel: Axes, cells: NDArray[np.float32], channel: int) -> None:
    image = cells[channel, OVER:-OVER, BESIDE:-BESIDE]
    bright = 255.0 * np.clip(image / np.quantile(image, 0.995), 0.0, 1.0)
    show(panel, bright.astype(np.uint8) // _STEP * _STEP)
