"""One person's view: who is in front, and what can be seen of the person itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.colour_model import ColourModel, squared_distances
from peopleboy.tracker.thermal.appearance.part_appearance import visible
from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.contour.contour import SECTIONS
from peopleboy.tracker.thermal.contour.coverage import body_share, head_share, seen_shares
from peopleboy.tracker.thermal.contour.likelihood import probability
from peopleboy.tracker.thermal.filter.particles import Floats, H
from peopleboy.tracker.thermal.interaction import overlap_shares, regions_of
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.thermal.tracked_person import TrackedPerson

CLEAR = 0.5  # share of head and body in view from which a hidden person may be seen again

CLAIMED = 0.5  # share of its region that another person must have left free


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """The others, as one person's filter sees them.

    Attributes:
        front: those in front who overlap the person, as they are in this frame.
        others: everybody else who is seen, those in front first: their regions (M, 4) [px].
        strength: (M,) rho of equation 5.3 towards each.
        image: (H, W) with the people in front marked as covered.
    """

    front: tuple[TrackedPerson, ...]
    others: Floats
    strength: NDArray[np.float64]
    image: NDArray[np.uint8]

    @property
    def rivals(self) -> Floats:
        """Regions of those who are seen and not in front."""
        return self.others[len(self.front) :]


@dataclass(frozen=True, slots=True)
class Visibility:
    """What can be seen of a person at its estimate.

    Attributes:
        head: share of the head's contour that is in view.
        body: share of the whole contour.
        confidence: probability by what is in view alone.
        is_free: whether nobody else is seen there.
        is_alike: whether what is in view has the person's height, and its looks as far as they are known.
    """

    head: float
    body: float
    confidence: float
    is_free: bool
    is_alike: bool

    @property
    def is_clear(self) -> bool:
        """Whether most of the right person is in view."""
        return min(self.head, self.body) > CLEAR and self.is_alike and self.is_free


def look_at(
    person: TrackedPerson, belief: Belief, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> Visibility:
    """Judge a person by what is in view of it alone."""
    rows = belief.estimate.astype(np.float32)[None]
    image = surroundings.image if surroundings.front else view.image
    shares = (
        seen_shares(image, belief.estimate, view.model.probes) if surroundings.front else np.ones(SECTIONS)
    )
    differences = view.model.differences(image, rows, 0.0 if surroundings.front else None)
    seen = float(shares @ view.model.weights)
    fit = differences[0] @ view.model.weights / max(seen, 1e-3)
    chance = float(probability(np.array([fit], dtype=np.float32), config.likelihood)[0])
    model, features = appearance(person), describe(rows, surroundings.front, view, config)
    away = np.nan
    if model is not None and features is not None:
        away = float(squared_distances(features, model)[0])
    growth = abs(np.log(max(belief.estimate[H], 1.0) / max(person.shown[H], 1.0)))
    is_alike = growth < config.occlusion.size_gate and not away > config.occlusion.colour_gate
    is_free = not (overlap_shares(rows, surroundings.rivals, config) > CLAIMED).any()
    return Visibility(head_share(shares), body_share(shares), chance, is_free, is_alike)


def appearance(person: TrackedPerson) -> ColourModel | None:
    """Give what a person's samples are compared with."""
    return person.colour if person.appearance is None else person.appearance


def describe(
    state: Floats, front: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> Floats | None:
    """Describe people (N, 9) as their models do, (N, F); NaN for parts that people in front hide."""
    source = view.colour if view.appearance is None else view.appearance
    if source is None:
        return None
    hiding = regions_of([other.belief.estimate for other in front], config)
    return visible(source.describe(state), state, hiding)
