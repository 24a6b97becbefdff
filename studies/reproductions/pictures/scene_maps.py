"""Backgrounds that scene models learned, beside the truth: figures 3.8 to 3.13 of that thesis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from peopleboy.studies.reproductions.pictures.png import canvas
from peopleboy.studies.reproductions.scene_films.scene_choices import ADAPT, MEAN, ROBUST, TRACK
from peopleboy.studies.reproductions.scene_films.watch_scene import CLEAN, read_map

_SHOWN: Final = {CLEAN: "truth", MEAN: MEAN, TRACK: TRACK, ADAPT: ADAPT, ROBUST: ROBUST}
_NEAREST_M, _FARTHEST_M = 1.5, 7.0
_UNKNOWN: Final = "#000000"


def draw_maps(films: Mapping[str, Mapping[str, str]]) -> Figure:
    """Draw a row for each film: the truth, and the depth that each model takes for background."""
    figure = canvas(1.45 * len(films))
    colours = colormaps["viridis_r"].with_extremes(bad=_UNKNOWN)
    grid = figure.subplots(len(films), len(_SHOWN), squeeze=False)
    for row, (title, maps) in zip(grid, films.items(), strict=True):
        for axes, name in zip(row, _SHOWN, strict=True):
            depth = read_map(maps[name])
            shown = np.ma.masked_equal(depth, 0.0)
            axes.imshow(shown, cmap=colours, vmin=_NEAREST_M, vmax=_FARTHEST_M, interpolation="nearest")
            axes.set_xticks([])
            axes.set_yticks([])
        row[0].set_ylabel(title, fontsize=8)
    for axes, words in zip(grid[0], _SHOWN.values(), strict=True):
        axes.set_title(words, fontsize=8)
    return figure
