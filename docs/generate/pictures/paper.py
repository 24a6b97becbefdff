"""Common parts of all pictures: size, display of images, and file format."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

WIDTH_IN = 11.0  # at 100 dots per inch
COLOURS = 256


def panels(titles: Sequence[str], height_in: float, columns: int | None = None) -> tuple[Figure, list[Axes]]:
    """Create panels without axes, row by row, each with a title."""
    across = len(titles) if columns is None else columns
    figure = Figure((WIDTH_IN, height_in), layout="constrained")
    grid = figure.subplots(-(-len(titles) // across), across, squeeze=False)
    for axes, title in zip(grid.flat, titles, strict=True):
        axes.set_title(title, fontsize=11)
        axes.set_axis_off()
    return figure, list(grid.flat)


def plot(height_in: float) -> tuple[Figure, Axes]:
    """Create one diagram with light axes."""
    figure = Figure((WIDTH_IN, height_in), layout="constrained")
    axes = figure.subplots()
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def show(axes: Axes, image: NDArray[Any], **style: Any) -> Any:
    """Show an (H, W) or (H, W, 3) image without interpolation; grey spans 0..255."""
    usual: dict[str, Any] = (
        {"cmap": "gray", "vmin": 0, "vmax": 255} if image.ndim == 2 and image.dtype == np.uint8 else {}
    )
    return axes.imshow(image, interpolation="nearest", **(usual | style))


def zoom(axes: Axes, box: tuple[float, float, float, float], margin: float, aspect: float) -> None:
    """Zoom to a box (left, top, width, height) with a margin [px], extended to fill the panel."""
    left, top, width, height = box
    half = aspect * (height / 2.0 + margin)
    axes.set_xlim(left + width / 2.0 - half, left + width / 2.0 + half)
    axes.set_ylim(top + height + margin, top - margin)


def save(picture: Figure | Image.Image, path: Path, colours: int = COLOURS) -> Path:
    """Write a picture as a PNG with a reduced palette."""
    if isinstance(picture, Figure):
        file = io.BytesIO()
        picture.savefig(file, dpi=100, facecolor="white")
        picture = Image.open(file)
    path.parent.mkdir(exist_ok=True)
    few = picture.convert("RGB").quantize(
        colours, Image.Quantize.MEDIANCUT, kmeans=2, dither=Image.Dither.NONE
    )
    few.save(path, optimize=True)
    return path
