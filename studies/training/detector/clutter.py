"""Augmentation by sun and shade, by what is in front of people, and by figures and borders in the image."""

from dataclasses import replace
from typing import Final

import cv2
import numpy as np

from peopleboy.studies.training.detector.augmentation import Draw, Floats, span, to_grey
from peopleboy.studies.training.detector.world_sequences import ThermalImage

_FENCED: Final = 0.12  # shares of images with fences, ...
_TWIGGY: Final = 0.1  # ... twigs, ...
_COVERED: Final = 0.1  # ... and things in front of people
_LIT: Final = 0.2
_MOST_LIGHT: Final = 60.0  # [grey]
_BLACKED: Final = 0.08  # share of images with black borders ...
_INSCRIBED: Final = 0.1  # ... and with burnt-in figures


def clutter(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add sun and shade, fences, twigs and things in front of people, each with some probability."""
    if rng.random() < _LIT:
        image = add_light(image, rng)
    for share, hide in ((_FENCED, _fence), (_TWIGGY, _twigs), (_COVERED, _things)):
        if rng.random() < share:
            image = put_in_front(image, hide(image.grey.shape, rng), rng)
    return image


def overlay(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add figures and black borders, each with some probability."""
    if rng.random() < _INSCRIBED:
        image = inscribe(image, rng)
    if rng.random() < _BLACKED:
        image = blacken_borders(image, rng)
    return image


def add_light(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add patches of sun and shade with edges, as on sunlit ground and facades."""
    rows, columns = image.grey.shape
    lit = np.zeros((rows, columns), np.float32)
    for _ in range(int(rng.integers(1, 5))):
        corners = rng.uniform(-0.3, 1.3, (int(rng.integers(3, 6)), 2)) * (columns, rows)
        patch = np.zeros_like(lit)
        cv2.fillConvexPoly(patch, cv2.convexHull(corners.astype(np.int32)), 1.0)
        lit += rng.uniform(-_MOST_LIGHT, _MOST_LIGHT) * patch
    return replace(image, grey=to_grey(image.grey + cv2.GaussianBlur(lit, (0, 0), rng.uniform(0.7, 6.0))))


def put_in_front(image: ThermalImage, mask: Floats, rng: Draw) -> ThermalImage:
    """Put something of one temperature in front of an image, where a mask (H, W) in 0..1 is not 0."""
    level = np.quantile(image.grey[::4, ::4], rng.uniform()) + rng.normal(0.0, 20.0)
    shown = 1.0 - cv2.GaussianBlur(mask, (0, 0), rng.uniform(0.4, 1.0))
    grey = level + shown * (image.grey - level) + rng.normal(0.0, 1.5, mask.shape) * mask
    visible = image.visible.copy()
    for one, (left, top, width, height) in enumerate(image.whole.tolist()):
        rows, columns = (
            slice(*span(top, height, len(mask), 0.0)),
            slice(*span(left, width, mask.shape[1], 0.0)),
        )
        visible[one] *= float(shown[rows, columns].mean()) if shown[rows, columns].size else 1.0
    return replace(image, grey=to_grey(grey), change=to_grey(shown * image.change), visible=visible)


def _fence(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw bars side by side, with rails."""
    mask = np.zeros(shape, np.float32)
    apart, top = rng.uniform(5.0, 24.0), int(rng.uniform(0.1, 0.8) * shape[0])
    bottom, slope = top + int(rng.uniform(0.2, 0.6) * shape[0]), rng.normal(0.0, 0.15) * (rng.random() < 0.3)
    thick = max(round(rng.uniform(0.08, 0.3) * apart), 1)
    for u in np.arange(rng.uniform(0.0, apart), shape[1], apart).tolist():
        cv2.line(mask, (int(u), top), (int(u + slope * (bottom - top)), bottom), 1.0, thick)
    for v in rng.integers(top, bottom, int(rng.integers(0, 3))).tolist():
        cv2.line(mask, (0, v), (shape[1], v), 1.0, thick)
    return mask


def _twigs(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw crooked lines in a part of the image."""
    mask = np.zeros(shape, np.float32)
    middle, reach = rng.uniform(0.0, 1.0, 2) * shape[::-1], rng.uniform(0.1, 0.5) * shape[1]
    for _ in range(int(rng.integers(5, 50))):
        steps = rng.normal(0.0, 0.12 * reach, (6, 2)) + rng.normal(0.0, 0.1 * reach, 2)
        points = middle + rng.normal(0.0, reach / 2.0, 2) + np.cumsum(steps, axis=0)
        cv2.polylines(
            mask, [points.astype(np.int32)], isClosed=False, color=1.0, thickness=int(rng.integers(1, 3))
        )
    return mask


def _things(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw poles, bushes and boxes."""
    mask = np.zeros(shape, np.float32)
    for _ in range(int(rng.integers(1, 5))):
        u, v = (int(rng.integers(0, side)) for side in shape[::-1])
        if rng.random() < 0.5:
            width, height = int(rng.uniform(2.0, 30.0)), int(rng.uniform(10.0, shape[0]))
            cv2.rectangle(mask, (u, v), (u + width, v + height), 1.0, -1)
        else:
            axes = int(rng.uniform(5.0, 40.0)), int(rng.uniform(5.0, 40.0))
            cv2.ellipse(mask, (u, v), axes, rng.uniform(0.0, 180.0), 0.0, 360.0, 1.0, -1)
    return mask


def inscribe(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Burn figures and a cross into the image."""
    grey, (rows, columns) = image.grey.copy(), image.grey.shape
    level = int(rng.choice((0, 255)))
    for _ in range(int(rng.integers(1, 5))):
        figures = "".join(rng.choice(list("0123456789:.-C"), int(rng.integers(2, 12))))
        corner = (
            int(rng.integers(0, columns)),
            int(rng.choice((rng.uniform(0.03, 0.15), rng.uniform(0.9, 1.0))) * rows),
        )
        cv2.putText(grey, figures, corner, int(rng.integers(0, 4)), rng.uniform(0.25, 0.8), level, 1)
    if rng.random() < 0.3:
        u, v, arm = columns // 2, rows // 2, int(rng.integers(4, 16))
        cv2.line(grey, (u - arm, v), (u + arm, v), level, 1)
        cv2.line(grey, (u, v - arm), (u, v + arm), level, 1)
    return replace(image, grey=grey)


def blacken_borders(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Blacken opposite borders, as of a picture that was fitted into another format."""
    grey, change = image.grey.copy(), image.change.copy()
    for axis in (0, 1):
        if rng.random() < 0.6:
            width = int(rng.uniform(0.02, 0.15) * grey.shape[axis])
            for one in (np.moveaxis(grey, axis, 0), np.moveaxis(change, axis, 0)):
                one[:width] = one[len(one) - width :] = 0
    return replace(image, grey=grey, change=change)
