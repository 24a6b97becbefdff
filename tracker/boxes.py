"""Boxes: their corners and shares of the image, their areas and overlaps.

A box is left, top, width, height in pixels; pixel (0, 0) spans -0.5..0.5.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


Box = tuple[float, float, float, float]


class ImageShares(NamedTuple):
    """Where a box is, relative to the image.

    x is the box's middle in half image widths, 0 in the middle of the image and 1 at the right border; the
    others are in image heights from the top.
    """

    x: float
    height: float
    top: float
    bottom: float


def corners(box: Box) -> Box:
    """Return left, top, right, bottom [px] of a box."""
    left, top, width, height = box
    return left, top, left + width, top + height


def image_shares(box: Box, width_px: int, height_px: int) -> ImageShares:
    """Return a box relative to an image of that size."""
    left, top, width, height = box
    return ImageShares(
        x=(left + width / 2.0 - (width_px - 1) / 2.0) / (width_px / 2.0),
        height=height / height_px,
        top=(top + 0.5) / height_px,
        bottom=(top + height + 0.5) / height_px,
    )


def outline(image: NDArray[Any]) -> Floats:
    """Return the box (4,) that an image (H, W, ...) fills."""
    rows, columns = image.shape[:2]
    return np.array([-0.5, -0.5, columns, rows])


def add_edge_noise(box: Floats, deviation_px: float, rng: np.random.Generator) -> Floats:
    """Move the four edges of boxes (N, 4) independently, as a person does who draws them by hand.

    Moved boxes are at least 1 px wide and high.

    Args:
        box: the boxes; they stay the same with a deviation of 0.
        deviation_px: standard deviation of the normal noise of each edge.
        rng: random numbers.
    """
    if deviation_px == 0.0:
        return box
    noise = deviation_px * rng.standard_normal(box.shape)
    moved = box + noise
    moved[:, 2:] -= noise[:, :2]
    moved[:, 2:] = np.maximum(moved[:, 2:], 1.0)
    return moved


def within_image(box: Floats, width_px: int, height_px: int) -> Floats:
    """Clip boxes (..., 4) to the borders of an image; boxes outside get no area.

    Args:
        box: in coordinates of the image's corner, so that the image spans 0 to its width and height.
        width_px: of the image.
        height_px: of the image.
    """
    size = np.array([width_px, height_px], float)
    near = np.clip(box[..., :2], 0.0, size)
    far = np.clip(box[..., :2] + box[..., 2:], 0.0, size)
    return np.concatenate([near, far - near], axis=-1)


def centres_outside(box: Floats, width_px: int, height_px: int) -> NDArray[np.bool_]:
    """Return which boxes (N, 4) have their centre outside an image."""
    u, v = (box[:, :2] + box[:, 2:] / 2.0).T
    return np.asarray(~((u >= 0.0) & (u <= width_px) & (v >= 0.0) & (v <= height_px)))


def area(box: Floats) -> Floats:
    """Return the areas (...) [px^2] of boxes (..., 4)."""
    return np.asarray(box[..., 2] * box[..., 3])


def intersection(a: Floats, b: Floats, around_px: float = math.inf) -> Floats:
    """Return the areas (...) [px^2] that boxes a (..., 4) and b (..., 4) share; leading axes broadcast.

    Args:
        a: boxes.
        b: other boxes of the same image.
        around_px: columns of a full turn, if the image's right border joins its left one; boxes may then
            cross the border, and are equal modulo this width.
    """
    if math.isinf(around_px):
        return _flat_intersection(a, b)
    turns = np.rint((a[..., 0] - b[..., 0]) / around_px)[..., None] + np.arange(-1.0, 2.0)
    moved = np.repeat(b[..., None, :], 3, axis=-2) + np.zeros((*turns.shape, 4))
    moved[..., 0] += turns * around_px
    return np.asarray(_flat_intersection(a[..., None, :], moved).sum(axis=-1))


def _flat_intersection(a: Floats, b: Floats) -> Floats:
    near = np.maximum(a[..., :2], b[..., :2])
    far = np.minimum(a[..., :2] + a[..., 2:], b[..., :2] + b[..., 2:])
    side = np.maximum(far - near, 0.0)
    return np.asarray(side[..., 0] * side[..., 1])


def iou(a: Floats, b: Floats, around_px: float = math.inf) -> Floats:
    """Return intersection over union (...) of boxes a (..., 4) and b (..., 4); leading axes broadcast.

    Symmetric, in 0..1; 1 for a box with itself, 0 where either box has no area. Arguments as in
    `intersection`.
    """
    shared = intersection(a, b, around_px)
    return cover(shared, area(a) + area(b) - shared)


def cover(shared: Floats, whole: Floats) -> Floats:
    """Return the ratios (...) shared / whole, at most 1, and 0 where the whole is 0."""
    ratio = np.divide(shared, whole, out=np.zeros_like(shared), where=whole > 0.0)
    return np.minimum(ratio, 1.0)


def shared_of_smaller(a: Floats, b: Floats) -> Floats:
    """Return the share (...) of the smaller area that boxes a (..., 4) and b (..., 4) have in common."""
    return cover(intersection(a, b), np.minimum(area(a), area(b)))
