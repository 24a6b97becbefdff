"""The contour of a person: a body and a head ellipse, looked at in sections.

Every point on or beside the contour is the body's centre plus a fixed mix of d, w and h. A whole contour
model is therefore a table of coefficients (`Probes`), and all variants share the one kernel that reads the
image with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import ContourConfig
from peopleboy.tracker.thermal.filter.particles import D, Floats, H, W, X, Y

HEAD_LEFT, HEAD_TOP, HEAD_RIGHT, SHOULDER_LEFT, SHOULDER_RIGHT, SIDE_LEFT, SIDE_RIGHT, FEET = range(8)
SECTIONS = 8
GREYS = 256
FEET_COLUMNS = 8
COVERED = 0
"""Grey of the pixels of people in front, in an image where no other pixel has it."""
NO_GREY = -2


@dataclass(frozen=True, slots=True, eq=False)
class Probes:
    """P pairs of points, one inside and one outside of the contour.

    A point lies at (x, y) + (d, w, h, 1) mixed by its two rows of four coefficients.

    Attributes:
        inner: (P, 2, 4) float32 coefficients of the inner points, rows for u and v.
        outer: (P, 2, 4) float32 the same for the outer points.
        section: (P,) int64 the section of each pair.
        mix: (7, 2 P) float32 the coefficients once more, all inner points before all outer ones: those of
            u for d, w, h, 1, and those of v for w, h, 1. So many points at a time are quick to place.
    """

    inner: Floats
    outer: Floats
    section: NDArray[np.int64]
    mix: Floats


def section_angles(config: ContourConfig) -> dict[int, tuple[float, float]]:
    """Give each section's arc on its ellipse, in radians from the top, positive to the right.

    The head's three arcs cover its ellipse but for the neck; shoulders and sides cover the body's down to
    `side_end_deg`. The sources show the sections in a figure only; these arcs are a reading.
    """
    top, neck = np.radians(config.head_top_deg) / 2, np.pi - np.radians(config.neck_deg) / 2
    shoulder, end = np.radians(config.shoulder_deg), np.radians(config.side_end_deg)
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
    """Lay out the pairs of points of all sections.

    Args:
        config: the contour model.
        size: image height / 240, which scales `reach_px`.
    """
    near, deep = config.reach_px * size, config.inner_depth
    parts: list[tuple[Floats, Floats, int]] = []
    for section, (start, end) in section_angles(config).items():
        # The middles of equal pieces: no point is shared by two sections.
        angle = start + (end - start) * (np.arange(config.points) + 0.5) / config.points
        if section in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT):
            reach = np.resize(config.head_reach, len(angle))
            inner = head_points(angle, config, -deep * reach, -deep * near)
            parts.append((inner, head_points(angle, config, reach, near), section))
            if config.far_head_reach > 0:
                far = np.full(len(angle), config.far_head_reach)
                parts.append((inner, head_points(angle, config, far, near), section))
        else:
            reach = np.resize(config.body_reach, len(angle))
            inner = body_points(angle, -deep * reach, -deep * near)
            parts.append((inner, body_points(angle, reach, near), section))
    if config.feet_weight > 0:
        parts.append((*_feet_points(config), FEET))
    inner = np.concatenate([inner for inner, _, _ in parts])
    outer = np.concatenate([outer for _, outer, _ in parts])
    sections = np.concatenate([np.full(len(inner), section) for inner, _, section in parts])
    points = np.concatenate([inner, outer])
    mix = np.concatenate([points[:, 0], points[:, 1, 1:]], axis=1)
    return Probes(inner, outer, sections, np.ascontiguousarray(mix.T))


def pixels_under(state: Floats, probes: Probes, shape: tuple[int, int]) -> NDArray[np.int32]:
    """Find the pixels nearest to a contour's points (2 P,), all inner ones before all outer ones.

    Args:
        state: (9,) of a person.
        probes: the points.
        shape: (H, W) of the image.

    Returns:
        Number of each pixel, counted row by row; -1 outside the image.
    """
    at = np.empty(probes.mix.shape[1], dtype=np.int32)
    _locate(at, state, probes.mix, shape[1], shape[0])
    return at


def body_points(angle: NDArray[np.float64], grow: NDArray[np.float64], grow_px: float) -> Floats:
    """Give points (K, 2, 4) of the body ellipse with both semi-axes longer by `grow` w + `grow_px`."""
    points = np.zeros((len(angle), 2, 4), dtype=np.float32)
    right, down = np.sin(angle), -np.cos(angle)
    points[:, 0, 1] = (1 + grow) * right
    points[:, 0, 3] = grow_px * right
    points[:, 1, 1] = grow * down
    points[:, 1, 2] = down
    points[:, 1, 3] = grow_px * down
    return points


def head_points(
    angle: NDArray[np.float64], config: ContourConfig, grow: NDArray[np.float64], grow_px: float
) -> Floats:
    """Give points (K, 2, 4) of the head ellipse, both semi-axes longer by `grow` semi-widths + `grow_px`."""
    points = np.zeros((len(angle), 2, 4), dtype=np.float32)
    right, down = np.sin(angle), -np.cos(angle)
    tall = 1 / config.head_divisor
    wide = tall * config.head_aspect
    points[:, 0, 0] = 1.0
    points[:, 0, 2] = wide * (1 + grow) * right
    points[:, 0, 3] = grow_px * right
    points[:, 1, 2] = -(1 + tall) + (tall + grow * wide) * down
    points[:, 1, 3] = grow_px * down
    return points


def _feet_points(config: ContourConfig) -> tuple[Floats, Floats]:
    """Give points (K, 2, 4) above the line under the feet, and below it at two depths, where floor is."""
    across = np.linspace(-config.feet_span, config.feet_span, FEET_COLUMNS)
    points = np.zeros((2, 2, FEET_COLUMNS, 2, 4), dtype=np.float32)
    points[..., 0, 2] = across
    points[0, ..., 1, 2] = config.feet_line - 0.1
    points[1, 0, :, 1, 2] = config.feet_line + 0.1
    points[1, 1, :, 1, 2] = config.feet_line + 0.4
    return points[0].reshape(-1, 2, 4), points[1].reshape(-1, 2, 4)


def build_response(config: ContourConfig) -> Floats:
    """Tabulate (8, 511) what a difference of grey -255..255, inner minus outer, counts in each section."""
    difference = np.arange(1 - GREYS, GREYS, dtype=np.float64)
    response = np.tanh(difference / config.saturation_grey) if config.saturation_grey > 0 else difference
    table = np.tile(response, (SECTIONS, 1))
    # A garment may be colder than what is behind it, feet than sunny ground; a head hardly ever is.
    table[SHOULDER_LEFT:FEET] = np.where(difference < 0, config.cold_response * response, response)
    table[FEET] = np.where(difference < 0, config.cold_feet_response * response, response)
    return table.astype(np.float32)


def section_weights(config: ContourConfig) -> NDArray[np.float64]:
    """Give the weights (8,) of the sections, which sum to 1."""
    weights = np.array([*config.weights, config.feet_weight])
    shares: NDArray[np.float64] = weights / weights.sum()
    return shares


def person_grey(thermal: NDArray[np.uint8], config: ContourConfig) -> NDArray[np.uint8]:
    """Turn what is too hot for a person as dark as the coldest surface, (H, W) in and out.

    Lamps and radiators lose their bright outline that way, and people in front of them regain theirs.
    """
    if config.hottest_grey >= GREYS:
        return np.ascontiguousarray(thermal)
    is_hot = (thermal >= config.hottest_grey).view(np.uint8)
    if not is_hot.any():
        return np.ascontiguousarray(thermal)
    side = 2 * config.hot_margin_px + 1
    return np.where(cv2.dilate(is_hot, np.ones((side, side), np.uint8)), np.uint8(0), thermal)


def section_differences(
    image: NDArray[np.uint8],
    state: Floats,
    probes: Probes,
    response: Floats,
    unseen: float,
    covered: float | None = None,
) -> Floats:
    """Measure the mean response (N, 8) of every section of every sample, D_j of equation 4.3.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        probes: the points to look at.
        response: (8, 511) what a difference counts.
        unseen: what a pair counts with a point outside the image.
        covered: what a pair counts with a point on a person in front; None in an image without such marks.
    """
    return _differences(
        image,
        state,
        probes.mix,
        probes.section,
        response,
        np.float32(unseen),
        NO_GREY if covered is None else COVERED,
        np.float32(0 if covered is None else covered),
    )


@njit(cache=True, fastmath={"contract"}, nogil=True)
def _locate(at: NDArray[np.int32], sample: Floats, mix: Floats, width: int, height: int) -> None:
    """Write the pixels of `pixels_under` into (2 P,): without branches, many points at a time."""
    half, columns, right, bottom = np.float32(0.5), np.int32(width), np.float32(width), np.float32(height)
    x, y, d, w, h = sample[X] + half, sample[Y] + half, sample[D], sample[W], sample[H]
    du, wu, hu, u0, wv, hv, v0 = mix[0], mix[1], mix[2], mix[3], mix[4], mix[5], mix[6]
    for q in range(len(at)):
        u = x + du[q] * d + wu[q] * w + hu[q] * h + u0[q]
        v = y + wv[q] * w + hv[q] * h + v0[q]
        is_inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom)
        at[q] = np.int32(v) * columns + np.int32(u) if is_inside else np.int32(-1)


@njit(cache=True, fastmath={"contract"}, nogil=True)
def _differences(
    image: NDArray[np.uint8],
    state: Floats,
    mix: Floats,
    section: NDArray[np.int64],
    response: Floats,
    unseen: np.float32,
    covered_grey: int,
    covered: np.float32,
) -> Floats:
    share = np.zeros(SECTIONS, dtype=np.float32)
    for j in section:
        share[j] += np.float32(1)
    grey, at = image.reshape(-1), np.empty(mix.shape[1], dtype=np.int32)
    inner, outer = at[: len(section)], at[len(section) :]
    result = np.zeros((len(state), SECTIONS), dtype=np.float32)
    for i in range(len(state)):
        _locate(at, state[i], mix, image.shape[1], image.shape[0])
        for p in range(len(section)):
            j = section[p]
            if inner[p] < 0 or outer[p] < 0:
                result[i, j] += unseen
                continue
            inside, outside = int(grey[inner[p]]), int(grey[outer[p]])
            if inside == covered_grey or outside == covered_grey:
                result[i, j] += covered
            else:
                result[i, j] += response[j, GREYS - 1 + inside - outside]
        for j in range(SECTIONS):
            if share[j] > 0:
                result[i, j] /= share[j]
    return result
