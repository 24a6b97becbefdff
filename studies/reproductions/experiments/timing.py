"""Experiments that measure time: of the thesis's trackers, with 300 samples, and of attention."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from peopleboy.studies.reproductions.evaluations.stopwatch import time_named
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.units import Measurement, Unit

MS: Final = "ms"
TURNS: Final = 5
"""How often a table is measured."""


def timing(using: Measurement, *, times: str, trackers: Mapping[str, str]) -> Samples:
    """Time every step of trackers, several times over.

    Args:
        using: how much is measured, and what is there.
        times: what is timed, as in `stopwatch.TIMES`.
        trackers: base by the column's name.
    """
    steps = using.plan.timing_steps
    units = {
        name: [
            # Times are exact only where a unit runs alone.
            Unit(
                f"time {times} | {name}: {base} | {steps} | {turn}",
                time_named,
                (times, base, steps),
                is_timing=True,
            )
            for turn in range(TURNS)
        ]
        for name, base in trackers.items()
    }
    return {
        Line(step, name): {MS: np.array([turn[step] for turn in turns])}
        for name, turns in using.grouped(units).items()
        for step in turns[0]
    }
