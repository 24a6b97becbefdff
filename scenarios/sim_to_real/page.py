"""Write the page that compares rendered with real pictures, as one self-contained file."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes

from peopleboy.scenarios.report.page_parts import (
    LINE,
    SERIES,
    data_address,
    inline,
    new_figure,
    render_page,
    svg_style,
    write_page,
)
from peopleboy.scenarios.sim_to_real.clips import ROWS, SIDE, Grey
from peopleboy.scenarios.sim_to_real.compare import PICTURES, Comparison, Separability, Side, figures_of
from peopleboy.scenarios.sim_to_real.measures import (
    CONTRAST_EDGES,
    GRADIENT_EDGES,
    GREY_EDGES,
    ImageStatistics,
)

# Charts, and grids of patches.

_WIDTH_PT, _HEIGHT_PT = 300.0, 165.0
_COLUMNS: Final = 6
_LARGER: Final = 2
_GAP_PX: Final = 3
_PAPER: Final = 255

_Draw = Callable[[Axes, ImageStatistics, dict[str, Any]], None]


def draw_charts(comparison: Comparison) -> list[tuple[str, Markup]]:
    """Draw grey, gradients, both spectra and contrast of both sides; return charts with titles."""
    charts: list[tuple[str, str, _Draw]] = [
        ("Grey", "grey", _grey),
        ("Gradient magnitude", "grey/px", _gradient),
        ("Power of the background", "cycles/px", _spectrum),
        ("Power of the change to the next picture", "cycles/px", _noise),
        ("Contrast of people to the background", "grey", _contrast),
    ]
    return [(title, _chart(comparison, title, across, draw)) for title, across, draw in charts]


@svg_style
def _chart(comparison: Comparison, title: str, across: str, draw: _Draw) -> Markup:
    figure = new_figure(_WIDTH_PT, _HEIGHT_PT)
    figure.set_layout_engine("constrained")
    axes = figure.add_subplot()
    sides = (("rendered", comparison.rendered, "-"), ("real", comparison.real, (0, (4, 2))))
    for (name, side, dash), colour in zip(sides, SERIES, strict=False):
        draw(axes, side.stats, {"color": colour, "ls": dash, "lw": 1.6, "label": name})
    axes.set_xlabel(across)
    axes.grid(color=LINE, lw=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, handlelength=3.0)
    return inline(figure, title, f"{title}: rendered and real")


def _grey(axes: Axes, stats: ImageStatistics, style: dict[str, Any]) -> None:
    axes.step(GREY_EDGES[:-1], 100.0 * stats.grey, where="post", **style)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, 110.0)
    axes.set_yticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    axes.set_ylabel("pixels [%]")


def _gradient(axes: Axes, stats: ImageStatistics, style: dict[str, Any]) -> None:
    axes.step(np.maximum(GRADIENT_EDGES[:-1], 0.4), 100.0 * stats.gradient, where="post", **style)
    axes.set_xscale("log")
    axes.set_xticks([1, 10, 100], ["1", "10", "100"])
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, 110.0)
    axes.set_yticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    axes.set_ylabel("pixels [%]")


def _spectrum(axes: Axes, stats: ImageStatistics, style: dict[str, Any]) -> None:
    _power(axes, stats.spectrum, style)


def _noise(axes: Axes, stats: ImageStatistics, style: dict[str, Any]) -> None:
    _power(axes, stats.noise_spectrum, style)


def _power(axes: Axes, power: Any, style: dict[str, Any]) -> None:
    axes.plot((np.arange(len(power)) + 1.0) / (2.0 * len(power)), np.maximum(power, 1e-3), **style)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    axes.set_yticks(10.0**decades, [f"{10.0**decade:g}" for decade in decades])
    axes.minorticks_off()
    axes.set_ylabel("power [grey²]")


def _contrast(axes: Axes, stats: ImageStatistics, style: dict[str, Any]) -> None:
    if len(stats.contrast):
        shares = np.histogram(stats.contrast, CONTRAST_EDGES)[0] / len(stats.contrast)
        axes.step(CONTRAST_EDGES[:-1], 100.0 * shares, where="post", **style)
    axes.set_ylabel("people [%]")


def grid(patches: Sequence[Grey]) -> str:
    """Return a grid of patches as the data URL of a PNG; empty without patches."""
    if not patches:
        return ""
    rows, step = -(-len(patches) // _COLUMNS), _LARGER * SIDE + _GAP_PX
    page = np.full((rows * step - _GAP_PX, _COLUMNS * step - _GAP_PX), _PAPER, np.uint8)
    for number, patch in enumerate(patches):
        row, column = divmod(number, _COLUMNS)
        large = np.kron(patch, np.ones((_LARGER, _LARGER), np.uint8))
        page[row * step : row * step + len(large), column * step : column * step + len(large)] = large
    return data_address("image/png", cv2.imencode(".png", page)[1].tobytes())


HERE = Path(__file__).parent
_STYLE = HERE.parent / "report"


def write_comparison(comparison: Comparison, out: Path) -> None:
    """Write the page, completely or not at all.

    Raises:
        BadInput: it cannot be written there.
    """
    write_page(render_comparison(comparison), out)


def render_comparison(comparison: Comparison) -> str:
    """Return the page as HTML."""
    sides = {"rendered": comparison.rendered, "real": comparison.real}
    return render_page(
        "comparison.html.jinja",
        [HERE, _STYLE],
        headline=headline(comparison),
        comparison=comparison,
        rows=[row for name, side in sides.items() for row in table_rows(name, side)],
        heads=HEADS,
        charts=draw_charts(comparison),
        grids=[
            (f"{what}, {name}", grid(patches))
            for what, of in (("Background", "background"), ("People", "people"))
            for name, side in sides.items()
            for patches in (getattr(side, of),)
        ],
        view_rows=ROWS,
        pictures=PICTURES,
    )


def headline(comparison: Comparison) -> str:
    """Summarise the separability of patches and people."""
    separability, people = comparison.separability, comparison.of_people
    said = f"A classifier separates rendered from real patches with an AUC of {describe_auc(separability)}"
    return f"{said}, people with {describe_auc(people)}." if people is not None else f"{said}."


def describe_auc(separability: Separability) -> str:
    """Format a mean and its interval."""
    return f"{separability.auc.mean:.3f} ({separability.auc.low:.3f} to {separability.auc.high:.3f})"


def table_rows(name: str, side: Side) -> list[tuple[str, ...]]:
    """Return the statistics of a side, then of each of its scenes."""
    pictures = sum(scene.pictures for scene in side.scenes)
    people = sum(scene.people for scene in side.scenes)
    rows = [(f"{name}, all", pictures, people, figures_of(side.stats))]
    rows += [(scene.name, scene.pictures, scene.people, figures_of(scene.stats)) for scene in side.scenes]
    return [
        (
            label,
            str(count),
            str(persons),
            f"{figures['background_deviation']:.1f}",
            _or_nothing(figures["noise"], ".1f"),
            f"{100.0 * (figures['share_clipped'] or 0.0):.1f}",
            _or_nothing(figures["contrast_median"], ".0f"),
            _or_nothing(figures["contrast_in_ring_median"], ".1f"),
        )
        for label, count, persons, figures in rows
    ]


HEADS = (
    "scene",
    "pictures",
    "people",
    "background deviation [grey]",
    "noise [grey]",
    "clipped [%]",
    "contrast of people [grey]",
    "contrast [deviations of the ring]",
)
"""Headings of the columns of `table_rows`."""


def _or_nothing(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
