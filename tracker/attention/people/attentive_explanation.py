"""What the attentive tracker believes beyond its tracks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import singledispatch

from peopleboy.tracker.attention.people.attended import Attended
from peopleboy.tracker.fusion.explanations import BothExplanations, FusedExplanation
from peopleboy.tracker.thermal.explanation import ContourExplanation


@dataclass(frozen=True, slots=True, eq=False)
class AttentiveExplanation:
    """What the tracker below believes, and how much people look like who they are told to be.

    Attributes:
        below: of its own kind, by the numbers that are told.
        likeness: 0..1, mean score of late of those who are seen well enough, by number.
        attended: who was learned first, in the newest image of a colour camera; None before, or without one.
    """

    below: object
    likeness: Mapping[int, float]
    attended: Attended | None


@singledispatch
def renumbered(explanation: object, number: Mapping[int, int]) -> object:  # noqa: ARG001
    """Give an explanation by the numbers that tracks are told by; a kind without numbers stays as it is."""
    return explanation


@renumbered.register
def _(explanation: ContourExplanation, number: Mapping[int, int]) -> object:
    return BothExplanations.of(explanation, None, number).thermal


@renumbered.register
def _(explanation: BothExplanations, number: Mapping[int, int]) -> object:
    return BothExplanations.of(explanation.thermal, explanation.panoramic, number)


@renumbered.register
def _(explanation: FusedExplanation, number: Mapping[int, int]) -> object:
    both = BothExplanations.of(explanation.both.thermal, explanation.both.panoramic, number)
    return replace(explanation, both=both)
