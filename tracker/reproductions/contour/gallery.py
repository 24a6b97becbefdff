"""Re-identification of newly found people among those who were lost."""

import math
from collections.abc import Sequence

import numpy as np

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView
from peopleboy.tracker.reproductions.contour.particles import H, X, Y
from peopleboy.tracker.reproductions.contour.tracked_person import TrackedPerson

PLACE_PX = 12.0  # [px] of 240 rows: standard deviation of the position of a just lost person
PLACE_PX_S = 40.0  # [px/s] of its growth
FARTHEST = 5.0  # limit of the squared distance of positions: people turn back, and come in by another door
LOOKS2 = 12.0  # squared distance of appearance of the same person, where it is unknown
# Logistic regression over reappearances of the same person and of others, in the data sets and the library.
PLACE_WEIGHT = 0.56
APPEARANCE_WEIGHT = 1.76
WORST = 6.8
GROWTH = 0.7  # greatest change of the logarithm of the height
COMPARED = 0.5  # least visible share of a known appearance for a comparison


def least_mismatch(
    found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> TrackedPerson | None:
    """Return the lost person of the lowest cost; None if the cost is too high."""
    costs = [mismatch(found, person, view, config) for person in lost]
    best = int(np.argmin(costs))
    return lost[best] if costs[best] < WORST else None


def is_comparable(found: TrackedPerson, lost: TrackedPerson) -> bool:
    """Return whether enough of a newly found person is visible for a comparison with a lost one.

    The colour camera has a narrower view than the thermal one, whose patterns are similar for all people.
    """
    if found.appearance is None or lost.appearance is None:
        return True
    is_known = ~np.isnan(lost.appearance.mean)
    is_seen = is_known & ~np.isnan(found.appearance.mean)
    return bool(is_seen.sum() >= COMPARED * is_known.sum())


def most_alike_and_nearest(found: TrackedPerson, lost: Sequence[TrackedPerson]) -> TrackedPerson | None:
    """Return the nearest lost person, unless another person's colours are more similar.

    Source: thesis, section 7.3.
    """
    nearest = min(lost, key=lambda person: float(np.hypot(*(person.shown - found.shown)[[X, Y]])))
    alike = min(lost, key=lambda person: colour_distance(found, person))
    return nearest if nearest is alike else None


def colour_distance(one: TrackedPerson, other: TrackedPerson) -> float:
    """Return the squared distance of colours; infinite without colours."""
    if one.appearance is None or other.appearance is None:
        return float("inf")
    distance = float(squared_distances(one.appearance.mean[None], other.appearance)[0])
    return float("inf") if np.isnan(distance) else distance


def mismatch(found: TrackedPerson, person: TrackedPerson, view: FrameView, config: TrackerConfig) -> float:
    """Return the cost of two people being the same, from positions and appearance.

    The logarithm limits the effect of another pose or partial occlusion on the appearance.
    """
    if abs(np.log(max(found.shown[H], 1.0) / max(person.shown[H], 1.0))) > GROWTH:
        return math.inf
    place = (PLACE_PX + PLACE_PX_S * person.hidden_s) * view.size
    away = (found.shown - person.shown)[[X, Y]] / place
    appearance = appearance_distance(found, person, config)
    return PLACE_WEIGHT * min(float(away @ away), FARTHEST) + APPEARANCE_WEIGHT * float(np.log1p(appearance))


def appearance_distance(found: TrackedPerson, person: TrackedPerson, config: TrackerConfig) -> float:
    """Return the squared distance of appearance; if unknown, that of the same person."""
    if config.appearance is None or found.appearance is None or person.appearance is None:
        return LOOKS2
    distance = float(squared_distances(found.appearance.mean[None], person.appearance)[0])
    return LOOKS2 if np.isnan(distance) else distance
