"""Score people by their visible fraction, or by the length of their longest full occlusion."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.scenarios.run_folder.finished_run import read_run
from peopleboy.scenarios.run_folder.run_files import OCCLUDED, occluded_shares, read_table, truth_files
from peopleboy.scenarios.run_folder.run_tables import TRUTH
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.evaluation.occlusion_scores import (
    LENGTHS_S,
    OccludedShares,
    longest_occlusions_s,
    name_length,
)
from peopleboy.tracker.evaluation.sequence import TrueBoxes

ReadOccluded = Callable[[], OccludedShares]
"""Function that returns how much of each person is occluded, which only some ranges need."""

VISIBLE_EDGES: Final = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
"""Edges of the ranges of visible fraction; a range includes its upper edge."""


@dataclass(frozen=True, slots=True)
class VisibleRange:
    """People whose visible fraction in a frame is above `low` and at most `high`."""

    low: float
    high: float

    @property
    def name(self) -> str:
        """Name for a table."""
        return f"{100.0 * self.low:.0f} to {100.0 * self.high:.0f} %"

    def take(self, truth: TrueBoxes, occluded: ReadOccluded) -> TrueBoxes:  # noqa: ARG002
        """Return the truth, in which only people in the range are counted."""
        inside = (truth.visible > self.low) & (truth.visible <= self.high)
        return replace(truth, counted=truth.counted & inside)


@dataclass(frozen=True, slots=True)
class OcclusionRange:
    """People whose longest full occlusion lasts from `low_s` to less than `high_s`; None for no occlusion."""

    low_s: float | None
    high_s: float = math.inf

    @property
    def name(self) -> str:
        """Name for a table."""
        return "never hidden" if self.low_s is None else name_length(self.low_s, self.high_s)

    def take(self, truth: TrueBoxes, occluded: ReadOccluded) -> TrueBoxes:
        """Return the truth, in which only people in the range are counted, in all their frames."""
        longest = longest_occlusions_s(truth, occluded())
        lasted = np.array([longest.get(person, -1.0) for person in truth.id.tolist()]).reshape(-1)
        inside = lasted < 0.0 if self.low_s is None else (lasted >= self.low_s) & (lasted < self.high_s)
        return replace(truth, counted=truth.counted & inside)


PeopleRange = VisibleRange | OcclusionRange

VISIBLE_RANGES: Final = tuple(VisibleRange(low, high) for low, high in pairwise(VISIBLE_EDGES))
OCCLUSION_RANGES: Final = (
    OcclusionRange(None),
    *(OcclusionRange(low, high) for low, high in pairwise(LENGTHS_S)),
)


def occluded_in(folder: Path, camera: str, truth: TrueBoxes, every: int = 1) -> OccludedShares:
    """Read how much of each person of a run's truth is occluded.

    Args:
        folder: folder of the run.
        camera: camera of the truth.
        truth: the truth.
        every: frames from one image of the camera to the next.

    Raises:
        BadInput: a table is missing or unreadable.
    """
    table = read_table(truth_files(folder, camera)[1], TRUTH, OCCLUDED)
    rate_hz = float(read_run(folder).get("rate_hz", CONTROL_HZ))
    return OccludedShares(occluded_shares(table, truth), rate_hz, every)
