"""What people in front cover of those behind."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import ContourConfig
from peopleboy.tracker.thermal.contour.contour import (
    COVERED,
    FEET,
    HEAD_RIGHT,
    SECTIONS,
    Probes,
    pixels_under,
)
from peopleboy.tracker.thermal.filter.particles import FOOT, D, H, W, X, Y

LEGS_WIDTH = 0.75  # half width of the legs, in body semi-widths
_SUBPIXEL_BITS = 4
_SCALE = 1 << _SUBPIXEL_BITS


def _superellipse(power: float, count: int = 32) -> NDArray[np.float64]:
    """Give the outline (count, 2) of a shape between an ellipse (power 2) and a square."""
    angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outline: NDArray[np.float64] = np.sign(around) * np.abs(around) ** (2 / power)
    return outline


BODY = _superellipse(3.5)  # shoulders and arms reach into the corners of the ellipse


def uncovered(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Copy a grey image (H, W) into one where no pixel is marked as covered."""
    return np.maximum(image, np.uint8(COVERED + 1))


def cover(
    image: NDArray[np.uint8], state: NDArray[np.float64], contour: ContourConfig, growth: float = 1.0
) -> None:
    """Mark the pixels (H, W) of a person with this state (9,) as covered, in place.

    Args:
        image: grey, (H, W).
        state: of the person in front.
        contour: proportions of the head.
        growth: by which body, head and legs are made wider.
    """
    x, y, d, w, h = (float(state[k]) for k in (X, Y, D, W, H))
    if not (w > 0 and h > 0 and np.isfinite(state[:5]).all()):
        return
    head = h / contour.head_divisor
    outline = BODY * (growth * w, h) + (x, y)
    cv2.fillPoly(image, [np.rint(outline * _SCALE).astype(np.int32)], COVERED, cv2.LINE_8, _SUBPIXEL_BITS)
    _fill_ellipse(image, x + d, y - h - head, growth * contour.head_aspect * head, growth * head)
    legs = growth * LEGS_WIDTH * w
    left, right = round(x - legs), round(x + legs)
    image[max(round(y), 0) : max(round(y + FOOT * h), 0), max(left, 0) : max(right + 1, 0)] = COVERED


def seen_shares(image: NDArray[np.uint8], state: NDArray[np.float64], probes: Probes) -> NDArray[np.float64]:
    """Measure which share (8,) of every section's pairs of points is in the image and not covered.

    A section without points counts as seen.

    Args:
        image: (H, W) with covered pixels marked.
        state: (9,) of a person.
        probes: the points of its contour.
    """
    at = pixels_under(state.astype(np.float32), probes, image.shape)
    is_seen = (at >= 0) & (image.reshape(-1)[at] != COVERED)
    seen = is_seen[: len(probes.section)] & is_seen[len(probes.section) :]
    count = np.bincount(probes.section, minlength=SECTIONS)
    shares: NDArray[np.float64] = np.bincount(probes.section, seen, SECTIONS) / np.maximum(count, 1)
    return np.where(count > 0, shares, 1.0)


def head_share(shares: NDArray[np.float64]) -> float:
    """Average over the head's sections (8,) what is seen of them."""
    return float(shares[: HEAD_RIGHT + 1].mean())


def body_share(shares: NDArray[np.float64]) -> float:
    """Average over all sections (8,) but the feet what is seen of them."""
    return float(shares[:FEET].mean())


def _fill_ellipse(image: NDArray[np.uint8], x: float, y: float, a: float, b: float) -> None:
    centre, axes = (round(x * _SCALE), round(y * _SCALE)), (round(a * _SCALE), round(b * _SCALE))
    cv2.ellipse(image, centre, axes, 0, 0, 360, COVERED, cv2.FILLED, cv2.LINE_8, _SUBPIXEL_BITS)


def covered_by(
    image: NDArray[np.uint8],
    states: Sequence[NDArray[np.float64]],
    contour: ContourConfig,
    growth: float = 1.0,
) -> NDArray[np.uint8]:
    """Copy an image (H, W) and mark in it what people with these states (9,) cover."""
    marked = uncovered(image)
    for state in states:
        cover(marked, state, contour, growth)
    return marked
