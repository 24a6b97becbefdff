"""How looks are learned and compared: by colours, or by where chapter 5 would look."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.tracker.attention.attend import PersonLook, learn, relearn, search
from peopleboy.tracker.attention.attention_config import AttentionConfig
from peopleboy.tracker.attention.parts import check_box
from peopleboy.tracker.attention.people.colour_look import ColourLook
from peopleboy.tracker.attention.people.views import View
from peopleboy.tracker.attention.sight import Sight

Look = TypeVar("Look")
Seen = TypeVar("Seen")


class Recogniser(Protocol[Look, Seen]):
    """Whatever tells people by their looks."""

    def see(self, view: View) -> Seen | None:
        """Look at somebody in one image; None where there is not enough of the person in it."""
        ...

    def learned(self, known: Look | None, seen: Seen, rate: float) -> Look:
        """Learn somebody, or take in a share of how a known one looks now."""
        ...

    def score(self, known: Look, seen: Seen) -> float:
        """Tell how likely somebody is a known person, 0..1, whoever else is there."""
        ...


class ByColour:
    """Tells people by the colours of head and torso, with the light divided out."""

    def see(self, view: View) -> ColourLook | None:
        """Look at somebody."""
        return ColourLook.of(view)

    def learned(self, known: ColourLook | None, seen: ColourLook, rate: float) -> ColourLook:
        """Learn somebody."""
        return seen if known is None else known.updated(seen, rate)

    def score(self, known: ColourLook, seen: ColourLook) -> float:
        """Tell how much of their colours two have in common."""
        return known.likeness(seen)


@dataclass(frozen=True, slots=True, eq=False)
class Spotted:
    """Somebody in an image that is made ready.

    Attributes:
        sight: the image.
        view: where the person is in it.
    """

    sight: Sight
    view: View


class ByFocus:
    """Tells people by the focus of attention: who is there has the score of the place, others have none.

    Args:
        config: how attention is directed.
    """

    def __init__(self, config: AttentionConfig) -> None:
        self._config = config
        self._newest: Sight | None = None

    def see(self, view: View) -> Spotted | None:
        """Look at somebody; an image is made ready once for all who are in it."""
        try:
            check_box(view.box, view.image.shape)
        except BadInput:
            return None
        if self._newest is None or self._newest.image is not view.image:
            self._newest = Sight.of(view.image, self._config)
        return Spotted(self._newest, view)

    def learned(self, known: PersonLook | None, seen: Spotted, rate: float) -> PersonLook:  # noqa: ARG002
        """Learn somebody from the first image; later ones count as little as the source has it."""
        if known is None:
            return learn(seen.sight, seen.view.box, self._config)
        return relearn(known, seen.sight, search(seen.sight, known, self._config), self._config)

    def score(self, known: PersonLook, seen: Spotted) -> float:
        """Give the score of the focus if it is on this person."""
        focus = search(seen.sight, known, self._config)
        u, v = focus.place
        left, top, width, height = seen.view.box
        is_here = left <= u <= left + width and top <= v <= top + height
        return focus.score if is_here else 0.0
