"""CPU times of contestants that take turns: medians, and ratios that are robust to other load."""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

Work = Callable[[], object]
Result = TypeVar("Result")


def timed_ms(work: Callable[[], Result]) -> tuple[float, Result]:
    """Return the CPU time [ms] of a call, and its result."""
    start = time.process_time()
    result = work()
    return 1000.0 * (time.process_time() - start), result


def spent_ms(work: Work) -> float:
    """Return the CPU time [ms] of a call."""
    return timed_ms(work)[0]


def median_ms(works: Iterable[Work]) -> float:
    """Return the median CPU time [ms] of several calls, after one call for warm-up."""
    listed = list(works)
    listed[0]()
    return float(np.median([spent_ms(work) for work in listed]))


@dataclass(slots=True)
class Turns:
    """Times or rates of contestants that take turns, by name.

    The speed of a machine varies with its other load. Contestants that take turns within a second run under
    the same load, so the median of their ratios is more stable than the ratio of their medians.
    """

    values: dict[str, list[float]] = field(default_factory=dict)

    def add(self, turn: Mapping[str, float]) -> None:
        """Add the values of a turn; NaN for a contestant that was left out."""
        for name, value in turn.items():
            self.values.setdefault(name, []).append(value)

    def measure(self, works: Mapping[str, Work]) -> None:
        """Time each contestant once [ms], in this order."""
        self.add({name: spent_ms(work) for name, work in works.items()})

    def median(self, name: str) -> float:
        """Return the median of a contestant."""
        return float(np.nanmedian(self.values[name]))

    def least(self, name: str) -> float:
        """Return the least value of a contestant, which is least affected by other load."""
        return min(self.values[name])

    def ratio(self, name: str, other: str) -> float:
        """Return the ratio of one contestant's value to another's, median over the turns."""
        return float(np.median(np.divide(self.values[name], self.values[other])))
