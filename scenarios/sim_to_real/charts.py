"""The charts and grids of patches of a comparison's page."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from typing import Any, Final

import cv2
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes

from peopleboy.scenarios.report.charts.svg import LINE, SERIES, inline, new_figure, svg_style
from peopleboy.scenarios.sim_to_real.clips import Grey
from peopleboy.scenarios.sim_to_real.compare import Comparison
from peopleboy.scenarios.sim_to_real.measures import CONTRAST_EDGES, GRADIENT_EDGES, GREY_EDGES, Looks
from peopleboy.scenarios.sim_to_real.patches import SIDE

_WIDTH_PT, _HEIGHT_PT = 300.0, 165.0
_COLUMNS: Final = 6
_LARGER: Final = 2
_GAP_PX: Final = 3
_PAPER: Final = 255

_Draw = Callable[[Axes, Looks, dict[str, Any]], None]


def draw_charts(comparison: Comparison) -> list[tuple[str, Markup]]:
    """Draw grey, gradients, both spectra and contrast of both sides, each with its title."""
    charts: list[tuple[str, str, _Draw]] = [
        ("Grey", "grey", _grey),
        ("Gradient magnitude", "grey/px", _gradient),
        ("Background, by spatial frequency", "cycles/px", _spectrum),
        ("Change to the next picture, by spatial frequency", "cycles/px", _noise),
        ("People against a ring of background", "grey", _contrast),
    ]
    return [(title, _chart(comparison, title, across, draw)) for title, across, draw in charts]


@svg_style
def _chart(comparison: Comparison, title: str, across: str, draw: _Draw) -> Markup:
    figure = new_figure(_WIDTH_PT, _HEIGHT_PT)
    figure.set_layout_engine("constrained")
    axes = figure.add_subplot()
    sides = (("rendered", comparison.rendered, "-"), ("real", comparison.real, (0, (4, 2))))
    for (name, side, dash), colour in zip(sides, SERIES, strict=False):
        draw(axes, side.looks, {"color": colour, "ls": dash, "lw": 1.6, "label": name})
    axes.set_xlabel(across)
    axes.grid(color=LINE, lw=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, handlelength=3.0)
    return inline(figure, title, f"{title}: rendered beside real")


def _grey(axes: Axes, looks: Looks, style: dict[str, Any]) -> None:
    axes.step(GREY_EDGES[:-1], 100.0 * looks.grey, where="post", **style)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, 110.0)
    axes.set_yticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    axes.set_ylabel("pixels [%]")


def _gradient(axes: Axes, looks: Looks, style: dict[str, Any]) -> None:
    axes.step(np.maximum(GRADIENT_EDGES[:-1], 0.4), 100.0 * looks.gradient, where="post", **style)
    axes.set_xscale("log")
    axes.set_xticks([1, 10, 100], ["1", "10", "100"])
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, 110.0)
    axes.set_yticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    axes.set_ylabel("pixels [%]")


def _spectrum(axes: Axes, looks: Looks, style: dict[str, Any]) -> None:
    _power(axes, looks.spectrum, style)


def _noise(axes: Axes, looks: Looks, style: dict[str, Any]) -> None:
    _power(axes, looks.noise_spectrum, style)


def _power(axes: Axes, power: Any, style: dict[str, Any]) -> None:
    axes.plot((np.arange(len(power)) + 1.0) / (2.0 * len(power)), np.maximum(power, 1e-3), **style)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    axes.set_yticks(10.0**decades, [f"{10.0**decade:g}" for decade in decades])
    axes.minorticks_off()
    axes.set_ylabel("power [grey²]")


def _contrast(axes: Axes, looks: Looks, style: dict[str, Any]) -> None:
    if len(looks.contrast):
        shares = np.histogram(looks.contrast, CONTRAST_EDGES)[0] / len(looks.contrast)
        axes.step(CONTRAST_EDGES[:-1], 100.0 * shares, where="post", **style)
    axes.set_ylabel("people [%]")


def grid(patches: Sequence[Grey]) -> str:
    """Lay patches out side by side, as the data address of a PNG; empty without any."""
    if not patches:
        return ""
    rows, step = -(-len(patches) // _COLUMNS), _LARGER * SIDE + _GAP_PX
    page = np.full((rows * step - _GAP_PX, _COLUMNS * step - _GAP_PX), _PAPER, np.uint8)
    for number, patch in enumerate(patches):
        row, column = divmod(number, _COLUMNS)
        large = np.kron(patch, np.ones((_LARGER, _LARGER), np.uint8))
        page[row * step : row * step + len(large), column * step : column * step + len(large)] = large
    return f"data:image/png;base64,{base64.b64encode(cv2.imencode('.png', page)[1].tobytes()).decode()}"
