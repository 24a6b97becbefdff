"""What the tracker knows of the attended person, for plots and recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.attention.attend import Focus, PersonModel, learn, search
from peopleboy.tracker.attention.attention_config import AttentionConfig
from peopleboy.tracker.attention.image_sums import ImageSums
from peopleboy.tracker.attention.people.person_views import PersonView
from peopleboy.tracker.contour.explanation import ContourExplanation
from peopleboy.tracker.fusion.fused_explanations import BothExplanations, FusedExplanation

TRACKING_ATTENTION: Final = AttentionConfig(scales=(0.64, 0.8, 1.0, 1.25, 1.56))


@dataclass(frozen=True, slots=True, eq=False)
class Attended:
    """A person who was learned, and the newest image.

    Attributes:
        number: of the person.
        camera: in whose images it is looked for.
        look: as it looked when it was learned.
        image: (H, W, 3) RGB.
    """

    number: int
    camera: str
    model: PersonModel
    image: NDArray[np.uint8]

    @classmethod
    def learned(cls, number: int, view: PersonView) -> Attended:
        """Learn a person from one image."""
        model = learn(ImageSums.of(view.image, TRACKING_ATTENTION), view.box, TRACKING_ATTENTION)
        return cls(number, view.camera, model, view.image)

    def focus(self) -> Focus:
        """Look for the person in the newest image, wherever tracks are; this takes some ten milliseconds."""
        return search(ImageSums.of(self.image, TRACKING_ATTENTION), self.model, TRACKING_ATTENTION)


# What the attentive tracker believes beyond its tracks.


@dataclass(frozen=True, slots=True, eq=False)
class AttentiveExplanation:
    """What the tracker below believes, and how similar people are to their identities.

    Attributes:
        below: of its own kind, by the track ids.
        likeness: 0..1, mean score of late of those who are seen well enough, by number.
        attended: who was learned first, in the newest image of a colour camera; None before, or without one.
    """

    below: object
    likeness: Mapping[int, float]
    attended: Attended | None

    @property
    def parts(self) -> tuple[object, ...]:
        """The explanation of the tracker below."""
        return (self.below,)


@singledispatch
def renumbered(explanation: object, number: Mapping[int, int]) -> object:  # noqa: ARG001
    """Return an explanation by the ids of the tracks; a kind without ids stays as it is."""
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
