"""Pictures as addresses that hold all of their data, for pages that lie in one file."""

from __future__ import annotations

import base64
import io

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

WIDTH_IN = 8.4
DOTS = 110
COLOURS = 256


def canvas(height_in: float, width_in: float = WIDTH_IN) -> Figure:
    """Begin a picture."""
    figure = Figure((width_in, height_in), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def label(axes: Axes, title: str = "", x: str = "", y: str = "") -> None:
    """Give axes their words, and no more lines than they need."""
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_xlabel(x, fontsize=8)
    axes.set_ylabel(y, fontsize=8)
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)


def png_address(figure: Figure) -> str:
    """Draw a figure as a PNG data address of few colours; the same figure gives the same bytes."""
    drawn, few = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, dpi=DOTS, facecolor="white")
    picture = Image.open(drawn).convert("RGB")
    kind, plain = Image.Quantize.MEDIANCUT, Image.Dither.NONE
    picture.quantize(COLOURS, kind, kmeans=2, dither=plain).save(few, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(few.getvalue()).decode()
