"""Playing films to a tracker's eyes, to judge them or to learn from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.foreground_learning.masked_film import MaskedFilm
from peopleboy.studies.training.foreground_learning.teach_network import Adam
from peopleboy.tracker.frame import Calibration
from peopleboy.tracker.panoramic.foreground.foreground import Foreground
from peopleboy.tracker.panoramic.foreground.layers import BLOCK
from peopleboy.tracker.panoramic.foreground.mask_network import OUTPUTS
from peopleboy.tracker.panoramic.foreground.network_file import ForegroundModel

Linear = NDArray[np.float32]
Example = tuple[NDArray[np.float16], NDArray[np.bool_]]
"""What the network is told (R, WIDE, INPUTS), and which pixels are people (R, WIDE, OUTPUTS)."""

EVERY: Final = 4
"""Which images of a film are learned from; all are played."""
WIDE: Final = 40
"""How many columns of squares an example has: most of an image shows nothing to learn from."""
BATCH: Final = 8


def watch(film: MaskedFilm, model: ForegroundModel, calibration: Calibration) -> Iterator[Linear]:
    """Yield for each image of a film the probability (H, W) that a pixel is a person."""
    eyes = Foreground(model)
    for k, image in enumerate(film.images):
        yield eyes.update(image, float(film.time_s[k]), film.odometry(k), calibration)


def collect(
    paths: Sequence[Path], model: ForegroundModel, calibration: Calibration, rng: np.random.Generator
) -> list[Example]:
    """Play films, each changed at random, and keep what the network is told of their images and what is true.

    What it is told rests on a background that it has helped to make itself, as when it is used.
    """
    return [
        example
        for path in paths
        for example in _examples(_changed(MaskedFilm.load(path), rng), model, calibration, rng)
    ]


def study(
    pupil: Adam, examples: Sequence[Example], rng: np.random.Generator, rates: tuple[float, float]
) -> float:
    """Go once through examples in another order; give their mean loss [nat].

    Args:
        pupil: the network, as it is being taught.
        examples: to learn from.
        rng: draws the order.
        rates: of learning, at the beginning and at the end.
    """
    order, losses = rng.permutation(len(examples)), []
    for start in range(0, len(order), BATCH):
        batch = [examples[k] for k in order[start : start + BATCH]]
        squares, people = (np.stack(parts).astype(np.float32) for parts in zip(*batch, strict=True))
        rate = rates[0] + start / len(order) * (rates[1] - rates[0])
        losses.append(pupil.step(squares, people, rate))
    return float(np.mean(losses))


def _examples(
    film: MaskedFilm, model: ForegroundModel, calibration: Calibration, rng: np.random.Generator
) -> Iterator[Example]:
    """Yield two excerpts of some images: from anywhere, and, where there is a person, round one."""
    eyes, begin = Foreground(model), int(rng.integers(EVERY))
    for k, image in enumerate(film.images):
        eyes.update(image, float(film.time_s[k]), film.odometry(k), calibration)
        if k % EVERY != begin:
            continue
        squares, people = eyes.squares.transpose(1, 2, 0), _in_squares(film.who[k] > 0)
        yield _excerpt(squares, people, int(rng.integers(people.shape[1])))
        columns = np.flatnonzero(people.any(axis=(0, 2)))
        if len(columns) > 0:
            yield _excerpt(squares, people, int(rng.choice(columns)))


def _excerpt(squares: Linear, people: NDArray[np.bool_], middle: int) -> Example:
    """Cut out the columns round one, over the seam."""
    chosen = np.arange(middle - WIDE // 2, middle + WIDE // 2) % people.shape[1]
    return squares[:, chosen].astype(np.float16), people[:, chosen]


def _changed(film: MaskedFilm, rng: np.random.Generator) -> MaskedFilm:
    """Swap colours, and left and right in half of all films: more rooms and clothes than were rendered."""
    images = film.images[..., rng.permutation(3)]
    if rng.random() < 0.5:
        return replace(film, images=np.ascontiguousarray(images))
    return replace(
        film,
        images=np.ascontiguousarray(images[:, :, ::-1]),
        who=np.ascontiguousarray(film.who[:, :, ::-1]),
        motion=film.motion * (1.0, -1.0, -1.0),
        place_m=film.place_m * (1.0, -1.0),
    )


def _in_squares(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cut a mask (H, W) into squares (H / BLOCK, W / BLOCK, OUTPUTS), whose pixels go row by row."""
    height, width = mask.shape
    pixels = mask.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).transpose(0, 2, 1, 3)
    return pixels.reshape(height // BLOCK, width // BLOCK, OUTPUTS)
