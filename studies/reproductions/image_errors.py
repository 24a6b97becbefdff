"""Errors of many images: summed up as the paper does, and by stretches of time."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

BLOCKS = 20
"""Into how many stretches of time a film is cut where neighbouring images must not count as independent."""


class ErrorSummary(NamedTuple):
    """Absolute errors: number, mean and standard deviation in their unit; all 0 where there are none."""

    images: int
    mean: float
    deviation: float

    @classmethod
    def of(cls, errors: Floats) -> "ErrorSummary":
        """Summarise errors (N,)."""
        if not len(errors):
            return cls(images=0, mean=0.0, deviation=0.0)
        return cls(images=len(errors), mean=float(errors.mean()), deviation=float(errors.std()))


def pooled(parts: Sequence[ErrorSummary]) -> ErrorSummary:
    """Summarise the errors of all parts as if they lay in one heap."""
    counts = np.array([one.images for one in parts], np.float64)
    if not counts.sum():
        return ErrorSummary.of(np.empty(0))
    mean = float(np.average([one.mean for one in parts], weights=counts))
    square = float(np.average([one.deviation**2 + one.mean**2 for one in parts], weights=counts))
    deviation = float(np.sqrt(max(square - mean**2, 0.0)))
    return ErrorSummary(images=int(counts.sum()), mean=mean, deviation=deviation)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageErrors:
    """Errors of one way to measure.

    Attributes:
        splits: one a split, of the images that were tested with.
        blocks: one a stretch of time of each film, over all its splits; in time's order, so that two ways
            that were tested on the same films can be compared pair by pair.
        films: how many.
    """

    splits: tuple[ErrorSummary, ...]
    blocks: tuple[ErrorSummary, ...] = ()
    films: int = 1

    @property
    def all(self) -> ErrorSummary:
        """Of all splits together."""
        return pooled(self.splits)

    @property
    def block_means(self) -> Floats:
        """Mean error (B,) of each stretch; NaN where no image was tested."""
        return np.array([one.mean if one.images else np.nan for one in self.blocks])

    def only(self, choose: Callable[..., ErrorSummary]) -> "ImageErrors":
        """Keep the split with the least or greatest mean error, by `min` or `max`."""
        return ImageErrors(splits=(choose(self.splits, key=lambda one: one.mean),))

    @classmethod
    def of(cls, tested: Sequence[tuple[Rows, Floats]], count: int) -> "ImageErrors":
        """Sum up splits of one film.

        Args:
            tested: of each split, numbers (N,) of the images, and their errors (N,).
            count: images of the film.
        """
        rows = np.concatenate([numbers for numbers, _ in tested])
        errors = np.concatenate([part for _, part in tested])
        block = rows * BLOCKS // count
        return cls(
            splits=tuple(ErrorSummary.of(part) for _, part in tested),
            blocks=tuple(ErrorSummary.of(errors[block == number]) for number in range(BLOCKS)),
        )

    @classmethod
    def joined(cls, films: "Iterable[ImageErrors]") -> "ImageErrors":
        """Put the errors of several films one after the other."""
        listed = list(films)
        return cls(
            splits=tuple(split for film in listed for split in film.splits),
            blocks=tuple(block for film in listed for block in film.blocks),
            films=sum(film.films for film in listed),
        )

    @classmethod
    def merged(cls, parts: "Sequence[ImageErrors]") -> "ImageErrors":
        """Take together what was tested on different images of the same splits."""
        by_split = zip(*(part.splits for part in parts), strict=True)
        by_block = zip(*(part.blocks for part in parts), strict=True)
        return cls(splits=tuple(map(pooled, by_split)), blocks=tuple(map(pooled, by_block)))

    def plain(self) -> dict[str, Any]:
        """Return them as plain data."""
        return {"splits": self.splits, "blocks": self.blocks}

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> "ImageErrors":
        """Make a film's errors out of plain data, equal to the last digit."""
        splits, blocks = (tuple(ErrorSummary(*row) for row in plain[key]) for key in ("splits", "blocks"))
        return cls(splits=splits, blocks=blocks)
