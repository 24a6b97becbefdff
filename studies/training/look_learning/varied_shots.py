"""Images otherwise than they were filmed: of other cameras, and ending in the middle of somebody."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from peopleboy.studies.training.look_learning.electronics import through_electronics
from peopleboy.studies.training.people_learning.cut_off import cut_off
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.camera_mount import Mount

_AS_IT_IS: Final = 0.25  # of them
_CUT: Final = 0.25  # end in the middle of somebody
_MOUNT_KNOWN: Final = 0.6  # of images


class LookedAt(NamedTuple):
    """An image that is learned from.

    Attributes:
        shot: the image.
        mount: of the camera, if it is known.
        rng: draws what else is drawn.
    """

    shot: PeopleShot
    mount: Mount | None
    rng: np.random.Generator


def varied_shots(shots: Sequence[PeopleShot], rng: np.random.Generator, varieties: int) -> Iterator[LookedAt]:
    """Yield each of some images so many times, each time otherwise."""
    for shot in shots:
        for _ in range(varieties):
            own = np.random.default_rng(rng.integers(2**63))
            varied = shot if own.random() < _AS_IT_IS else through_electronics(shot.varied(own), own)
            shown = cut_off(varied, own) if own.random() < _CUT else varied
            yield LookedAt(shown, shown.mount if own.random() < _MOUNT_KNOWN else None, own)


def as_they_are(shots: Sequence[PeopleShot], rng: np.random.Generator) -> Iterator[LookedAt]:
    """Yield images as they were filmed, by cameras whose mount is known."""
    for shot in shots:
        yield LookedAt(shot, shot.mount, rng)
