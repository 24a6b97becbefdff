"""What the detector learns from: single images, and who can be learned from in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.people_learning.people_film import PeopleFilm
from peopleboy.tracker.thermal.mount import Mount

Floats = NDArray[np.float64]
Grey = NDArray[np.uint8]

_LEAST_VISIBLE: Final = 0.35
_LEAST_INSIDE: Final = 0.5
_LEAST_CLEAR: Final = 0.45  # of what lies inside the image, somebody who can be learned from shows so much
_HIGHEST: Final = 0.25  # of the height may be above the image
_SPANNED: Final = 0.5  # share of images that are learned from in another span
_MOST_BLACK: Final = 0.97
_LEAST_SPAN: Final = 60.0  # [grey]
_GAINS: Final = (0.6, 1.6)
_LEAST_SHOWN_PX: Final = 8.0  # of whom less is seen, nobody need find


@dataclass(frozen=True, slots=True, eq=False)
class PeopleShot:
    """One image.

    Attributes:
        grey: (H, W) image.
        change: (H, W) by how much greys changed.
        mount: of the camera.
        box: (P, 4) [px] of everybody of whom some is seen, from head to feet, as wide as the torso.
        is_good: (P,) who can be learned from: upright, and not mostly hidden.
    """

    grey: Grey
    change: Grey
    mount: Mount
    box: Floats
    is_good: NDArray[np.bool_]

    def varied(self, rng: np.random.Generator) -> PeopleShot:
        """Give it as it is or mirrored, in half of all cases as a camera with another span would."""
        shot = self.mirrored() if rng.random() < 0.5 else self
        return shot.spanned(rng) if rng.random() < _SPANNED else shot

    def spanned(self, rng: np.random.Generator) -> PeopleShot:
        """Give it as a camera of another span would: what is colder than that is black, hotter white."""
        coldest = np.quantile(self.grey[::4, ::4], rng.uniform(0.0, _MOST_BLACK))
        gain = rng.uniform(*_GAINS) * 255.0 / max(255.0 - coldest, _LEAST_SPAN)
        grey = np.clip((self.grey - coldest) * gain, 0.0, 255.0)
        # What was and is beyond the span does not change; of what came from there, a part is missing.
        was_black = self.grey.astype(np.float64) + self.change <= coldest
        change = np.where(was_black, 0.0, np.clip(self.change * gain, 0.0, 255.0))
        return replace(self, grey=grey.astype(np.uint8), change=change.astype(np.uint8))

    def mirrored(self) -> PeopleShot:
        """Swap left and right."""
        box = self.box.copy()
        box[:, 0] = self.grey.shape[1] - 1.0 - (box[:, 0] + box[:, 2])
        grey, change = (np.ascontiguousarray(image[:, ::-1]) for image in (self.grey, self.change))
        return replace(self, grey=grey, change=change, box=box)


def shots_of(films: Iterable[Path]) -> Iterator[PeopleShot]:
    """Yield all images of films."""
    for path in films:
        film = PeopleFilm.load(path)
        for k in range(len(film.grey)):
            yield _shot(film, k)


def _shot(film: PeopleFilm, k: int) -> PeopleShot:
    here = (film.image == k) & (film.shown_px > _LEAST_SHOWN_PX)
    box = film.box[here]
    visible, inside = film.visible[here], film.inside[here]
    is_good = (
        film.is_upright[here]
        & (visible > _LEAST_VISIBLE)
        & (inside > _LEAST_INSIDE)
        & (visible > _LEAST_CLEAR * inside)
        & (box[:, 1] > -_HIGHEST * box[:, 3])
    )
    return PeopleShot(film.grey[k], film.change[k], film.seen_by(), box, is_good)
