"""Pictures of the contour tracker: samples, and the contour by which they are weighted."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from docs.generate.pictures.moments import CROSSING, explained, state_of, ticks
from docs.generate.pictures.paper import panels, show, zoom
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.tracker.reproductions.contour.explanation import DETECTOR_KEY
from peopleboy.tracker.reproductions.contour.measurement.contour import Probes
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.reproductions.contour.particles import Particles
from peopleboy.tracker.reproductions.contour.variants import CONTOUR

SHOWN = (1, 3, 4, 24)
FRAME = 45


def detector() -> Figure:
    """Draw the samples of the first frames, from the initial distribution to a person."""
    figure, axes = panels([f"frame {frame}" for frame in SHOWN], 2.4)
    chosen = dict(zip(SHOWN, axes, strict=True))
    for _, tick in ticks(*CROSSING, frames=SHOWN[-1]):
        if tick.frame in chosen:
            _cloud(chosen[tick.frame], tick)
    return figure


def contour() -> Figure:
    """Draw the points of a contour and the response of each section, for a good and a bad sample."""
    *_, (_, tick) = ticks(*CROSSING, frames=FRAME)
    track = min(tick.tracks, key=lambda one: one.id)
    good = state_of(tick, track.id)
    shifted = good + np.array([-1.2 * good[2], *np.zeros(8)])
    figure, axes = panels(("a sample on the person", "a sample next to the person"), 5.0)
    model = ContourModel.build(tick.observation.images["thermal"].shape, CONTOUR.contour)
    image = model.prepare(tick.observation.images["thermal"])
    for panel, state in zip(axes, (good, shifted), strict=True):
        show(panel, image)
        points = _judged(panel, model, image, state)
        zoom(panel, track.boxes["thermal"], 24.0, 0.98)
    figure.colorbar(points, ax=axes, label="vote of the section", shrink=0.8)
    return figure


def place_probes(
    probes: Probes, state: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return inner and outer points (P, 2) [px] of a state's contour."""
    x, y, w, h, d = state[:5]
    mix = np.array([d, w, h, 1.0])
    return np.array([x, y]) + probes.inner @ mix, np.array([x, y]) + probes.outer @ mix


def _judged(
    panel: Axes, model: ContourModel, image: NDArray[np.uint8], state: NDArray[np.float64]
) -> PathCollection:
    """Draw pairs of points in the colour of their section's response; return the artist for a colour bar."""
    differences = model.differences(image, state.astype(np.float32)[None])[0]
    inner, outer = place_probes(model.probes, state)
    for a, b in zip(inner, outer, strict=True):
        panel.plot(*np.stack([a, b], axis=1), color="0.6", linewidth=0.5)
    says = differences[model.probes.section]
    style: dict[str, Any] = {
        "c": says,
        "cmap": "RdYlBu",
        "norm": Normalize(-1.0, 1.0),
        "edgecolors": "black",
        "linewidths": 0.4,
    }
    panel.scatter(inner[:, 0], inner[:, 1], s=14, marker="o", **style)
    drawn = panel.scatter(outer[:, 0], outer[:, 1], s=22, marker="s", **style)
    panel.set_title(f"{panel.get_title()}: fitness {differences @ model.weights:.2f}", fontsize=11)
    return drawn


def _cloud(panel: Axes, tick: Tick) -> None:
    show(panel, tick.observation.images["thermal"])
    for key, cloud in explained(tick).particles.items():
        _samples(panel, cloud, "#56b4e9" if key == DETECTOR_KEY else "#e69f00")
    for track in tick.tracks:
        for line in outline(explained(tick).ellipses[track.id]):
            panel.plot(*line.T, color="#e69f00", linewidth=1.4)
    panel.set_xlim(-0.5, 319.5)
    panel.set_ylim(239.5, -0.5)


def _samples(panel: Axes, cloud: Particles, colour: str) -> None:
    """Draw the centres of the bodies, with opacity by weight."""
    share = cloud.weight / cloud.weight.max()
    panel.scatter(
        cloud.state[:, 0], cloud.state[:, 1], s=5, color=colour, alpha=0.4 + 0.6 * share, linewidths=0
    )
