"""What the detector learns from: single images, and who can be learned from in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.people_learning.people_film import PeopleFilm
from peopleboy.tracker.proposals.window import WIDTH_PER_HEIGHT
from peopleboy.tracker.thermal.mount import Mount

Floats = NDArray[np.float64]
Grey = NDArray[np.uint8]

_LEAST_VISIBLE: Final = 0.65
_LEAST_INSIDE: Final = 0.85
_LEAST_SHOWN_PX: Final = 8.0  # of whom less is seen, nobody need find


@dataclass(frozen=True, slots=True, eq=False)
class PeopleShot:
    """One image.

    Attributes:
        grey: (H, W) image.
        change: (H, W) by how much greys changed.
        mount: of the camera.
        box: (P, 4) [px] of everybody of whom some is seen, from head to feet, as wide as windows have it.
        is_good: (P,) who is upright, and all but hidden nowhere.
    """

    grey: Grey
    change: Grey
    mount: Mount
    box: Floats
    is_good: NDArray[np.bool_]

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
    width = WIDTH_PER_HEIGHT * box[:, 3]
    box[:, 0] += (box[:, 2] - width) / 2.0
    box[:, 2] = width
    is_good = (
        film.is_upright[here] & (film.visible[here] > _LEAST_VISIBLE) & (film.inside[here] > _LEAST_INSIDE)
    )
    return PeopleShot(film.grey[k], film.change[k], film.seen_by(), box, is_good)
