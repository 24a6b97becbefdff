"""Drawing functions of all figures: canvas, labels, images and boxes on axes; export as SVG or PNG."""

import base64
import io
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from PIL import Image

from peopleboy.tracker.track import Box

BLACK, GREY, ORANGE, BLUE, RED = "#1a1a1a", "#b5bcc6", "#d95f02", "#1f78b4", "#c62828"
GREEN, PINK = "#1b9e77", "#e7298a"
WIDTH_IN = 8.4
DOTS = 110
COLOURS = 256


def canvas(height_in: float, width_in: float = WIDTH_IN) -> Figure:
    """Return a new figure."""
    figure = Figure((width_in, height_in), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def single(height_in: float) -> tuple[Figure, Axes]:
    """Begin a figure with one pair of axes."""
    figure = canvas(height_in)
    return figure, figure.subplots()


def label(
    axes: Axes,
    title: str = "",
    x: str = "",
    y: str = "",
    *,
    is_plan: bool = False,
    legend: float = 0.0,
    **style: Any,
) -> None:
    """Set title and labels of axes, and remove unneeded lines.

    Args:
        axes: the axes.
        title: their title.
        x: label of the x axis.
        y: label of the y axis.
        is_plan: whether both axes have the same scale.
        legend: font size of the legend; no legend if 0.
        style: style of the legend.
    """
    if is_plan:
        axes.set_aspect("equal")
    if legend:
        axes.legend(fontsize=legend, frameon=False, **style)
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_xlabel(x, fontsize=8)
    axes.set_ylabel(y, fontsize=8)
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)


def show_image(axes: Axes, image: NDArray[Any], title: str, **style: Any) -> None:
    """Show an image without axes."""
    axes.imshow(image, **style)
    label(axes, title)
    axes.set_axis_off()


def frame_box(axes: Axes, box: Box, colour: str, **style: Any) -> None:
    """Draw the outline of a box."""
    left, top, width, height = box
    axes.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor=colour, **style))


def png_address(figure: Figure) -> str:
    """Return a figure as the data URL of a PNG with few colours; equal figures give equal bytes."""
    drawn, few = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, dpi=DOTS, facecolor="white")
    picture = Image.open(drawn).convert("RGB")
    kind, plain = Image.Quantize.MEDIANCUT, Image.Dither.NONE
    picture.quantize(COLOURS, kind, kmeans=2, dither=plain).save(few, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(few.getvalue()).decode()


def svg_axes(width_in: float, height_in: float) -> tuple[Figure, Axes]:
    """Begin a figure with one pair of axes."""
    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasSVG(figure)
    return figure, figure.add_subplot()


def finish(axes: Axes) -> None:
    """Set small labels, and horizontal grid lines behind the data."""
    axes.tick_params(labelsize=8)
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def svg(figure: Figure, salt: str) -> bytes:
    """Return a figure as SVG; ids are salted, so that equal figures give equal bytes."""
    buffer = io.BytesIO()
    with rc_context({"svg.hashsalt": salt}):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()
