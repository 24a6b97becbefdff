"""Depth order of people, predicted before the image is measured."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import squared_distances
from peopleboy.tracker.reproductions.contour.box_interaction import (
    Regions,
    overlap_shares,
    regions_of,
    shared_parts,
)
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.measurement.likelihood import covered_by
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView
from peopleboy.tracker.reproductions.contour.particles import STATE_SIZE, Floats
from peopleboy.tracker.reproductions.contour.tracked_person import TrackedPerson, moved_on

FOOT_PX = 4.0  # [px] of 240 rows: difference of foot rows for a lead of 1
APPEARANCE = 12.0  # difference of squared distances of appearance for a lead of 1
MOST = 4.0  # limit of the lead by appearance

Leads = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedPerson:
    """A person predicted for this frame, before the image is measured.

    Attributes:
        person: state after the last frame.
        state: (9,) prediction.
        region: (4,) left, top, width, height [px] of the prediction.
        unlikeness: squared distance of the appearance there from the person's own; 0 if unknown.
    """

    person: TrackedPerson
    state: NDArray[np.float64]
    region: Regions
    unlikeness: float = 0.0


def expected(
    persons: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> list[ExpectedPerson]:
    """Predict people for this frame, and compare the appearance there with theirs."""
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


Order = Callable[[Sequence[ExpectedPerson], FrameView], Leads]
"""Compares M people in depth.

It returns the (M, M) lead of the row's person over the column's: positive if in front, negative if behind; 0
if they do not overlap, or the order is unknown.
"""


def lower_foot(figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:  # noqa: ARG001
    """Order people by the rows of their feet: lower is nearer, as all stand on one floor."""
    return _leads([figure.person.foot for figure in figures])


def likelier_front(figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
    """Combine the rows of the feet with the appearance at the predictions.

    Where two people overlap, the image shows the appearance of the one in front; that of the other differs.
    """
    clearer = -_leads([figure.unlikeness for figure in figures]) / APPEARANCE
    bounded: Leads = np.minimum(np.maximum(clearer, -MOST), MOST)
    return lower_foot(figures, view) / (FOOT_PX * view.size) + bounded


def _leads(values: Sequence[float]) -> Leads:
    value = np.array(values, dtype=np.float64)
    return value[:, None] - value[None]


def sorted_by_lead(lead: Leads) -> tuple[int, ...]:
    """Sort M people from front to back by their leads over each other.

    People without anybody in front come first, and so on with the rest. In a cycle, the person with the
    fewest in front comes first, then the one with the larger sum of leads over the rest, then the lower
    number. The result does not depend on the order of comparisons.

    Args:
        lead: (M, M) of the row's person over the column's; 0 where they do not overlap, or unknown.

    Source: thesis, section 7.1, which does not treat cycles.
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
"""Methods of comparison by name."""


@dataclass(frozen=True, slots=True, eq=False)
class OrderContext:
    """The other people, from the view of one person's filter.

    Attributes:
        front: people in front who overlap the person, in this frame.
        others: regions (M, 4) [px] of all other visible people, those in front first.
        strength: (M,) rho of equation 5.3 for each.
        image: (H, W) with the people in front marked as covered, if there are any.
    """

    front: tuple[TrackedPerson, ...]
    others: Regions
    strength: NDArray[np.float64]
    image: NDArray[np.uint8]

    @property
    def hiding(self) -> Regions:
        """Regions of people in front."""
        return self.others[: len(self.front)]

    @property
    def rivals(self) -> Regions:
        """Regions of visible people who are not in front."""
        return self.others[len(self.front) :]

    def occluder(self, state: NDArray[np.float64], config: TrackerConfig) -> TrackedPerson | None:
        """Return the person in front who covers most of a person with this state (9,), or None."""
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
    """Divide the others into those that occlude this person and those that it must avoid.

    Args:
        figure: the person.
        ahead: people already processed, and the region of each in this frame.
        behind: people not processed yet.
        view: this frame.
        config: settings of the tracker.
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
