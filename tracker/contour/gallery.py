"""Who a newly found person is: a person new, or one of those who were lost from sight."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from peopleboy.tracker.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.particle_filter import FrameView
from peopleboy.tracker.contour.particles import H, X, Y
from peopleboy.tracker.contour.tracked_person import TrackedPerson

PLACE_PX = 12.0  # [px] of 240 rows: spread of the place of a person who was just lost
PLACE_PX_S = 40.0  # [px/s] by which it grows
FARTHEST = 5.0  # square that place counts at most: people turn back, and come in by another door
LOOKS2 = 12.0  # squared distance of appearance of the same person, where they are not known
# Logistic regression over reappearances in the data sets and the library, of the same person and of others.
PLACE_WEIGHT = 0.56
APPEARANCE_WEIGHT = 1.76
WORST = 6.8
GROWTH = 0.7  # largest change of the logarithm of the height
COMPARED = 0.5  # share of a known appearance that must be visible to compare it


def least_mismatch(
    found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> TrackedPerson | None:
    """Return the lost person of the lowest cost; None if the cost is too high."""
    costs = [mismatch(found, person, view, config) for person in lost]
    best = int(np.argmin(costs))
    return lost[best] if costs[best] < WORST else None


def is_comparable(found: TrackedPerson, lost: TrackedPerson) -> bool:
    """Return whether enough of a newly found person is visible to compare it with a lost one.

    The colour camera sees less to the sides than the thermal one, and heat alone is much the same in all.
    """
    if found.appearance is None or lost.appearance is None:
        return True
    is_known = ~np.isnan(lost.appearance.mean)
    is_seen = is_known & ~np.isnan(found.appearance.mean)
    return bool(is_seen.sum() >= COMPARED * is_known.sum())


def most_alike_and_nearest(found: TrackedPerson, lost: Sequence[TrackedPerson]) -> TrackedPerson | None:
    """Take the nearest of those who were lost if nobody else's colours are more like the found one's.

    Source: thesis, section 7.3.
    """
    nearest = min(lost, key=lambda person: float(np.hypot(*(person.shown - found.shown)[[X, Y]])))
    alike = min(lost, key=lambda person: colour_distance(found, person))
    return nearest if nearest is alike else None


def colour_distance(one: TrackedPerson, other: TrackedPerson) -> float:
    """Measure the squared distance of colours; infinite where there are none."""
    if one.appearance is None or other.appearance is None:
        return float("inf")
    distance = float(squared_distances(one.appearance.mean[None], other.appearance)[0])
    return float("inf") if np.isnan(distance) else distance


def mismatch(found: TrackedPerson, person: TrackedPerson, view: FrameView, config: TrackerConfig) -> float:
    """Add up what speaks against one being the other: their places, and their appearance.

    The logarithm takes into account that the appearance in another pose, or half occluded, can be far off.
    """
    if abs(np.log(max(found.shown[H], 1.0) / max(person.shown[H], 1.0))) > GROWTH:
        return math.inf
    place = (PLACE_PX + PLACE_PX_S * person.hidden_s) * view.size
    away = (found.shown - person.shown)[[X, Y]] / place
    appearance = appearance_distance(found, person, config)
    return PLACE_WEIGHT * min(float(away @ away), FARTHEST) + APPEARANCE_WEIGHT * float(np.log1p(appearance))


def appearance_distance(found: TrackedPerson, person: TrackedPerson, config: TrackerConfig) -> float:
    """Measure the squared distance of appearance; that of the same person where appearance is unknown."""
    if config.appearance is None or found.appearance is None or person.appearance is None:
        return LOOKS2
    distance = float(squared_distances(found.appearance.mean[None], person.appearance)[0])
    return LOOKS2 if np.isnan(distance) else distance
