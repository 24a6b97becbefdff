"""The depth order of people, as expected before the image is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.contour.box_interaction import Regions, overlap_shares, regions_of, shared_parts
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.measurement.likelihood import covered_by
from peopleboy.tracker.contour.particle_filter import FrameView
from peopleboy.tracker.contour.particles import STATE_SIZE, Floats
from peopleboy.tracker.contour.tracked_person import TrackedPerson, moved_on

FOOT_PX = 4.0  # [px] of 240 rows: difference of foot rows that counts 1
APPEARANCE = 12.0  # difference of squared distances of appearance that counts 1
MOST = 4.0  # for which appearance counts at most

Leads = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedPerson:
    """A person as expected in this frame, before the image is measured.

    Attributes:
        person: as the last frame left it.
        state: (9,) where it should be by now.
        region: (4,) left, top, width, height [px] of that.
        unlikeness: squared distance of what is seen there from the person's own; 0 where nothing is known.
    """

    person: TrackedPerson
    state: NDArray[np.float64]
    region: Regions
    unlikeness: float = 0.0


def expected(
    persons: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> list[ExpectedPerson]:
    """Predict where people are in this frame, and compare what is seen there with what is known of them."""
    states = [
        moved_on(person.shown if person.is_hidden else person.belief.estimate, view) for person in persons
    ]
    unlikeness = [0.0] * len(persons)
    if config.depth.order == "appearance" and view.appearance is not None and len(persons) > 1:
        features = view.appearance.describe(np.array(states, dtype=np.float32).reshape(-1, STATE_SIZE))
        unlikeness = [_unlikeness(*each) for each in zip(persons, features, strict=True)]
    regions = regions_of(states, config)
    return [ExpectedPerson(*each) for each in zip(persons, states, regions, unlikeness, strict=True)]


def _unlikeness(person: TrackedPerson, features: Floats) -> float:
    if person.appearance is None:
        return 0.0
    distance = float(squared_distances(features[None], person.appearance)[0])
    return 0.0 if np.isnan(distance) else distance


class Order(Protocol):
    """Compares people with each other."""

    def __call__(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
        """Return which of M people is in front of which.

        Returns:
            (M, M) how clearly the row's person is in front of the column's: positive if it is, negative if
            the other is; 0 if they do not overlap, or nobody knows.
        """
        ...


def lower_foot(figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:  # noqa: ARG001
    """Take those whose feet are lower in the image for the nearer ones: all stand on one floor."""
    return _leads([figure.person.foot for figure in figures])


def likelier_front(figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
    """Weigh up whose feet are lower and whose appearance is seen where it is expected.

    Where two people overlap, the image shows the appearance of the one in front; the one behind looks wrong.
    """
    clearer = -_leads([figure.unlikeness for figure in figures]) / APPEARANCE
    bounded: Leads = np.minimum(np.maximum(clearer, -MOST), MOST)
    return lower_foot(figures, view) / (FOOT_PX * view.size) + bounded


def _leads(values: Sequence[float]) -> Leads:
    value = np.array(values, dtype=np.float64)
    return value[:, None] - value[None]


def sorted_by_lead(lead: Leads) -> tuple[int, ...]:
    """Sort M people from front to back by their leads over each other.

    A person with nobody in front comes first, and so on with the rest. Where leads form a circle, the one
    with the fewest in front comes first, then the one with the larger sum of leads over the rest, then the
    lower number. So the result never depends on the sequence of the comparisons.

    Args:
        lead: (M, M) of the row's person over the column's; 0 where they do not overlap, or nobody knows.

    Source: thesis, section 7.1, which leaves circles open.
    """
    leads: list[list[float]] = lead.tolist()
    rest = list(range(len(leads)))
    order: list[int] = []
    while rest:
        over = {i: [leads[i][j] for j in rest] for i in rest}
        first = min(rest, key=lambda i: (sum(each < 0 for each in over[i]), -sum(over[i]), i))
        rest.remove(first)
        order.append(first)
    return tuple(order)


ORDERS: Mapping[str, Order] = {"foot": lower_foot, "appearance": likelier_front}
"""Ways to compare by name."""


@dataclass(frozen=True, slots=True, eq=False)
class OrderContext:
    """The others, as one person's filter sees them.

    Attributes:
        front: those in front who overlap the person, as they are in this frame.
        others: everybody else who is seen, those in front first: their regions (M, 4) [px].
        strength: (M,) rho of equation 5.3 towards each.
        image: (H, W) with the people in front marked as covered, if there are any.
    """

    front: tuple[TrackedPerson, ...]
    others: Regions
    strength: NDArray[np.float64]
    image: NDArray[np.uint8]

    @property
    def hiding(self) -> Regions:
        """Regions of those in front."""
        return self.others[: len(self.front)]

    @property
    def rivals(self) -> Regions:
        """Regions of those who are seen and not in front."""
        return self.others[len(self.front) :]

    def occluder(self, state: NDArray[np.float64], config: TrackerConfig) -> TrackedPerson | None:
        """Find the one of those in front who covers most of a person with this state (9,)."""
        if not self.front:
            return None
        shares = overlap_shares(state.astype(np.float32)[None], self.hiding, config)[0]
        return self.front[int(np.argmax(shares))]


def surroundings_of(
    figure: ExpectedPerson,
    ahead: Sequence[tuple[TrackedPerson, Regions]],
    behind: Sequence[ExpectedPerson],
    view: FrameView,
    config: TrackerConfig,
) -> OrderContext:
    """Sort the others into those that occlude this person and those that it must keep clear of.

    Args:
        figure: the person.
        ahead: who was looked at before, and the region of each in this frame.
        behind: who is looked at later.
        view: this frame.
        config: of the tracker.
    """
    near = [each for each in ahead if not each[0].is_hidden]
    later = [other.region for other in behind if not other.person.is_hidden]
    is_front = [False] * len(near)
    if near and config.depth.order is not None:
        regions = np.array([region for _, region in near])
        is_front = (shared_parts(figure.region[None], regions)[0] > 0).tolist()
    front = tuple(person for (person, _), hides in zip(near, is_front, strict=True) if hides)
    hiding = [region for (_, region), hides in zip(near, is_front, strict=True) if hides]
    rivals = [region for (_, region), hides in zip(near, is_front, strict=True) if not hides] + later
    interaction, image = config.interaction, view.image
    if front:
        states = [person.belief.estimate for person in front]
        image = covered_by(image, states, config.depth.growth)
    return OrderContext(
        front=front,
        others=np.array(hiding + rivals, dtype=np.float32).reshape(-1, 4),
        strength=np.array([interaction.occluded_penalty] * len(hiding) + [interaction.penalty] * len(rivals)),
        image=image,
    )
