"""Appearance model of one part of a person, learned from one box in one image."""

from dataclasses import dataclass, fields
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.box_scores import box_means, spreads
from peopleboy.tracker.reproductions.attention.feature_maps import CELL_PX
from peopleboy.tracker.reproductions.attention.image_sums import COLOUR_BINS, ImageSums
from peopleboy.tracker.track import Box

# The two parts of a person: the head, and the torso at a fixed position below it.

LEAST_CELLS: Final = 2
"""Least side of a part, in cells, for learning."""


@dataclass(frozen=True, slots=True)
class ModelPart:
    """Position of a part in a box from head to feet, in the box's heights, from the middle of its top.

    Attributes:
        top: upper border.
        width, height: size.
    """

    top: float
    width: float
    height: float


HEAD: Final = ModelPart(top=0.0, width=0.125, height=0.125)
TORSO: Final = ModelPart(top=0.18, width=0.185, height=0.30)


@dataclass(frozen=True, slots=True)
class Cells:
    """A rectangle of cells; `row` and `column` are those of its upper left cell."""

    row: int
    column: int
    height: int
    width: int

    def is_inside(self, rows: int, columns: int) -> bool:
        """Return whether all of it is inside an image of this many cells."""
        return (
            min(self.row, self.column) >= 0
            and self.row + self.height <= rows
            and self.column + self.width <= columns
        )


def cells_of(part: ModelPart, box: Box, scale: float = 1.0) -> Cells:
    """Return the cells of a part of a person with this box [px] from head to feet.

    Args:
        part: of the person.
        box: left, top, width, height; the width is ignored.
        scale: magnification about the middle of the upper border.
    """
    left, top, width, height = box
    tall = height * scale
    middle = left + width / 2.0
    return Cells(
        row=round((top + part.top * tall) / CELL_PX),
        column=round((middle - part.width * tall / 2.0) / CELL_PX),
        height=max(LEAST_CELLS, round(part.height * tall / CELL_PX)),
        width=max(LEAST_CELLS, round(part.width * tall / CELL_PX)),
    )


def check_box(box: Box, shape: tuple[int, ...]) -> None:
    """Refuse a box whose head or torso is outside an image of this shape.

    Raises:
        BadInput: head or torso are outside, or the box is invalid.
    """
    rows, columns = shape[0] // CELL_PX, shape[1] // CELL_PX
    is_box = len(box) == 4 and all(abs(number) < 1e6 for number in box) and box[2] > 0 and box[3] > 0
    if not is_box or not all(cells_of(part, box).is_inside(rows, columns) for part in (HEAD, TORSO)):
        numbers = ", ".join(f"{number:g}" for number in box)
        raise BadInput(
            f"attention: head and torso of box ({numbers}) must be inside the image, {shape[1]} x {shape[0]}"
        )


Doubles = NDArray[np.float64]
Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]

_STEP_CELLS: Final = 2
_RAREST: Final = 1e-3  # least share of a pattern in the rest of the image, as a floor of the ratio
_RARE_PX: Final = 2.0  # prior pixels of each colour in the box and in the rest, as in the whole image
_MOST_RATIO: Final = 4.0  # limit of the logarithmic colour ratio


@dataclass(frozen=True, slots=True, eq=False)
class PartModel:
    """Appearance model of a part.

    Attributes:
        mean: (23,) of the maps in the box; empty if maps are not used.
        spread: (23,) standard deviation of such means over all boxes of the training image.
        excites: (23,) amount of each map in the box (equation 5.4).
        inhibits: (23,) amount in the rest (equation 5.5).
        patterns: (59,) pattern histogram of the box.
        pattern_weight: (59,) its ratio to that of the rest (equation 5.8).
        colours: (512,) colour histogram of the box.
        colour_ratio: (512,) logarithm of its ratio to that of the rest.
    """

    mean: Doubles
    spread: Doubles
    excites: Doubles
    inhibits: Doubles
    patterns: Singles
    pattern_weight: Singles
    colours: Doubles
    colour_ratio: Doubles

    @classmethod
    def learned(
        cls, sight: ImageSums, cells: Cells, config: AttentionConfig, near: Mask | None = None
    ) -> Self:
        """Learn a part from a box.

        Args:
            sight: the image.
            cells: the box, entirely inside the image.
            config: features to use.
            near: (H, W) pixels not behind the person; the box's other pixels are background. None if unknown.
        """
        empty = np.zeros(0)
        mean = spread = excites = inhibits = empty
        if sight.map_sums is not None:
            mean = box_means(sight.map_sums, cells.row, cells.column, cells.height, cells.width)
            spread = spreads(sight.map_sums, cells.height, cells.width, _STEP_CELLS)
            excites, inhibits = _shares(sight, cells, config, near)
        patterns = weight = np.zeros(0, np.float32)
        if sight.pattern_sums is not None:
            patterns, weight = _patterns(sight.pattern_sums, cells)
        colours, ratio = _colours(sight, cells, near)
        return cls(mean, spread, excites, inhibits, patterns, weight, colours, ratio)

    def updated(self, new: "PartModel", rate: float) -> "PartModel":
        """Return the model blended with a newer one.

        The source's equations 5.15 and 5.16 print the "very small" rate as the weight of the old model.
        """
        mixed = {
            name: (1.0 - rate) * getattr(self, name) + rate * getattr(new, name)
            for name in (field.name for field in fields(self))
        }
        return PartModel(
            **{name: np.asarray(value, getattr(self, name).dtype) for name, value in mixed.items()}
        )


def _shares(
    sight: ImageSums, cells: Cells, config: AttentionConfig, near: Mask | None
) -> tuple[Doubles, Doubles]:
    """Return the amounts of each map in the box and in the rest (equations 5.4 to 5.6).

    Sums over a box smaller than half of the image make nearly every feature speak against it; hence the
    means.
    """
    assert sight.maps is not None
    inside = np.zeros(sight.maps.shape[:2], np.bool_)
    inside[cells.row : cells.row + cells.height, cells.column : cells.column + cells.width] = True
    if near is not None:
        inside &= near[: CELL_PX * sight.rows : CELL_PX, : CELL_PX * sight.columns : CELL_PX]
    whole, box = (
        sight.maps.sum(axis=(0, 1), dtype=np.float64),
        sight.maps[inside].sum(axis=0, dtype=np.float64),
    )
    rest = whole - box
    if config.share == "means":
        count = np.count_nonzero(inside)
        box, rest = box / max(count, 1), rest / (inside.size - count)
    excites = box / np.maximum(box + rest, 1e-12)
    return excites, 1.0 - excites


def _patterns(sums: Singles, cells: Cells) -> tuple[Singles, Singles]:
    """Return the pattern histogram of a box, and its ratio to that of the rest (equation 5.8)."""
    low, right = cells.row + cells.height, cells.column + cells.width
    box = sums[low, right] - sums[cells.row, right] - sums[low, cells.column] + sums[cells.row, cells.column]
    rest = sums[-1, -1] - box
    share, other = box / max(box.sum(), 1.0), rest / max(rest.sum(), 1.0)
    return share.astype(np.float32), (share / np.maximum(other, _RAREST)).astype(np.float32)


def _colours(sight: ImageSums, cells: Cells, near: Mask | None) -> tuple[Doubles, Doubles]:
    """Return the colour histogram of a box, and the logarithm of its ratio to that of the rest."""
    rows = slice(CELL_PX * cells.row, CELL_PX * (cells.row + cells.height))
    columns = slice(CELL_PX * cells.column, CELL_PX * (cells.column + cells.width))
    found = sight.colours[rows, columns]
    found = found.ravel() if near is None else found[near[rows, columns]]
    box = np.bincount(found, minlength=COLOUR_BINS).astype(np.float64)
    whole = np.bincount(sight.colours.ravel(), minlength=COLOUR_BINS)
    usual = _RARE_PX * (whole + 1.0) / (whole.sum() + COLOUR_BINS)
    share = (box + usual) / (box.sum() + _RARE_PX)
    rest = (whole - box + usual) / (whole.sum() - box.sum() + _RARE_PX)
    ratio = np.clip(np.log(share / rest), -_MOST_RATIO, _MOST_RATIO)
    return box / max(box.sum(), 1.0), ratio
