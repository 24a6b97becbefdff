"""Pictures of the tracks of an occluded person."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from docs.generate.pictures.moments import CROSSING, History, explained, state_of, ticks
from docs.generate.pictures.paper import panels, plot, show, zoom
from docs.generate.pictures.tracker import place_probes
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    COVERED,
    ContourModel,
    covered_by,
    pixels_under,
)
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from peopleboy.tracker.track import Status, Track

NEAR, FAR = 1, 2  # tracks of nina and olaf
PARTLY = 51
WALK = (48, 52, 55, 58)
NOWHERE = "no track"
COLOURS = {
    Status.TRACKED.value: "#009e73",
    Status.PARTLY_OCCLUDED.value: "#f0e442",
    Status.TOTALLY_OCCLUDED.value: "#d55e00",
    Status.TENTATIVE.value: "0.7",
    NOWHERE: "0.85",
}


def explained_away() -> Figure:
    """Draw the image for the filter of the person behind, in which the person in front is removed."""
    *_, (_, tick) = ticks(*CROSSING, frames=PARTLY)
    tracks = {track.id: track for track in tick.tracks}
    model = ContourModel.build(tick.observation.images["thermal"].shape, CONTOUR.contour)
    image = model.prepare(tick.observation.images["thermal"])
    front = [state_of(tick, NEAR)]
    marked = covered_by(image, front, CONTOUR.depth.growth)
    figure, axes = panels(("two people, two tracks", "image for the filter behind"), 5.0)
    show(axes[0], image)
    for track in tracks.values():
        _outlined(axes[0], tick, track)
    picture = np.stack([marked] * 3, axis=-1)
    picture[marked == COVERED] = (40, 60, 110)
    show(axes[1], picture)
    state = state_of(tick, FAR)
    at = pixels_under(state.astype(np.float32), model.probes, marked.shape)
    is_open = (at >= 0) & (marked.reshape(-1)[at] != COVERED)
    pairs = is_open[: len(is_open) // 2] & is_open[len(is_open) // 2 :]
    for points in place_probes(model.probes, state):
        axes[1].scatter(
            points[pairs, 0], points[pairs, 1], s=14, color=_hex(FAR), edgecolors="black", linewidths=0.4
        )
        axes[1].scatter(
            points[~pairs, 0], points[~pairs, 1], s=14, facecolors="none", edgecolors="0.7", linewidths=0.8
        )
    for panel in axes:
        zoom(panel, tracks[NEAR].boxes["thermal"], 16.0, 1.1)
    return figure


def walking_on() -> Figure:
    """Draw four moments of an occlusion."""
    figure, axes = panels([""] * len(WALK), 3.4)
    chosen = dict(zip(WALK, axes, strict=True))
    for _, tick in ticks(*CROSSING, frames=WALK[-1]):
        if tick.frame in chosen:
            _moment(chosen[tick.frame], tick)
    return figure


def timeline() -> Figure:
    """Draw the visible fraction of olaf, and the status of his track."""
    history = History()
    for _, tick in ticks(*CROSSING, frames=240):
        history.add(tick, "olaf", FAR)
    figure, axes = plot(2.6)
    time = np.array(history.time_s)
    axes.fill_between(time, 100.0 * np.array(history.visible), color="#56b4e9", step="post", linewidth=0)
    for k, status in enumerate(history.status):
        axes.axvspan(time[k], time[k] + 1 / 15, 0.0, 0.07, color=COLOURS[status], linewidth=0)
    axes.set(xlim=(0, time[-1]), ylim=(-8, 102), xlabel="time [s]", ylabel="olaf visible [%]")
    found = [status for status in COLOURS if status in history.status]
    patches = [Patch(color=COLOURS[status], label=f"track {FAR}: {status}") for status in found]
    axes.legend(
        handles=patches, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=len(found), frameon=False
    )
    return figure


def _moment(panel: Axes, tick: Tick) -> None:
    show(panel, tick.observation.images["thermal"])
    for track in tick.tracks:
        _outlined(panel, tick, track)
    olaf = next(person for person in tick.truth.people if person.name == "olaf")
    says = next((track.status.value for track in tick.tracks if track.id == FAR), NOWHERE)
    seen = f"{tick.truth.time_s:.1f} s: {olaf.visible_fraction:.0%} of olaf visible"
    panel.set_title(f"{seen}\ntrack {FAR}: {says}", fontsize=10)
    panel.set_xlim(70, 230)
    panel.set_ylim(235, 65)


def _outlined(panel: Axes, tick: Tick, track: Track) -> None:
    """Draw a contour, dashed if the person is occluded."""
    style = ":" if track.status is Status.TOTALLY_OCCLUDED else "-"
    for line in outline(explained(tick).ellipses[track.id]):
        panel.plot(*line.T, style, color=_hex(track.id), linewidth=1.8)
    left, top, *_ = track.boxes["thermal"]
    panel.text(left, top - 3, str(track.id), color=_hex(track.id), fontsize=11, fontweight="bold")


def _hex(number: int) -> str:
    red, green, blue = track_colour(number)
    return f"#{red:02x}{green:02x}{blue:02x}"
