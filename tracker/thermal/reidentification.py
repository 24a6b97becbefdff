"""Who a newly found person is: somebody new, or one of those who were lost from sight."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from peopleboy.tracker.thermal.appearance.colour_model import squared_distances
from peopleboy.tracker.thermal.appearance.part_appearance import knows_colour
from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.filter.particles import VW, VX, H, X, Y
from peopleboy.tracker.thermal.particle_filter import FrameView
from peopleboy.tracker.thermal.tracked_person import TrackedPerson, moved_on

PLACE_PX = 12.0  # [px] of 240 rows: spread of the place of a person who was just lost
PLACE_PX_S = 40.0  # [px/s] by which it grows
FARTHEST = 5.0  # square that place counts at most: people turn back, and come in by another door
LOOKS2 = 12.0  # squared distance of looks of the same person, where they are not known
# Logistic regression over reappearances in the data sets and the library, of the same person and of others.
PLACE_WEIGHT = 0.56
LOOKS_WEIGHT = 1.76
WORST = 6.8
GROWTH = 0.7  # largest change of the logarithm of the height


def remembered(
    person: TrackedPerson, view: FrameView, leaders: Sequence[TrackedPerson], config: TrackerConfig
) -> TrackedPerson:
    """Carry on the memory of a person of whom nothing is seen.

    Source: thesis, section 7.3: it is where its occluder is; ours: it walks on.
    """
    shown = moved_on(person.shown, view)
    shown[VW:] = 0.0
    if config.occlusion.keeps_velocity:
        shown[VX:] *= 0.96
    else:
        shown = next((leader.shown for leader in leaders if leader.id == person.occluder), shown)
    return replace(
        person,
        shown=shown,
        hidden_s=person.hidden_s + view.dt_s,
        hidden_frames=person.hidden_frames + 1,
    )


def recognised(
    found: TrackedPerson, memories: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> TrackedPerson | None:
    """Find the remembered person who is the found one; None if nobody is."""
    if not memories:
        return None
    if config.occlusion.keeps_velocity:
        costs = [mismatch(found, person, view, config) for person in memories]
        best = int(np.argmin(costs))
        return memories[best] if costs[best] < WORST else None
    return most_alike_and_nearest(found, memories)


def most_alike_and_nearest(found: TrackedPerson, memories: Sequence[TrackedPerson]) -> TrackedPerson | None:
    """Take the nearest remembered person if none other's colours are more like those of the found one.

    Source: thesis, section 7.3.
    """
    nearest = min(memories, key=lambda person: float(np.hypot(*(person.shown - found.shown)[[X, Y]])))
    alike = min(memories, key=lambda person: colour_distance(found, person))
    return nearest if nearest is alike else None


def colour_distance(one: TrackedPerson, other: TrackedPerson) -> float:
    """Measure the squared distance of colours; infinite where there are none."""
    if one.colour is None or other.colour is None:
        return float("inf")
    distance = float(squared_distances(one.colour.mean[None], other.colour)[0])
    return float("inf") if np.isnan(distance) else distance


def mismatch(found: TrackedPerson, person: TrackedPerson, view: FrameView, config: TrackerConfig) -> float:
    """Add up what speaks against one being the other: their places, and their looks.

    The logarithm takes into account that looks in another pose, or half hidden, can be far off.
    """
    if abs(np.log(max(found.shown[H], 1.0) / max(person.shown[H], 1.0))) > GROWTH:
        return math.inf
    place = (PLACE_PX + PLACE_PX_S * person.hidden_s) * view.size
    away = (found.shown - person.shown)[[X, Y]] / place
    appearance = appearance_distance(found, person, config)
    return PLACE_WEIGHT * min(float(away @ away), FARTHEST) + LOOKS_WEIGHT * float(np.log1p(appearance))


def appearance_distance(found: TrackedPerson, person: TrackedPerson, config: TrackerConfig) -> float:
    """Measure the squared distance of looks; that of the same person where looks cannot tell."""
    if config.appearance is None or found.appearance is None or person.appearance is None:
        return LOOKS2
    if config.appearance.needs_colour and not knows_colour(found.appearance.mean):
        return LOOKS2
    distance = float(squared_distances(found.appearance.mean[None], person.appearance)[0])
    return LOOKS2 if np.isnan(distance) else distance
