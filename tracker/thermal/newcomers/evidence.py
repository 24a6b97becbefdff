"""For how long the detector has been sure of somebody, and whether that is long enough to tell.

The same confidence says more of some contours than of others. Those few pixels high fit two people side by
side, or one with what is behind, nearly as well as one person, and at twice the distance; and beside somebody
near, an arm looks like somebody smaller. A large contour with nobody beside it is hardly ever wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.thermal.particles import H
from peopleboy.tracker.thermal.tracked_person import is_sure
from peopleboy.tracker.thermal.whereabouts import regions_of, shared_parts


@dataclass(frozen=True, slots=True)
class Evidence:
    """Frames in a row.

    Attributes:
        frames: in which the detector was as sure as it must be of anybody of that size.
        clear_frames: in which it was as sure as it must be of somebody large with nobody beside.
    """

    frames: int = 0
    clear_frames: int = 0

    @property
    def is_some(self) -> bool:
        """Whether there is any."""
        return self.frames > 0 or self.clear_frames > 0

    def is_enough(self, config: TrackerConfig) -> bool:
        """Tell whether a person is born."""
        return self.frames >= config.life.birth_frames or self.clear_frames >= config.search.clear_frames

    def after(
        self, belief: Belief, known: Sequence[NDArray[np.float64]], view: FrameView, config: TrackerConfig
    ) -> Evidence:
        """Take in what the detector believes in one more frame.

        Args:
            belief: of the detector.
            known: (9,) states of all people who are tracked or remembered, where they are supposed to be.
            view: the frame.
            config: of the tracker.
        """
        search = config.search
        is_small = belief.estimate[H] < search.small_h * view.size
        least = search.small_confidence if is_small else config.life.birth_confidence
        is_clear = (
            not is_small
            and is_sure(belief, view, search.clear_confidence, config.life)
            and not _is_beside(belief.estimate, known, config)
        )
        return Evidence(
            frames=self.frames + 1 if is_sure(belief, view, least, config.life) else 0,
            clear_frames=self.clear_frames + 1 if is_clear else 0,
        )


def _is_beside(
    found: NDArray[np.float64], known: Sequence[NDArray[np.float64]], config: TrackerConfig
) -> bool:
    """Tell whether a person (9,) shares any of its region with those known (9,), made wider."""
    around = regions_of(known, config)
    margin = config.search.clear_margin * around[:, 2]
    around[:, 0] -= margin
    around[:, 2] += 2 * margin
    return bool((shared_parts(regions_of([found], config), around) > 0).any())
