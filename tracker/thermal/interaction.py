"""The boxes of people, how much they overlap, and what an overlap costs a sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import BoxConfig, InteractionConfig, TrackerConfig
from peopleboy.tracker.thermal.particles import CROWN, Floats, H, W, X, Y

Box = tuple[float, float, float, float]
Regions = Floats
"""(M, 4) left, top, width, height [px] of people."""


def box_of(state: NDArray[np.floating], config: BoxConfig) -> Box:
    """Give the box left, top, width, height [px] of a contour (9,).

    Its top is the top of the head, its centre column the body's.

    Source: thesis, section 3.4 (2 w by 3.5 h); paper, section 4.1 (2 w by 3 h).
    """
    x, y, w, h = (float(state[k]) for k in (X, Y, W, H))
    width_per_w, height_per_h, top_per_h = _proportions(config)
    width = width_per_w * w
    return x - width / 2, y - top_per_h * h, width, height_per_h * h


def regions_of(states: Sequence[NDArray[np.floating]], config: TrackerConfig) -> Regions:
    """Give the rectangles (M, 4) [px] that people with these (9,) states take."""
    state = np.asarray(states, dtype=np.float32).reshape(-1, 9)
    return _regions(state, *_proportions(config.box))


def overlap_shares(state: Floats, regions: Regions, config: TrackerConfig) -> Floats:
    """Measure g_ij (N, M): the share of the rectangle of sample i that lies in region j.

    Source: thesis, section 5.2, "the amount of overlap between particle i and region j", which is read as a
    share of the sample's own area.
    """
    return _shares(_regions(state, *_proportions(config.box)), regions)


def least_overlaps(state: Floats, regions: Regions, config: TrackerConfig) -> Floats:
    """Measure (N, M) the intersection of a sample and a region as a share of the smaller of the two."""
    samples = _regions(state, *_proportions(config.box))
    return np.maximum(_shares(samples, regions), _shares(regions, samples).T)


def detector_factor(shares: Floats, config: InteractionConfig) -> Floats:
    """Give the factor (N,) on a detector's samples: psi_D, once, for those that overlap anybody.

    Source: thesis, equation 5.1.
    """
    overlaps = (shares > config.detector_overlap).any(axis=1)
    return np.where(overlaps, np.float32(config.detector_penalty), np.float32(1))


def person_factor(shares: Floats, strength: NDArray[np.floating]) -> Floats:
    """Give the factor (N,) on a person's samples: exp(-rho_j g_ij) for the region that costs it most.

    A sample that overlaps several regions is penalised only once.

    Args:
        shares: (N, M) overlaps with the other people.
        strength: (M,) rho towards each of them.

    Source: thesis, equations 5.3 and 7.5.
    """
    if shares.shape[1] == 0:
        return np.ones(len(shares), dtype=np.float32)
    costs = shares.T * strength.astype(np.float32)[:, None]
    factor: Floats = np.exp(-np.ascontiguousarray(costs).max(axis=0))
    return factor


def _proportions(box: BoxConfig) -> tuple[float, float, float]:
    """Give width per w, height per h, and how many h the top lies above the centre."""
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


@njit(cache=True, nogil=True)
def _shares(samples: Regions, regions: Regions) -> Floats:
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
