"""Identity metrics: how long each person is followed under one name."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.evaluation.association import GATE, Pairs
from peopleboy.tracker.evaluation.metrics.sums import Sums, percent
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True)
class Identity(Sums):
    """Counts of the identity metrics.

    Persons are paired one to one with tracks over the whole sequence, so that the number of frames in which
    partners have IoU >= 0.5 is the largest possible.

    Source: Ristani et al. 2016.

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: targets that their person's partner covers (IDTP).
    """

    targets: int
    candidates: int
    matches: int

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Pair persons with tracks over one sequence."""
        person, of_person = truth.number_ids()
        track, of_track = tracks.number_ids()
        near = np.flatnonzero(pairs.iou >= GATE)
        key = person[pairs.target[near]] * len(of_track) + track[pairs.candidate[near]]
        frames = np.bincount(key, minlength=len(of_person) * len(of_track))
        frames = frames.reshape(len(of_person), len(of_track))
        partners = linear_sum_assignment(frames, maximize=True)
        return cls(len(truth), len(tracks), int(frames[partners].sum()))

    @property
    def idf1(self) -> float:
        """2 IDTP / (targets + candidates) [%]."""
        return percent(2 * self.matches, self.targets + self.candidates)

    @property
    def idp(self) -> float:
        """IDTP / candidates [%]."""
        return percent(self.matches, self.candidates)

    @property
    def idr(self) -> float:
        """IDTP / targets [%]."""
        return percent(self.matches, self.targets)
