"""Appearance models for re-identification: by colours, or by the attention of chapter 5."""

from dataclasses import dataclass
from typing import Final, Protocol, Self, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.attention.attend import PersonModel, learn, relearn, search
from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.feature_maps import CELL_PX
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import HEAD, TORSO, Cells, cells_of, check_box
from peopleboy.tracker.reproductions.attention.people.person_views import PersonView

# Illumination-invariant appearance of head and torso: colours divided by their common brightness.

Doubles = NDArray[np.float64]

_STEPS: Final = 8  # bins each of red, green and blue
_BRIGHTNESS: Final = 90.0  # [grey] to which the mean of both parts is normalised
_WEIGHTS: Final = (0.3, 0.7)  # of head and torso
_DARKEST: Final = 8.0  # [grey] mean below which colours are noise
_RANGE: Final = 256.0


@dataclass(frozen=True, slots=True, eq=False)
class ColourLook:
    """Colours of head and torso.

    Attributes:
        shares: (2, 512) colour histograms of the parts; a pixel is interpolated between its eight nearest
            bins, so that a small change of light has a small effect.
    """

    shares: Doubles

    @classmethod
    def of(cls, view: PersonView) -> Self | None:
        """Describe a person; None if head or torso are not entirely in the image, or it is too dark."""
        rows, columns = (side // CELL_PX for side in view.image.shape[:2])
        parts = [cells_of(part, view.box) for part in (HEAD, TORSO)]
        if not all(cells.is_inside(rows, columns) for cells in parts):
            return None
        pixels = [_pixels(view.image, cells) for cells in parts]
        light = float(np.concatenate(pixels).mean())
        if light < _DARKEST:
            return None
        return cls(np.array([_histogram(part, _BRIGHTNESS / light) for part in pixels]))

    def likeness(self, other: "ColourLook") -> float:
        """Return the similarity of colours: 1 for equal, 0 for disjoint ones.

        Source: Bhattacharyya coefficient, as in the situation-awareness thesis, equation 4.25.
        """
        return float(np.sqrt(self.shares * other.shares).sum(axis=1) @ _WEIGHTS)

    def updated(self, new: "ColourLook", rate: float) -> "ColourLook":
        """Update with the current appearance (situation-awareness thesis, equation 5.15)."""
        return ColourLook((1.0 - rate) * self.shares + rate * new.shares)


def _pixels(image: NDArray[np.uint8], cells: Cells) -> NDArray[np.uint8]:
    top, left = CELL_PX * cells.row, CELL_PX * cells.column
    part = image[top : top + CELL_PX * cells.height, left : left + CELL_PX * cells.width]
    return np.ascontiguousarray(part).reshape(-1, 3)


@njit(cache=True, nogil=True)
def _histogram(pixels: NDArray[np.uint8], scale: float) -> Doubles:
    """Return the histogram (512,) of the colours of pixels (N, 3), multiplied by a factor."""
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
        """Describe a person in one image; None if too little of the person is visible."""
        ...

    def learned(self, known: Appearance | None, seen: Seen, rate: float) -> Appearance:
        """Learn a person, or update a known model."""
        ...

    def score(self, known: Appearance, seen: Seen) -> float:
        """Return how likely a person is a known one, 0..1, independently of others."""
        ...


class ByColour:
    """Recognises people by illumination-invariant colours of head and torso."""

    def see(self, view: PersonView) -> ColourLook | None:
        """Describe a person."""
        return ColourLook.of(view)

    def learned(self, known: ColourLook | None, seen: ColourLook, rate: float) -> ColourLook:
        """Learn or update a person."""
        return seen if known is None else known.updated(seen, rate)

    def score(self, known: ColourLook, seen: ColourLook) -> float:
        """Return the similarity of colours."""
        return known.likeness(seen)


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
