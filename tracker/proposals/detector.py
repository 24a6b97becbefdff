"""The detector of people in thermal images, which keeps the earlier images that tell what moves."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.proposals.channels import Memory
from peopleboy.tracker.proposals.looks.closer_look import CloserLook, look_closer, shipped_closer_look
from peopleboy.tracker.proposals.looks.second_look import SecondLook, look_again, shipped_network
from peopleboy.tracker.proposals.model import PeopleModel, shipped_model
from peopleboy.tracker.proposals.motion import change, shifted, turned
from peopleboy.tracker.proposals.patches import summed
from peopleboy.tracker.proposals.pyramid import levels
from peopleboy.tracker.proposals.suppression import Proposals, suppress
from peopleboy.tracker.proposals.window import Floats
from peopleboy.tracker.thermal.mount import Mount

Grey = NDArray[np.uint8]

EARLIER_S: Final = 0.2
"""Age of the image that the present one is compared with."""

SMALLEST_PX: Final = 24.0
"""Height of the smallest people who are looked for."""

WEAKEST: Final = -3.5
"""Score of what trees propose from which on it is looked at again."""

_OLDEST_S: Final = 2.5 * EARLIER_S


class _Past(NamedTuple):
    grey: Grey
    time_s: float
    heading_rad: float
    is_known: bool  # how the robot turned since the image before


class PeopleDetector:
    """Where people may be in images that come one after another."""

    def __init__(
        self,
        model: PeopleModel | None = None,
        second_look: SecondLook | None = None,
        closer_look: CloserLook | None = None,
        *,
        smallest_px: float = SMALLEST_PX,
        least_score: float = 0.0,
    ) -> None:
        """Take the shipped trees and networks, or others.

        Args:
            model: the trees, which propose.
            second_look: looks again at what they propose.
            closer_look: looks closer at who was found.
            smallest_px: height of the smallest people who are looked for.
            least_score: of what is told.
        """
        self._model = shipped_model() if model is None else model
        self._second_look = shipped_network() if second_look is None else second_look
        self._closer_look = shipped_closer_look() if closer_look is None else closer_look
        self._smallest_px = smallest_px
        self._least_score = least_score
        self._past: deque[_Past] = deque()
        self._memory = Memory()

    def update(
        self,
        grey: Grey,
        time_s: float,
        odometry: Odometry | None = None,
        mount: Mount | None = None,
        expected: Proposals | None = None,
    ) -> Proposals:
        """Look for people.

        Args:
            grey: (H, W) image; greys may mean anything, as long as that does not change much in 0.2 s.
            time_s: when it was taken.
            odometry: how the robot moved since the last one; None if that is not known.
            mount: how the camera sits; None if that is not known: then people may be anywhere.
            expected: who alone is looked for, by what trees said of them when they were found; None for
                whoever is there.
        """
        return self.found(grey, self._change(grey, time_s, odometry, mount), mount, expected)

    def found(
        self, grey: Grey, change: Grey, mount: Mount | None, expected: Proposals | None = None
    ) -> Proposals:
        """Look for people in an image of which it is known by how much (H, W) greys changed."""
        first = expected
        if first is None:
            first = look(self._model, grey, change, mount, self._smallest_px, WEAKEST, self._memory)
        found = look_again(self._second_look, grey, change, first, mount, self._least_score)
        return look_closer(self._closer_look, grey, change, found, mount)

    def _change(self, grey: Grey, time_s: float, odometry: Odometry | None, mount: Mount | None) -> Grey:
        """Compare an image with the one of about 0.2 s ago, and keep it for later ones."""
        past = self._past
        if past and (past[-1].time_s >= time_s or past[-1].grey.shape != grey.shape):
            past.clear()
        heading = past[-1].heading_rad if past else 0.0
        turn_rad = odometry.turn_rad if odometry is not None else 0.0
        now = _Past(grey.copy(), time_s, heading + turn_rad, odometry is not None)
        past.append(now)
        while now.time_s - past[0].time_s > _OLDEST_S:
            past.popleft()
        earlier = [one for one in past if one is not now]
        if not earlier:
            return np.zeros_like(grey)
        before = min(earlier, key=lambda one: abs(now.time_s - one.time_s - EARLIER_S))
        since = [one for one in past if one.time_s > before.time_s]
        if mount is not None and all(one.is_known for one in since):
            return change(before.grey, grey, turned(mount, grey.shape, now.heading_rad - before.heading_rad))
        return change(before.grey, grey, shifted(before.grey, grey))


def look(
    model: PeopleModel,
    grey: Grey,
    change: Grey,
    mount: Mount | None,
    smallest_px: float,
    least_score: float,
    memory: Memory | None = None,
) -> Proposals:
    """Let trees look for people in an image of which it is known by how much (H, W) greys changed."""
    boxes: list[Floats] = [np.empty((0, 4))]
    scores: list[Floats] = [np.empty(0)]
    for level in levels(grey, change, mount, smallest_px, memory or Memory()):
        sums = summed(level.cells)
        for kind, trees in model.trees.items():
            for rows in level.rows[kind]:
                hits = trees.cascade.scan(sums, rows)
                is_sure = hits.score >= least_score
                if not is_sure.any():
                    continue
                row, column = hits.row[is_sure], hits.column[is_sure]
                boxes.append(trees.placing.boxes(sums, row, column, level.boxes(row, column)))
                scores.append(hits.score[is_sure])
    return suppress(Proposals.of_trees(np.concatenate(boxes), np.concatenate(scores)))
