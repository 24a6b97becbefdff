"""How appearance is learned and compared: by colours, or by where chapter 5 would look."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol, Self, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.attention.attend import PersonModel, learn, relearn, search
from peopleboy.tracker.attention.attention_config import AttentionConfig
from peopleboy.tracker.attention.feature_maps import CELL_PX
from peopleboy.tracker.attention.image_sums import ImageSums
from peopleboy.tracker.attention.part_model import HEAD, TORSO, Cells, cells_of, check_box
from peopleboy.tracker.attention.people.person_views import PersonView

# What a person's head and torso look like whatever the light: their colours over their common brightness.

Doubles = NDArray[np.float64]

_STEPS: Final = 8  # of each of red, green, blue
_BRIGHTNESS: Final = 90.0  # [grey] to which the mean of both parts is brought
_WEIGHTS: Final = (0.3, 0.7)  # of head and torso
_DARKEST: Final = 8.0  # [grey] mean below which colours are noise
_RANGE: Final = 256.0


@dataclass(frozen=True, slots=True, eq=False)
class ColourLook:
    """Colours of head and torso.

    Attributes:
        shares: (2, 512) of each part's pixels at each colour; a pixel counts for the eight that are nearest,
            the more, the nearer, lest a little more light changes everything.
    """

    shares: Doubles

    @classmethod
    def of(cls, view: PersonView) -> Self | None:
        """Look at a person; None where head or torso are not all in the image, or it is too dark."""
        rows, columns = (side // CELL_PX for side in view.image.shape[:2])
        parts = [cells_of(part, view.box) for part in (HEAD, TORSO)]
        if not all(cells.is_inside(rows, columns) for cells in parts):
            return None
        pixels = [_pixels(view.image, cells) for cells in parts]
        light = float(np.concatenate(pixels).mean())
        if light < _DARKEST:
            return None
        return cls(np.array([_histogram(part, _BRIGHTNESS / light) for part in pixels]))

    def likeness(self, other: ColourLook) -> float:
        """Return how much of their colours two have in common: 1 for the same, 0 for nothing.

        Source: Bhattacharyya's coefficient, as in the situation-awareness thesis, equation 4.25.
        """
        return float(np.sqrt(self.shares * other.shares).sum(axis=1) @ _WEIGHTS)

    def updated(self, new: ColourLook, rate: float) -> ColourLook:
        """Take in a share of how the person looks now (situation-awareness thesis, equation 5.15)."""
        return ColourLook((1.0 - rate) * self.shares + rate * new.shares)


def _pixels(image: NDArray[np.uint8], cells: Cells) -> NDArray[np.uint8]:
    top, left = CELL_PX * cells.row, CELL_PX * cells.column
    part = image[top : top + CELL_PX * cells.height, left : left + CELL_PX * cells.width]
    return np.ascontiguousarray(part).reshape(-1, 3)


@njit(cache=True, nogil=True)
def _histogram(pixels: NDArray[np.uint8], scale: float) -> Doubles:
    """Return the shares (512,) of the colours of pixels (N, 3), made brighter by a factor."""
    shares = np.zeros(_STEPS**3)
    low, over = np.zeros(3, np.int64), np.zeros(3)
    for i in range(pixels.shape[0]):
        for c in range(3):
            place = min(pixels[i, c] * scale, _RANGE) * _STEPS / _RANGE - 0.5
            place = min(max(place, 0.0), _STEPS - 1.001)
            low[c] = int(place)
            over[c] = place - low[c]
        for corner in range(8):
            weight, bin_ = 1.0, 0
            for c in range(3):
                is_upper = (corner >> c) & 1
                weight *= over[c] if is_upper else 1.0 - over[c]
                bin_ = bin_ * _STEPS + low[c] + is_upper
            shares[bin_] += weight
    shares /= max(pixels.shape[0], 1)
    return shares


Appearance = TypeVar("Appearance")
Seen = TypeVar("Seen")


class Recogniser(Protocol[Appearance, Seen]):
    """Identifies people by their appearance."""

    def see(self, view: PersonView) -> Seen | None:
        """Look at a person in one image; None where there is not enough of the person in it."""
        ...

    def learned(self, known: Appearance | None, seen: Seen, rate: float) -> Appearance:
        """Learn a person, or take in a share of how a known one looks now."""
        ...

    def score(self, known: Appearance, seen: Seen) -> float:
        """Return how likely a person is a known person, 0..1, whoever else is there."""
        ...


class ByColour:
    """Identifies people by the colours of head and torso, with the light divided out."""

    def see(self, view: PersonView) -> ColourLook | None:
        """Look at a person."""
        return ColourLook.of(view)

    def learned(self, known: ColourLook | None, seen: ColourLook, rate: float) -> ColourLook:
        """Learn a person."""
        return seen if known is None else known.updated(seen, rate)

    def score(self, known: ColourLook, seen: ColourLook) -> float:
        """Return how much of their colours two have in common."""
        return known.likeness(seen)


@dataclass(frozen=True, slots=True, eq=False)
class Spotted:
    """A person in an image that is made ready.

    Attributes:
        sight: the image.
        view: where the person is in it.
    """

    sight: ImageSums
    view: PersonView


class ByFocus:
    """Identifies people by the focus of attention: who is there has the score of the place, others have none.

    Args:
        config: how attention is directed.
    """

    def __init__(self, config: AttentionConfig) -> None:
        self._config = config
        self._newest: ImageSums | None = None

    def see(self, view: PersonView) -> Spotted | None:
        """Look at a person; an image is made ready once for all who are in it."""
        try:
            check_box(view.box, view.image.shape)
        except BadInput:
            return None
        if self._newest is None or self._newest.image is not view.image:
            self._newest = ImageSums.of(view.image, self._config)
        return Spotted(self._newest, view)

    def learned(self, known: PersonModel | None, seen: Spotted, rate: float) -> PersonModel:  # noqa: ARG002
        """Learn a person from the first image; later ones count as little as the source has it."""
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
