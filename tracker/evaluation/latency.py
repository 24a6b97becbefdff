"""Latency of a tracker: the wall time of each update, without the rendering of images."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.user_files import read_text

LATENCY_FILE: Final = "latency.txt"
WARM_UP: Final = 15  # updates excluded at the start of a sequence, in which kernels are compiled


@dataclass(frozen=True, slots=True, eq=False)
class Latency:
    """Times of a tracker's updates.

    Attributes:
        time_ms: (N,) wall times [ms], without those of the warm-up.
    """

    time_ms: Floats

    def __add__(self, other: Self) -> Self:
        """Return the times of two sequences combined."""
        return type(self)(np.concatenate([self.time_ms, other.time_ms]))

    def __len__(self) -> int:
        return len(self.time_ms)

    @property
    def mean_ms(self) -> float:
        """Mean time of an update [ms]; NaN without any."""
        return float(np.mean(self.time_ms)) if len(self) else math.nan

    @property
    def p95_ms(self) -> float:
        """95th percentile of the time of an update [ms]; NaN without any."""
        return float(np.percentile(self.time_ms, 95.0)) if len(self) else math.nan


UNTIMED: Final = Latency(np.zeros(0))


class TimedImages(Mapping[str, NDArray[Any]]):
    """Images by camera, with the time that was spent on rendering them.

    Attributes:
        spent_s: wall time of all accesses so far [s].
    """

    def __init__(self, images: Mapping[str, NDArray[Any]]) -> None:
        self._images = images
        self.spent_s = 0.0

    def __getitem__(self, camera: str) -> NDArray[Any]:
        start_s = perf_counter()
        try:
            return self._images[camera]
        finally:
            self.spent_s += perf_counter() - start_s

    def __contains__(self, camera: object) -> bool:
        return camera in self._images

    def __iter__(self) -> Iterator[str]:
        return iter(self._images)

    def __len__(self) -> int:
        return len(self._images)


def write_latency(folder: Path, times_ms: Iterable[float]) -> None:
    """Write the time of each update of a run [ms] to its folder, one a line."""
    text = "".join(f"{time_ms:.3f}\n" for time_ms in times_ms)
    (folder / LATENCY_FILE).write_text(text, encoding="utf-8")


def read_latency(folder: Path) -> Latency:
    """Read the latency of a run from its folder; empty for imported tracks, which have no times.

    Raises:
        BadInput: the file is not one of times.
    """
    path = folder / LATENCY_FILE
    if not path.is_file():
        return UNTIMED
    try:
        times_ms = np.array(read_text(path).split(), dtype=np.float64)
    except ValueError as error:
        raise BadInput(f"{path}: must have one time [ms] a line; run the scenario again") from error
    return Latency(times_ms[WARM_UP:])
