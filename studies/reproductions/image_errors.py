"""Errors of many images: summarised as in the paper, and by blocks of time."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

BLOCKS = 20
"""Number of blocks of time per clip, as errors of neighbouring images are not independent."""


class ErrorSummary(NamedTuple):
    """Absolute errors: number, mean and standard deviation in their unit; all 0 without errors."""

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
    """Combine the summaries of all parts."""
    counts = np.array([one.images for one in parts], np.float64)
    if not counts.sum():
        return ErrorSummary.of(np.empty(0))
    mean = float(np.average([one.mean for one in parts], weights=counts))
    square = float(np.average([one.deviation**2 + one.mean**2 for one in parts], weights=counts))
    deviation = float(np.sqrt(max(square - mean**2, 0.0)))
    return ErrorSummary(images=int(counts.sum()), mean=mean, deviation=deviation)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageErrors:
    """Errors of one method.

    Attributes:
        splits: one summary per split, of its test images.
        blocks: one summary per block of time of each clip, over all its splits; in time order, so that two
            methods tested on the same clips can be compared pair by pair.
        films: number of clips.
    """

    splits: tuple[ErrorSummary, ...]
    blocks: tuple[ErrorSummary, ...] = ()
    films: int = 1

    @property
    def all(self) -> ErrorSummary:
        """Summary of all splits."""
        return pooled(self.splits)

    @property
    def block_means(self) -> Floats:
        """Mean error (B,) of each block; NaN without test images."""
        return np.array([one.mean if one.images else np.nan for one in self.blocks])

    def only(self, choose: Callable[..., ErrorSummary]) -> "ImageErrors":
        """Return only the split with the least or greatest mean error, by `min` or `max`."""
        return ImageErrors(splits=(choose(self.splits, key=lambda one: one.mean),))

    @classmethod
    def of(cls, tested: Sequence[tuple[Rows, Floats]], count: int) -> "ImageErrors":
        """Summarise the splits of one clip.

        Args:
            tested: for each split, indices (N,) of the images, and their errors (N,).
            count: number of images of the clip.
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
        """Concatenate the errors of several clips."""
        listed = list(films)
        return cls(
            splits=tuple(split for film in listed for split in film.splits),
            blocks=tuple(block for film in listed for block in film.blocks),
            films=sum(film.films for film in listed),
        )

    @classmethod
    def merged(cls, parts: "Sequence[ImageErrors]") -> "ImageErrors":
        """Combine errors of different images of the same splits."""
        by_split = zip(*(part.splits for part in parts), strict=True)
        by_block = zip(*(part.blocks for part in parts), strict=True)
        return cls(splits=tuple(map(pooled, by_split)), blocks=tuple(map(pooled, by_block)))

    def plain(self) -> dict[str, Any]:
        """Return the errors as plain data."""
        return {"splits": self.splits, "blocks": self.blocks}

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> "ImageErrors":
        """Restore a clip's errors exactly from plain data."""
        splits, blocks = (tuple(ErrorSummary(*row) for row in plain[key]) for key in ("splits", "blocks"))
        return cls(splits=splits, blocks=blocks)
