"""Examples of what the panorama shows where people stand, and where none do, from films with the truth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.studies.training.foreground_learning.masked_film import MaskedFilm
from peopleboy.tracker.panorama_calibration import PanoramaCalibration
from peopleboy.tracker.panoramic.foreground.foreground import Foreground
from peopleboy.tracker.panoramic.people.figure_patch import PATCH, Map
from peopleboy.tracker.panoramic.people.panorama_patches import Scene, promising_places
from peopleboy.tracker.panoramic.people.place_model import with_distance

Floats = NDArray[np.float64]

IMAGES: Final = 300
"""From how many images of a film is learned at most, and from half of them; all are played."""

NEAREST_M: Final = 0.8
FARTHEST_M: Final = 8.0
LEAST_PX: Final = 10
BLIND_SHARE: Final = 0.7
"""Who is nearer, farther, smaller, or hidden more than that is neither there nor not there."""

NEAR_M: Final = 0.42
APART_M: Final = 0.6
"""Within the first of these from a person a place shows it; beyond the second from everybody, nobody."""

_SPREADS: Final = ((0.05, 0.03), (0.18, 0.1), (0.18, 0.1))
"""How far off, away and across, examples of a person are looked at: when nearly right, and when expected."""

_WARM_UP_S: Final = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class PlaceExamples:
    """N examples.

    Attributes:
        patches: (N, PATCH) what is seen.
        distance_m: (N,) of the place that is looked at.
        offset_m: (N, 2) where the person is from there, farther away and to the left; NaN for nobody.
    """

    patches: NDArray[np.float16]
    distance_m: Floats
    offset_m: Floats

    @property
    def inputs(self) -> Map:
        """What networks are told of them, (N, INPUTS)."""
        return with_distance(self.patches.astype(np.float32), self.distance_m)

    @property
    def is_person(self) -> NDArray[np.bool_]:
        """Whether somebody is there, (N,)."""
        return ~np.isnan(self.offset_m[:, 0])

    @classmethod
    def joined(cls, parts: Sequence[PlaceExamples]) -> PlaceExamples:
        """Take examples together."""
        return cls(
            np.concatenate([np.zeros((0, PATCH), np.float16), *(one.patches for one in parts)]),
            np.concatenate([np.zeros(0), *(one.distance_m for one in parts)]),
            np.concatenate([np.zeros((0, 2)), *(one.offset_m for one in parts)]),
        )

    def save(self, path: Path) -> None:
        """Write them, whole or not at all."""
        with atomic(path) as part, part.open("wb") as file:
            np.savez_compressed(
                file, patches=self.patches, distance_m=self.distance_m, offset_m=self.offset_m
            )

    @classmethod
    def load(cls, path: Path) -> PlaceExamples:
        """Read them."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(**arrays)


@dataclass(frozen=True, slots=True)
class _Standing:
    """A person in an image: number, place (2,) and its polar form, and how many pixels show it."""

    number: int
    place_m: tuple[float, float]
    pixels: int

    @property
    def distance_m(self) -> float:
        return math.hypot(*self.place_m)

    @property
    def bearing_rad(self) -> float:
        return math.atan2(self.place_m[1], self.place_m[0])


def examples_of(film: MaskedFilm, calibration: PanoramaCalibration, seed: int) -> PlaceExamples:
    """Play a film to the tracker's eyes, and keep what is seen at and beside people."""
    rng, eyes = np.random.default_rng((seed, 2003)), Foreground()
    parts: list[PlaceExamples] = []
    every = max(2, math.ceil(len(film.images) / IMAGES))
    for k, image in enumerate(film.images):
        foreground = eyes.update(image, float(film.time_s[k]), film.odometry(k), calibration)
        if k % every == seed % every and film.time_s[k] >= _WARM_UP_S:
            people = _people(film, k)
            scene = Scene.of(image, foreground, eyes.novelty, calibration)
            parts.extend(_seen(scene, people, rng))
    return PlaceExamples.joined(parts)


def _people(film: MaskedFilm, k: int) -> list[_Standing]:
    """List who is there, the nearest first."""
    pixels = np.bincount(film.who[k].ravel(), minlength=len(film.place_m[k]) + 1)
    found = [
        _Standing(number + 1, (x, y), int(pixels[number + 1]))
        for number, (x, y) in enumerate(film.place_m[k].tolist())
        if not math.isnan(x)
    ]
    return sorted(found, key=lambda one: one.distance_m)


def _seen(scene: Scene, people: Sequence[_Standing], rng: np.random.Generator) -> Iterator[PlaceExamples]:
    """Look at an image as the tracker does: nearest first, who is found out of the way, then newcomers."""
    yield _looked_at(scene, promising_places(scene.figures, 3), people)
    for one in people:
        yield _looked_at(scene, _beside(one, rng), people)
        if not _is_visible(one, scene):
            continue
        yield _looked_at(scene, _around(one, rng), people)
        if rng.random() < 0.9:
            scene.cover(
                one.bearing_rad + rng.normal(0.0, 0.03) / one.distance_m,
                one.distance_m + rng.normal(0.0, 0.05),
            )
    yield _looked_at(scene, promising_places(scene.figures, 3), people)


def _looked_at(scene: Scene, polar: Floats, people: Sequence[_Standing]) -> PlaceExamples:
    """Look at places (N, 2), bearing and distance, and tell who is there; what is neither is left out."""
    places = polar[:, 1:] * np.stack([np.cos(polar[:, 0]), np.sin(polar[:, 0])], axis=1)
    offset, is_sure = np.full((len(polar), 2), np.nan), np.ones(len(polar), np.bool_)
    for one in people:
        away = np.hypot(*(places - one.place_m).T)
        is_near = away < NEAR_M
        if _is_visible(one, scene):
            offset[is_near] = _offsets(polar[is_near], one)
            is_sure &= is_near | (away > APART_M)
        else:
            is_sure &= away > APART_M
    patches = scene.figures.patches(polar[is_sure, 0], polar[is_sure, 1])
    return PlaceExamples(patches.astype(np.float16), polar[is_sure, 1], offset[is_sure])


def _is_visible(one: _Standing, scene: Scene) -> bool:
    is_in_reach = NEAREST_M < one.distance_m < FARTHEST_M and one.pixels >= LEAST_PX
    return is_in_reach and scene.hidden_share(one.bearing_rad, one.distance_m) < BLIND_SHARE


def _offsets(polar: Floats, one: _Standing) -> Floats:
    turn = np.remainder(one.bearing_rad - polar[:, 0] + math.pi, math.tau) - math.pi
    return np.stack([one.distance_m - polar[:, 1], turn * polar[:, 1]], axis=1)


def _around(one: _Standing, rng: np.random.Generator) -> Floats:
    """Draw places (N, 2), bearing and distance, at which somebody may be expected who is here."""
    off = rng.normal(0.0, 1.0, (len(_SPREADS), 2)) * _SPREADS
    off = np.clip(off, -0.3, 0.3)
    distance = np.maximum(one.distance_m + off[:, 0], 0.6)
    return np.stack([one.bearing_rad + off[:, 1] / distance, distance], axis=1)


def _beside(one: _Standing, rng: np.random.Generator) -> Floats:
    """Draw places beside, before and behind somebody, and one anywhere."""
    side, depth = rng.choice([-1.0, 1.0], 2)
    beside = one.bearing_rad + side * rng.uniform(0.55, 1.2) / one.distance_m, one.distance_m
    behind = one.bearing_rad + rng.normal(0.0, 0.05), one.distance_m + depth * rng.uniform(0.65, 2.5)
    anywhere = rng.uniform(-math.pi, math.pi), rng.uniform(1.0, FARTHEST_M)
    places = np.array([beside, behind, anywhere])
    return places[places[:, 1] > NEAREST_M]
