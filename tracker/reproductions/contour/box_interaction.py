"""Boxes of people: conversion from contours, penalties for overlaps, and positions on the floor.

For a camera at height h above the floor, the feet of a person of stature S at distance r are at slope h / r
below the horizon, and the head is at slope (S - h) / r above it. Both give 1 / r: the feet by a row that is
hard to measure, the head by a stature that is unknown. All errors are proportional to the apparent height S /
r, so that the optimal weights of the two are the same at every distance (weighted least squares), and the
error of the distance is a share of it.

In the image of a tilted camera upright people lean, more so farther from the middle. The middle column of a
box is that of the torso; head and feet lie where a plumb line through the torso meets the box's ends.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.small_matrices import solve
from peopleboy.tracker.elementary import exponential, logarithm
from peopleboy.tracker.reproductions.contour.contour_config import BoxConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.particles import CROWN, Floats, H, W, X, Y
from peopleboy.tracker.track import Box, FloorPlace, Status

Regions = Floats
"""(M, 4) left, top, width, height [px] of people."""

Ray = Sequence[float]  # x, y, z of a direction in the robot frame

PERSON_M: Final = 1.72  # height of people

# The values below were chosen on seeds 10 to 12 of the suite `occlusion`.
STATURE_SD_M: Final = 0.09
FOOT_BELOW: Final = 0.02  # distance of the box's lower end below the feet, in box heights
FOOT_SD: Final = 0.057  # standard deviation of the row of the feet, in box heights
HEAD_SD: Final = 0.02  # standard deviation of the row of the head, in box heights
CORRELATION: Final = 0.5  # of the two errors
FARTHEST_M: Final = 30.0

# Chosen on a scene each with cameras that look down by 8 and 18 degrees.
TORSO_ROW: Final = 0.38  # share of the height, from the top, whose column is that of the box
LEAN_SD: Final = 0.1  # its standard deviation, which shifts leaning people, in box heights

PLUMB_M: Final = 0.05  # length of a plumb line, at a depth of 1 m

WIDTH_M: Final = 0.5  # of people without a box
WIDEST_RAD: Final = math.radians(75.0)
NEAREST_M: Final = 0.3

ERRORS: Final = {
    Status.TRACKED: (0.1, 0.0105),
    Status.PARTLY_OCCLUDED: (0.13, 0.021),
    Status.TOTALLY_OCCLUDED: (0.15, 0.026),
    Status.TENTATIVE: (0.15, 0.026),
}
"""Standard deviations of the distance, as a share of it, and of the bearing, in apparent heights."""


def box_of(state: NDArray[np.floating], config: BoxConfig) -> Box:
    """Return the box left, top, width, height [px] of a contour (9,).

    The top is that of the head, and the centre column is that of the body.

    Source: thesis, section 3.4 (2 w by 3.5 h); paper, section 4.1 (2 w by 3 h).
    """
    x, y, w, h = (float(state[k]) for k in (X, Y, W, H))
    width_per_w, height_per_h, top_per_h = _proportions(config)
    width = width_per_w * w
    return x - width / 2, y - top_per_h * h, width, height_per_h * h


def regions_of(states: Sequence[NDArray[np.floating]], config: TrackerConfig) -> Regions:
    """Return the rectangles (M, 4) [px] of people with these (9,) states."""
    state = np.asarray(states, dtype=np.float32).reshape(-1, 9)
    return _regions(state, *_proportions(config.box))


def overlap_shares(state: Floats, regions: Regions, config: TrackerConfig) -> Floats:
    """Return g_ij (N, M): the share of the rectangle of sample i inside region j.

    Source: thesis, section 5.2, "the amount of overlap between particle i and region j", read as a share of
    the sample's own area.
    """
    return shared_parts(_regions(state, *_proportions(config.box)), regions)


def detector_factor(state: Floats, regions: Regions, config: TrackerConfig) -> Floats:
    """Return the factor (N,) on a detector's samples: psi_D, once, for samples that overlap a person.

    The overlap is the intersection of sample and region as a share of the smaller of the two.

    Source: thesis, equation 5.1.
    """
    samples, interaction = _regions(state, *_proportions(config.box)), config.interaction
    factor: Floats = _kept_off(samples, regions, interaction.detector_overlap, interaction.detector_penalty)
    return factor


def person_factor(shares: Floats, strength: NDArray[np.floating]) -> Floats:
    """Return the factor (N,) on a person's samples: exp(-rho_j g_ij) for the region with the largest penalty.

    A sample that overlaps several regions is penalised only once.

    Args:
        shares: (N, M) overlaps with other people.
        strength: (M,) rho for each of them.

    Source: thesis, equations 5.3 and 7.5.
    """
    if shares.shape[1] == 0:
        return np.ones(len(shares), dtype=np.float32)
    factor: Floats = _dearest_factor(shares, strength.astype(np.float32))
    return factor


def places_on_floor(
    boxes: Sequence[Box], statuses: Sequence[Status], calibration: Calibration
) -> list[FloorPlace]:
    """Return the positions of K people on the floor, from head and feet of their boxes [px].

    Args:
        boxes: left, top, width, height of each.
        statuses: visibility of each, which determines the uncertainty.
        calibration: of the boxes' camera.
    """
    ends, leans = _ends(np.array(boxes).reshape(-1, 4), calibration)
    rays = calibration.rays(ends).tolist()
    places = []
    for head, foot, lean, status in zip(rays[::2], rays[1::2], leans, statuses, strict=True):
        along, across = ERRORS[status]
        places.append(_place(head, foot, along, math.hypot(across, LEAN_SD * lean), calibration.position_m))
    return places


def standing_box(place: FloorPlace, calibration: Calibration) -> Box:
    """Return left, top, width, height [px] of an upright person at a position; it may lie outside the image.

    People far to the side, or behind the camera, are placed at `WIDEST_RAD` on that side.
    """
    camera_x, camera_y, _ = calibration.position_m
    forward, aside = place.position_m[0] - camera_x, place.position_m[1] - camera_y
    away = max(math.hypot(forward, aside), NEAREST_M)
    bearing = max(-WIDEST_RAD, min(math.atan2(aside, forward), WIDEST_RAD))
    x, y = camera_x + away * math.cos(bearing), camera_y + away * math.sin(bearing)
    (head, top), (foot, bottom) = calibration.project(np.array([[x, y, PERSON_M], [x, y, 0.0]])).tolist()
    width = (bottom - top) * WIDTH_M / PERSON_M
    return head + TORSO_ROW * (foot - head) - width / 2.0, top, width, bottom - top


def _ends(boxes: NDArray[np.float64], calibration: Calibration) -> tuple[NDArray[np.float64], list[float]]:
    """Return the pixels (2 K, 2) of head and feet of people with boxes (K, 4), and their leaning (K)."""
    left, top, width, height = boxes.T
    middle, foot = left + width / 2.0, top + (1.0 - FOOT_BELOW) * height
    torso = top + TORSO_ROW * (foot - top)
    lean = _lean(np.column_stack([middle, torso]), calibration)
    head_column, foot_column = (middle + lean * (row - torso) for row in (top, foot))
    ends = np.column_stack([head_column, top, foot_column, foot]).reshape(-1, 2)
    return ends, lean.tolist()


def _lean(pixels: NDArray[np.float64], calibration: Calibration) -> NDArray[np.float64]:
    """Return the slope (K,), in columns per row, of a plumb line through pixels (K, 2)."""
    here = calibration.rays(pixels) + calibration.position_m
    plumb = np.array([0.0, 0.0, PLUMB_M])
    below, above = (calibration.project(here + way) for way in (-plumb, plumb))
    across, down = (below - above).T
    lean: NDArray[np.float64] = np.divide(across, down, out=np.zeros(len(pixels)), where=down > 0.0)
    return lean


def _place(
    head: Ray, foot: Ray, along_share: float, across_share: float, camera_m: tuple[float, float, float]
) -> FloorPlace:
    """Return the position of a person whose head and feet are on two rays."""
    x, y, up = camera_m
    ahead, aside, _ = foot
    away = math.hypot(ahead, aside)
    cosine, sine = ahead / away, aside / away
    head_slope, foot_slope = head[2] / math.hypot(head[0], head[1]), foot[2] / away
    foot_weight, head_weight = _weights(up)
    nearness = head_weight * head_slope - foot_weight * foot_slope
    distance = 1.0 / max(nearness, 1.0 / FARTHEST_M)
    along = (along_share * distance) ** 2
    across = (across_share * (head_slope - foot_slope) * distance) ** 2
    return FloorPlace(
        position_m=(x + distance * cosine, y + distance * sine),
        covariance_m2=(
            along * cosine**2 + across * sine**2,
            (along - across) * sine * cosine,
            along * sine**2 + across * cosine**2,
        ),
    )


@lru_cache(maxsize=16)
def _weights(camera_height_m: float) -> tuple[float, float]:
    """Return the weights of the slopes to the feet and to the head that sum to 1 / distance [1/m]."""
    covariance = np.array(
        [
            [FOOT_SD**2, CORRELATION * FOOT_SD * HEAD_SD],
            [CORRELATION * FOOT_SD * HEAD_SD, HEAD_SD**2 + (STATURE_SD_M / PERSON_M) ** 2],
        ]
    )
    slopes = np.array([camera_height_m, PERSON_M - camera_height_m])  # at a distance of 1 m
    certain = solve(covariance, slopes)
    foot, head = (certain / (certain @ slopes)).tolist()
    return foot, head


def _proportions(box: BoxConfig) -> tuple[float, float, float]:
    """Return width per w, height per h, and the height of the top above the centre in h."""
    return box.width_per_w, box.height_per_h, CROWN + box.hair_per_h


@njit(cache=True, nogil=True)
def _regions(state: Floats, width_per_w: float, height_per_h: float, top_per_h: float) -> Regions:
    regions = np.empty((len(state), 4), dtype=np.float32)
    for i in range(len(state)):
        width = width_per_w * state[i, W]
        regions[i, 0] = state[i, X] - width / 2
        regions[i, 1] = state[i, Y] - top_per_h * state[i, H]
        regions[i, 2] = width
        regions[i, 3] = height_per_h * state[i, H]
    return regions


@njit(cache=True, nogil=True, error_model="numpy")
def _kept_off(samples: Regions, regions: Regions, overlap: float, penalty: float) -> Floats:
    """Return 1, or the penalty, (N,) for samples whose overlap with any region (M, 4) exceeds a share."""
    factor, most = np.ones(len(samples), dtype=np.float32), np.float32(overlap)
    for i in range(len(samples)):
        left, top, width, height = samples[i]
        for j in range(len(regions)):
            across = min(left + width, regions[j, 0] + regions[j, 2]) - max(left, regions[j, 0])
            down = min(top + height, regions[j, 1] + regions[j, 3]) - max(top, regions[j, 1])
            if not (across > 0 and down > 0):
                continue
            if across * down / min(width * height, regions[j, 2] * regions[j, 3]) > most:
                factor[i] = penalty
                break
    return factor


@njit(cache=True, nogil=True)
def _dearest_factor(shares: Floats, strength: Floats) -> Floats:
    """Return the exponential (N,) of minus the largest of shares (N, M) times strengths (M,)."""
    factor = np.empty(len(shares), dtype=np.float32)
    for i in range(len(shares)):
        cost = shares[i, 0] * strength[0]
        for j in range(1, shares.shape[1]):
            cost = max(cost, shares[i, j] * strength[j])
        factor[i] = exponential(-cost)
    return factor


@njit(cache=True, nogil=True, error_model="numpy")
def size_factor(state: Floats, height: float, spread: float) -> Floats:
    """Penalise samples (N, 9) by the log ratio of their h [px] to a known one, (N,)."""
    factor, known, sharp = np.empty(len(state), np.float32), np.float32(height), np.float32(-0.5 / spread**2)
    for i in range(len(state)):
        growth = logarithm(max(state[i, H], np.float32(1)) / known)
        factor[i] = exponential(sharp * growth * growth)
    return factor


@njit(cache=True, nogil=True)
def shared_parts(samples: Regions, regions: Regions) -> Floats:
    """Return (N, M) the shares of the areas of rectangles (N, 4) inside regions (M, 4)."""
    shares = np.zeros((len(samples), len(regions)), dtype=np.float32)
    for i in range(len(samples)):
        left, top, width, height = samples[i]
        if width <= 0 or height <= 0:
            continue
        for j in range(len(regions)):
            across = min(left + width, regions[j, 0] + regions[j, 2]) - max(left, regions[j, 0])
            down = min(top + height, regions[j, 1] + regions[j, 3]) - max(top, regions[j, 1])
            if across > 0 and down > 0:
                shares[i, j] = across * down / (width * height)
    return shares
