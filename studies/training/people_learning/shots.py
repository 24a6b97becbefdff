"""What the detector learns from: single images, and who can be learned from in them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.people_learning.people_film import PeopleFilm
from peopleboy.tracker.camera_mount import Mount

Floats = NDArray[np.float64]
Grey = NDArray[np.uint8]

_LEAST_VISIBLE: Final = 0.35
_LEAST_INSIDE: Final = 0.5
_LEAST_CLEAR: Final = 0.45  # of what lies inside the image, somebody who can be learned from shows so much
_LITTLE_INSIDE: Final = 0.25  # somebody who is clear has more of the silhouette inside the image
_CLEAR: Final = 0.7  # and shows so much of that
_HIGHEST: Final = 0.25  # of the height may be above the image
_SPANNED: Final = 0.5  # share of images that are learned from in another span
_MOST_BLACK: Final = 0.97
_LEAST_SPAN: Final = 60.0  # [grey]
_GAINS: Final = (0.6, 1.6)
_NEGATED: Final = 0.15  # of images: a camera that shows what is hot black, or people colder than all else
_FAINT: Final = 0.15  # of images, in which something hotter and something colder take most of the greys
_SOFT: Final = 0.3  # of images
_BLURS_PX: Final = (0.4, 1.6)
_MOST_NOISE: Final = 4.0  # [grey]
_CURVES: Final = (-0.6, 0.6)  # logarithm of the power
_FAINTER: Final = (0.15, 0.6)  # gains
_CUT_OFF: Final = 0.3  # of images
_MOST_CUT: Final = 0.4  # of the height
_AT_THE_FEET: Final = 0.7  # of those; others at the head
_FEWEST_ROWS: Final = 60
_TALL_PX: Final = 36.0  # who is cut off, so that it is worth while
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
        is_clear: (P,) who is upright, and shows most of what lies inside the image, however little that is.
    """

    grey: Grey
    change: Grey
    mount: Mount
    box: Floats
    is_good: NDArray[np.bool_]
    is_clear: NDArray[np.bool_]

    def varied(self, rng: np.random.Generator) -> PeopleShot:
        """Give it as it is or otherwise: mirrored, cut off, and with other greys."""
        shot = self.mirrored() if rng.random() < 0.5 else self
        if rng.random() < _CUT_OFF:
            shot = shot.cut_off(rng)
        return shot.recoloured(rng)

    def recoloured(self, rng: np.random.Generator) -> PeopleShot:
        """Give it as it is or with other greys: negated, of a poorer camera, in another span, faint."""
        shot = self.negated() if rng.random() < _NEGATED else self
        if rng.random() < _SOFT:
            shot = shot.softened(rng)
        if rng.random() < _SPANNED:
            return shot.spanned(rng)
        return shot.faint(rng) if rng.random() < _FAINT else shot

    def negated(self) -> PeopleShot:
        """Give it with hot black."""
        return replace(self, grey=255 - self.grey)

    def softened(self, rng: np.random.Generator) -> PeopleShot:
        """Give it as a camera with poorer optics and more noise, and another curve of greys, would."""
        blur, noise = rng.uniform(*_BLURS_PX), rng.uniform(0.0, _MOST_NOISE)
        curve = 255.0 * (np.arange(256.0) / 255.0) ** math.exp(rng.uniform(*_CURVES))
        soft = cv2.GaussianBlur(curve[self.grey], (0, 0), blur) + rng.normal(0.0, noise, self.grey.shape)
        change = cv2.GaussianBlur(self.change.astype(np.float64), (0, 0), blur)
        return replace(
            self,
            grey=np.rint(np.clip(soft, 0.0, 255.0)).astype(np.uint8),
            change=np.rint(change).astype(np.uint8),
        )

    def faint(self, rng: np.random.Generator) -> PeopleShot:
        """Give it with less contrast, as where something is much hotter or colder than all the rest."""
        gain = rng.uniform(*_FAINTER)
        grey = 255.0 * rng.uniform(0.0, 1.0 - gain) + gain * self.grey
        return replace(
            self, grey=np.rint(grey).astype(np.uint8), change=np.rint(gain * self.change).astype(np.uint8)
        )

    def cut_off(self, rng: np.random.Generator) -> PeopleShot:
        """Give a part of it that ends at somebody's feet or head, so that some of them is outside."""
        top, bottom = self.box[:, 1], self.box[:, 1] + self.box[:, 3]
        tall = np.flatnonzero(self.is_good & (self.box[:, 3] > _TALL_PX))
        if not len(tall):
            return self
        one = int(rng.choice(tall))
        if rng.random() < _AT_THE_FEET:
            return self.part(0, bottom[one] - rng.uniform(0.0, _MOST_CUT) * self.box[one, 3], _FEWEST_ROWS)
        return self.part(
            top[one] + rng.uniform(0.0, _HIGHEST) * self.box[one, 3], len(self.grey), _FEWEST_ROWS
        )

    def part(self, first: float, end: float, fewest: int) -> PeopleShot:
        """Give some of the rows; whole, if those are fewer than so many."""
        begin, stop = max(round(first), 0), min(round(end), len(self.grey))
        if stop - begin < fewest:
            return self
        top, bottom = self.box[:, 1], self.box[:, 1] + self.box[:, 3]
        shown = np.minimum(bottom, stop) - np.maximum(top, begin)
        is_left = shown > 0.0
        is_good = (
            self.is_good
            & (shown >= (1.0 - _MOST_CUT) * self.box[:, 3])
            & (begin - top <= _HIGHEST * self.box[:, 3])
        )
        return PeopleShot(
            grey=self.grey[begin:stop],
            change=self.change[begin:stop],
            mount=replace(self.mount, horizon_px=self.mount.horizon_px - begin),
            box=(self.box - np.array([0.0, begin, 0.0, 0.0]))[is_left],
            is_good=is_good[is_left],
            is_clear=self.is_clear[is_left],
        )

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
    is_clear = film.is_upright[here] & (inside > _LITTLE_INSIDE) & (visible > _CLEAR * inside)
    is_good = (
        film.is_upright[here]
        & (visible > _LEAST_VISIBLE)
        & (inside > _LEAST_INSIDE)
        & (visible > _LEAST_CLEAR * inside)
        & (box[:, 1] > -_HIGHEST * box[:, 3])
    )
    return PeopleShot(film.grey[k], film.change[k], film.seen_by(), box, is_good, is_clear)
