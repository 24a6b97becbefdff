"""What came of each value of a parameter, and whether the printed one is the best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.reproductions.showing.intervals import Gap, margin, paired
from peopleboy.studies.reproductions.tuning.tuned_parameters import Parameter

CRITERION = "AA"
"""Area accuracy, as in the thesis."""


@dataclass(frozen=True, slots=True, eq=False)
class Tuned:
    """One parameter.

    Attributes:
        parameter: which one.
        accuracy: area accuracy [%] (R,) of each value, film by film.
    """

    parameter: Parameter
    accuracy: Mapping[str, NDArray[np.float64]]

    @property
    def best(self) -> str:
        """The value with the highest mean; of equal ones the printed one, then the first."""
        printed = self.parameter.printed
        return max(self.accuracy, key=lambda value: (self.accuracy[value].mean(), value == printed))

    @property
    def gain(self) -> Gap:
        """By how much the best value is ahead of the printed one."""
        return paired(CRITERION, self.accuracy[self.best], self.accuracy[self.parameter.printed])

    @property
    def verdict(self) -> str:
        """Say in a few words what follows."""
        if self.best == self.parameter.printed:
            return "no other does better"
        gain = self.gain
        if gain.is_sure and gain.low > 0:
            return f"{self.best} is better"
        is_flat = gain.is_sure and gain.high <= margin(CRITERION, 0.0)
        return "it matters little" if is_flat else "undecided"

    def plain(self) -> dict[str, Any]:
        """Give all of it as plain data; without an interval, its ends are None."""
        gain, printed = self.gain, self.parameter.printed
        return {
            "printed": float(printed),
            "best": float(self.best),
            "as_printed": float(self.accuracy[printed].mean()),
            "at_best": float(self.accuracy[self.best].mean()),
            "gain": gain.by,
            "low": gain.low if gain.is_sure else None,
            "high": gain.high if gain.is_sure else None,
            "verdict": self.verdict,
            CRITERION: {value: figures.tolist() for value, figures in self.accuracy.items()},
        }
