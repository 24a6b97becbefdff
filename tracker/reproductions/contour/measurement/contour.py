"""The contour model of a person: a body and a head ellipse, divided into sections.

Every point on or near the contour is the body's centre plus a fixed linear combination of d, w and h. A
contour model is therefore a table of coefficients (`Probes`), computed once for an image size.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.contour_config import ContourConfig
from peopleboy.tracker.reproductions.contour.particles import FOOT, HEAD_DIVISOR, Floats

HEAD_LEFT, HEAD_TOP, HEAD_RIGHT, SHOULDER_LEFT, SHOULDER_RIGHT, SIDE_LEFT, SIDE_RIGHT, FEET = range(8)
SECTIONS = 8
GREYS = 256

# The sources show the sections in a figure only; these are readings of it.
HEAD_ASPECT = 0.75  # head semi-width / head semi-height
NECK_DEG = 60.0  # opening of the head ellipse at the neck
HEAD_TOP_DEG = 90.0  # arc of the head's top section
SHOULDER_DEG = 60.0  # arc of a shoulder, from the top of the body down
FEET_SPAN = 0.6  # half-length of the line under the feet, in body semi-heights
FEET_COLUMNS = 8


@dataclass(frozen=True, slots=True, eq=False)
class Probes:
    """P pairs of points, one inside and one outside of the contour.

    A point is at (x, y) plus (d, w, h, 1) multiplied by its two rows of four coefficients.

    Attributes:
        inner: (P, 2, 4) float32 coefficients of the inner points, rows for u and v.
        outer: (P, 2, 4) float32 the same for the outer points.
        section: (P,) int64 section of each pair, in increasing order.
        first: (9,) int64 first pair of each section, and P.
        mix: (7, 2 P) float32 the same coefficients, all inner points before all outer ones: those of u for d,
            w, h, 1, and those of v for w, h, 1, in a layout for vectorised kernels.
        same: (2 P,) int64 the first point with the same coefficients in the same section.
    """

    inner: Floats
    outer: Floats
    section: NDArray[np.int64]
    first: NDArray[np.int64]
    mix: Floats
    same: NDArray[np.int64]


def section_angles(config: ContourConfig) -> dict[int, tuple[float, float]]:
    """Return each section's arc on its ellipse, in radians from the top, positive to the right.

    The head's three arcs cover its ellipse except for the neck; shoulders and sides cover the body's down to
    `side_end_deg`.
    """
    top, neck = np.radians(HEAD_TOP_DEG) / 2, np.pi - np.radians(NECK_DEG) / 2
    shoulder, end = np.radians(SHOULDER_DEG), np.radians(config.side_end_deg)
    return {
        HEAD_LEFT: (-neck, -top),
        HEAD_TOP: (-top, top),
        HEAD_RIGHT: (top, neck),
        SHOULDER_LEFT: (-shoulder, 0.0),
        SHOULDER_RIGHT: (0.0, shoulder),
        SIDE_LEFT: (-end, -shoulder),
        SIDE_RIGHT: (shoulder, end),
    }


def build_probes(config: ContourConfig, size: float) -> Probes:
    """Return the pairs of points of all sections.

    Args:
        config: the contour model.
        size: image height / 240, which scales `reach_px`.
    """
    near, deep = config.reach_px * size, config.inner_depth
    parts: list[tuple[Floats, Floats, int]] = []
    for section, (start, end) in section_angles(config).items():
        # The middles of equal pieces: no point belongs to two sections.
        angle = start + (end - start) * (np.arange(config.points) + 0.5) / config.points
        if section in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT):
            reach = np.resize(config.head_reach, len(angle))
            inner = head_points(angle, -deep * reach, -deep * near)
            parts.append((inner, head_points(angle, reach, near), section))
            if config.far_head_reach > 0:
                far = np.full(len(angle), config.far_head_reach)
                parts.append((inner, head_points(angle, far, near), section))
        else:
            reach = np.resize(config.body_reach, len(angle))
            inner = body_points(angle, -deep * reach, -deep * near)
            parts.append((inner, body_points(angle, reach, near), section))
    if config.feet_weight > 0:
        parts.append((*_feet_points(), FEET))
    inner = np.concatenate([inner for inner, _, _ in parts])
    outer = np.concatenate([outer for _, outer, _ in parts])
    sections = np.concatenate([np.full(len(inner), section) for inner, _, section in parts])
    points = np.concatenate([inner, outer])
    mix = np.concatenate([points[:, 0], points[:, 1, 1:]], axis=1)
    first = np.searchsorted(sections, np.arange(SECTIONS + 1))
    same = _firsts(np.column_stack([mix, np.tile(sections, 2), np.repeat([0, 1], len(sections))]))
    return Probes(inner, outer, sections, first, np.ascontiguousarray(mix.T), same)


def _firsts(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the first (N,) of equal rows (N, M)."""
    _, first, group = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[group.reshape(-1)], np.int64)


def body_points(angle: NDArray[np.float64], grow: NDArray[np.float64], grow_px: float) -> Floats:
    """Return points (K, 2, 4) of the body ellipse with both semi-axes longer by `grow` w + `grow_px`."""
    points = np.zeros((len(angle), 2, 4), dtype=np.float32)
    right, down = np.sin(angle), -np.cos(angle)
    points[:, 0, 1] = (1 + grow) * right
    points[:, 0, 3] = grow_px * right
    points[:, 1, 1] = grow * down
    points[:, 1, 2] = down
    points[:, 1, 3] = grow_px * down
    return points


def head_points(angle: NDArray[np.float64], grow: NDArray[np.float64], grow_px: float) -> Floats:
    """Return points (K, 2, 4) of the head ellipse, its semi-axes longer by `grow` semi-widths + `grow_px`."""
    points = np.zeros((len(angle), 2, 4), dtype=np.float32)
    right, down = np.sin(angle), -np.cos(angle)
    tall = 1 / HEAD_DIVISOR
    wide = tall * HEAD_ASPECT
    points[:, 0, 0] = 1.0
    points[:, 0, 2] = wide * (1 + grow) * right
    points[:, 0, 3] = grow_px * right
    points[:, 1, 2] = -(1 + tall) + (tall + grow * wide) * down
    points[:, 1, 3] = grow_px * down
    return points


def _feet_points() -> tuple[Floats, Floats]:
    """Return points (K, 2, 4) above the line under the feet, and below it at two depths, on the floor."""
    across = np.linspace(-FEET_SPAN, FEET_SPAN, FEET_COLUMNS)
    points = np.zeros((2, 2, FEET_COLUMNS, 2, 4), dtype=np.float32)
    points[..., 0, 2] = across
    points[0, ..., 1, 2] = FOOT - 0.1
    points[1, 0, :, 1, 2] = FOOT + 0.1
    points[1, 1, :, 1, 2] = FOOT + 0.4
    return points[0].reshape(-1, 2, 4), points[1].reshape(-1, 2, 4)


def build_response(config: ContourConfig) -> Floats:
    """Tabulate (8, 511) the response to a grey difference -255..255, inner minus outer, in each section."""
    difference = np.arange(1 - GREYS, GREYS, dtype=np.float64)
    response = difference / (config.saturation_grey or 1.0)
    if config.saturation_grey > 0:
        response = np.clip(response, -1.0, 1.0) if config.is_cut_off else np.tanh(response)
    table = np.tile(response, (SECTIONS, 1))
    # Clothes may be colder than the background; a head hardly ever is.
    table[SHOULDER_LEFT:FEET] = np.where(difference < 0, config.cold_response * response, response)
    return table.astype(np.float32)


def section_weights(config: ContourConfig) -> NDArray[np.float64]:
    """Return the weights (8,) of the sections, which sum to 1."""
    weights = np.array([*config.section_weights, config.feet_weight])
    shares: NDArray[np.float64] = weights / weights.sum()
    return shares
