"""Appearance models for re-identification: by the colours of clothes, or by the attention of chapter 5."""

from dataclasses import dataclass
from typing import Final, Protocol, TypeVar

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.attention.attend import PersonModel, learn, relearn, search
from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import check_box
from peopleboy.tracker.reproductions.attention.person_views import PersonView
from peopleboy.tracker.tracking.appearance import (
    Colours,
    blend_colours,
    colour_similarity,
    describe_samples,
)

Appearance = TypeVar("Appearance")
Seen = TypeVar("Seen")

_SIDES: Final = 0.2  # share of the box's width that is left out on each side, where arms and background are


class Recogniser(Protocol[Appearance, Seen]):
    """Identifies people by their appearance."""

    def see(self, view: PersonView) -> Seen | None:
        """Describe a person in one image; None if too little of the person is visible."""
        ...

    def learned(self, known: Appearance | None, seen: Seen, rate: float) -> Appearance:
        """Learn a person, or update a known model."""
        ...

    def score(self, known: Appearance, seen: Seen) -> float:
        """Return how likely a person is a known one, 0..1, independently of others."""
        ...


class ByColour:
    """Recognises people by the colours of torso and legs, as the people tracker does."""

    def see(self, view: PersonView) -> Colours | None:
        """Describe a person; None if the torso is not in the image, or it is too dark."""
        left, top, width, height = view.box
        rows, columns = view.image.shape[:2]
        begin, end = np.clip([left + _SIDES * width, left + (1.0 - _SIDES) * width], 0, columns).round()
        upper, lower = np.clip([top, top + height], 0, rows).round()
        pixels = view.image[int(upper) : int(lower), int(begin) : int(end)]
        down = (np.arange(upper, lower) + 0.5 - top) / height
        colours = describe_samples(pixels.reshape(-1, 3), np.repeat(down, pixels.shape[1]))
        return colours if colours.any() else None

    def learned(self, known: Colours | None, seen: Colours, rate: float) -> Colours:
        """Learn or update a person."""
        return seen if known is None else blend_colours(known, seen, rate)

    def score(self, known: Colours, seen: Colours) -> float:
        """Return the similarity of the colours."""
        return colour_similarity(known, seen)


@dataclass(frozen=True, slots=True, eq=False)
class Spotted:
    """A person in an image with computed features.

    Attributes:
        sight: features of the image.
        view: the person in it.
    """

    sight: ImageSums
    view: PersonView


class ByFocus:
    """Recognises people by the focus of attention: its score for the person in focus, 0 for others.

    Args:
        config: settings of attention.
    """

    def __init__(self, config: AttentionConfig) -> None:
        self._config = config
        self._newest: ImageSums | None = None

    def see(self, view: PersonView) -> Spotted | None:
        """Describe a person; the features of an image are computed once for all people in it."""
        try:
            check_box(view.box, view.image.shape)
        except BadInput:
            return None
        if self._newest is None or self._newest.image is not view.image:
            self._newest = ImageSums.of(view.image, self._config)
        return Spotted(self._newest, view)

    def learned(self, known: PersonModel | None, seen: Spotted, rate: float) -> PersonModel:  # noqa: ARG002
        """Learn a person from the first image; later ones update it at the source's low rate."""
        if known is None:
            return learn(seen.sight, seen.view.box, self._config)
        return relearn(known, seen.sight, search(seen.sight, known, self._config), self._config)

    def score(self, known: PersonModel, seen: Spotted) -> float:
        """Return the score of the focus if it is on this person."""
        focus = search(seen.sight, known, self._config)
        u, v = focus.place
        left, top, width, height = seen.view.box
        is_here = left <= u <= left + width and top <= v <= top + height
        return focus.score if is_here else 0.0
