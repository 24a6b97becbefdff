"""From angles in webcams to a place on the floor, and from known places to the webcams' own (2003 paper)."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from peopleboy.bad_input import BadInput

Floats = NDArray[np.float64]

LEAST_ANGLE_RAD: Final = math.radians(10.0)  # between two lines of sight; flatter ones meet anywhere
X, Y, HEADING, RANGE = range(4)
"""Columns of the webcams' numbers: x, y [m], heading and angle of view [rad], counter-clockwise."""


def bearings(columns: Floats, webcams: Floats, width: int) -> Floats:
    """Turn hats' columns (..., C) [px] into angles (..., C) [rad] in the room; NaN stays NaN.

    Args:
        columns: one per webcam.
        webcams: (C, 4).
        width: of the images [px].
    """
    focal = width / 2.0 / np.tan(webcams[:, RANGE] / 2.0)
    return np.asarray(webcams[:, HEADING] + np.arctan2((width - 1) / 2.0 - columns, focal))


def triangulate(angles: Floats, webcams: Floats) -> Floats:
    """Find the places (T, 2) [m] that angles (T, C) [rad] point at; NaN where no two webcams do.

    Every pair of webcams that sees the hat gives a point. The paper does not say how they are put together:
    here by their mean, weighted by the squared sine of the angle at which their lines meet.
    """
    total, weight = np.zeros((len(angles), 2)), np.zeros(len(angles))
    for a, b in combinations(range(len(webcams)), 2):
        one, other = angles[:, a], angles[:, b]
        sine = np.sin(other - one)
        between = webcams[b, :2] - webcams[a, :2]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (between[0] * np.sin(other) - between[1] * np.cos(other)) / sine
        point = webcams[a, :2] + along[:, None] * np.stack([np.cos(one), np.sin(one)], axis=1)
        counts = np.where(np.abs(sine) >= math.sin(LEAST_ANGLE_RAD), sine**2, 0.0)
        is_known = np.isfinite(point).all(axis=1) & (counts > 0.0)
        total[is_known] += counts[is_known, None] * point[is_known]
        weight[is_known] += counts[is_known]
    with np.errstate(invalid="ignore"):
        return np.asarray(total / np.where(weight > 0.0, weight, np.nan)[:, None])


def calibrate(columns: Floats, known_m: Floats, guess: Floats, width: int) -> Floats:
    """Fit the 16 numbers of four webcams, (C, 4), to hats' columns (T, C) at known places (T, 2) [m].

    Source: 2003 paper, section 4: the mean distance of the triangulated places from the known ones is made as
    small as it can be; here that of their squares.

    Raises:
        BadInput: a webcam never sees the hat, or there are fewer known places than the fit needs.
    """
    for number, seen in enumerate(np.isfinite(columns).sum(axis=0)):
        if seen < len(guess[0]):
            raise BadInput(f"webcam {number + 1}: sees the hat at {seen} known places; 4 are needed")

    def residuals(flat: Floats) -> Floats:
        webcams = flat.reshape(guess.shape)
        found = triangulate(bearings(columns, webcams, width), webcams)
        return np.nan_to_num(found - known_m, nan=1.0).ravel()

    return np.asarray(least_squares(residuals, guess.ravel(), x_scale=0.1).x.reshape(guess.shape))
