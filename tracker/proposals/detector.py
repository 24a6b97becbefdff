"""The detector of people in thermal images, which keeps the earlier images that tell what moves."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.proposals.channels import Memory
from peopleboy.tracker.proposals.looks.closer_look import CloserLook, look_closer, shipped_closer_look
from peopleboy.tracker.proposals.looks.convolution import Desk
from peopleboy.tracker.proposals.looks.one_thread import one_thread
from peopleboy.tracker.proposals.looks.second_look import SecondLook, look_again, shipped_network
from peopleboy.tracker.proposals.model import PeopleModel, shipped_model
from peopleboy.tracker.proposals.past_images import PastImages
from peopleboy.tracker.proposals.patches import summed
from peopleboy.tracker.proposals.pyramid import levels
from peopleboy.tracker.proposals.suppression import NOBODY, SHARED, Proposals, suppress

Grey = NDArray[np.uint8]

SMALLEST_PX: Final = 24.0
"""Height of the smallest people who are looked for."""

WEAKEST: Final = -3.5
"""Score of what trees propose from which on it is looked at again."""


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
        self._past = PastImages()
        self._memory, self._desk = Memory(), Desk()

    def update(
        self,
        grey: Grey,
        time_s: float,
        odometry: Odometry | None = None,
        mount: Mount | None = None,
        expected: Proposals = NOBODY,
        *,
        everywhere: bool = True,
    ) -> Proposals:
        """Look for people.

        Args:
            grey: (H, W) image; greys may mean anything, as long as that does not change much in 0.2 s.
            time_s: when it was taken.
            odometry: how the robot moved since the last one; None if that is not known.
            mount: how the camera sits; None if that is not known: then people may be anywhere.
            expected: who is known, and how sure trees were when they found them: they need not be found.
            everywhere: whether others are looked for, too. If nobody is the image is kept, and not looked at.
        """
        self._past.keep(grey, time_s, odometry)
        if not everywhere and len(expected.box) == 0:
            return expected
        return self.found(grey, self._past.change(mount), mount, expected, everywhere=everywhere)

    def found(
        self, grey: Grey, change: Grey, mount: Mount | None, expected: Proposals, *, everywhere: bool
    ) -> Proposals:
        """Look for people in an image of which it is known by how much (H, W) greys changed."""
        first = self.proposed(grey, change, mount, expected) if everywhere else expected
        with one_thread():  # here once for both networks: to tell the library takes a while
            found = look_again(self._second_look, grey, change, first, mount, self._least_score, self._desk)
            return look_closer(self._closer_look, grey, change, found, mount, self._desk)

    def proposed(self, grey: Grey, change: Grey, mount: Mount | None, known: Proposals) -> Proposals:
        """Let trees look for people, and propose those who are known as well."""
        return look(self._model, grey, change, mount, self._smallest_px, WEAKEST, known, self._memory)


def look(
    model: PeopleModel,
    grey: Grey,
    change: Grey,
    mount: Mount | None,
    smallest_px: float,
    least_score: float,
    known: Proposals = NOBODY,
    memory: Memory | None = None,
) -> Proposals:
    """Let trees look for people in an image of which it is known by how much (H, W) greys changed.

    They pass by those who are known, and propose them as well.
    """
    boxes, scores = [known.box], [known.trees]
    for level in levels(grey, change, mount, smallest_px, memory or Memory()):
        sums = summed(level.cells)
        is_known = level.covered(known.box, SHARED) if len(known.box) else None
        for kind, trees in model.trees.items():
            for rows in level.rows[kind]:
                hits = trees.cascade.scan(sums, rows, is_known)
                is_sure = hits.score >= least_score
                if not is_sure.any():
                    continue
                hits = hits.taken(is_sure)
                if mount is not None:  # of a camera that is not known all tell something
                    hits = hits.best()
                row, column = hits.row, hits.column
                boxes.append(trees.placing.boxes(sums, row, column, level.boxes(row, column)))
                scores.append(hits.score)
    return suppress(Proposals.of_trees(np.concatenate(boxes), np.concatenate(scores)))
