"""How features are taken from a panorama: figure 4 of the 2003 paper."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.studies.training.distance_learning.distance_examples import panoramas
from peopleboy.tracker.panoramic.paper.background import EMPTY_IMAGES, Background, learn_background
from peopleboy.tracker.panoramic.paper.depth_cues import MeasuredFigure, measure
from peopleboy.tracker.panoramic.paper.paper_tracker import PanoramicConfig

Picture = NDArray[np.uint8]

SCENE: Final = "room_long"
AT_S: Final = 12.0
_SHARES: Final = {"height_ratios": (1, 1, 0.45, 1), "width_ratios": (1, 0.13)}
_MARK: Final = "#d95f02"


def draw_features() -> Figure:
    """Film the beginning of a scenario; draw a panorama, what differs from the background, and the cues."""
    scenario = load_scenario(SCENE)
    images = [image for image, _ in panoramas(scenario.world(0), AT_S)]
    background = learn_background(images[:EMPTY_IMAGES])
    figure = measure(background.silhouette(images[-1]), PanoramicConfig().least_px)
    if figure is None:
        raise BadInput(f"{SCENE}: nobody is seen at {AT_S:g} s")
    return _drawn(images[-1], background, figure)


def _drawn(image: Picture, background: Background, found: MeasuredFigure) -> Figure:
    page = canvas(7.2)
    grid = page.subplots(4, 2, gridspec_kw=_SHARES)
    for axes in (grid[0, 1], grid[2, 1], grid[3, 1]):
        axes.set_axis_off()
    _show(grid[0, 0], image, "a) panorama: the robot's back, left, front, right, and back")
    difference = np.abs(image.astype(np.float64) - background.mean).max(axis=2)
    _show(grid[1, 0], difference, "b) difference from the background, and histograms of rows and columns")
    grid[1, 1].barh(np.arange(len(found.rows)), found.rows, 1.0, color="#1f78b4")
    grid[1, 1].set_ylim(len(found.rows) - 0.5, -0.5)
    grid[2, 0].bar(np.arange(len(found.columns)), found.columns, 1.0, color="#1f78b4")
    grid[2, 0].set_xlim(-0.5, len(found.columns) - 0.5)
    for axes in (grid[1, 1], grid[2, 0]):
        label(axes)
    cues, bearing = found.cues, np.degrees(found.bearing_rad)
    title = (
        f"c) what is above the threshold: width {cues.width_px:.0f} px, {cues.gap_px:.0f} px to the bottom, "
        f"{cues.area_px:.0f} px in all, {abs(bearing):.1f} deg to the {'left' if bearing > 0.0 else 'right'}"
    )
    _show(grid[3, 0], background.silhouette(image), title)
    _mark(grid[3, 0], found)
    return page


def _show(axes: Axes, image: NDArray[np.generic], title: str) -> None:
    axes.imshow(image, cmap="gray", interpolation="nearest", aspect="auto")
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_axis_off()


def _mark(axes: Axes, found: MeasuredFigure) -> None:
    """Draw the person's box, the mean column, and the way to the lower border."""
    left, top, width, height = found.box
    right, bottom, border = left + width, top + height, len(found.rows) - 0.5
    axes.plot([left, right, right, left, left], [top, top, bottom, bottom, top], color=_MARK, linewidth=1.0)
    axes.plot([found.mean_column] * 2, [top, bottom], color=_MARK, linewidth=0.8, linestyle=":")
    axes.annotate(
        "", (right + 6, border), (right + 6, bottom), arrowprops={"arrowstyle": "<->", "color": _MARK}
    )
