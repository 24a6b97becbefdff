"""How well matched boxes cover each other: the part that the thesis's and the paper's metrics share."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from peopleboy.tracker.boxes import Floats, area, cover
from peopleboy.tracker.evaluation.association import Pairs
from peopleboy.tracker.evaluation.metrics.sums import Sums, percent, sum_by
from peopleboy.tracker.evaluation.sequence import Ints, TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True)
class AreaSums(Sums):
    """Sums of covered shares of area; a target or candidate without a partner is covered by 0.

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        of_targets: sum over targets of the share of the target that its candidate covers.
        of_candidates: sum over candidates of the share of the candidate that lies on its target.
        of_both: sum over frames of 2 * shared area / (area of all targets + area of all candidates), times
            the number of targets and candidates in the frame.
    """

    targets: int
    candidates: int
    of_targets: float
    of_candidates: float
    of_both: float

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs, matched: Ints) -> Self:
        """Sum up the sequence whose matched pairs are the rows (M,) of `pairs`."""
        target, candidate = pairs.target[matched], pairs.candidate[matched]
        shared = pairs.shared[matched]  # (M,)
        return cls(
            targets=len(truth),
            candidates=len(tracks),
            of_targets=float(cover(shared, area(truth.box[target])).sum()),
            of_candidates=float(cover(shared, area(tracks.box[candidate])).sum()),
            of_both=_sum_dice(truth, tracks, truth.frame[target], shared),
        )

    @property
    def recall(self) -> float:
        """Mean share of a target that is covered [%]."""
        return percent(self.of_targets, self.targets)

    @property
    def precision(self) -> float:
        """Mean share of a candidate that lies on its target [%]."""
        return percent(self.of_candidates, self.candidates)

    @property
    def accuracy(self) -> float:
        """Mean over frames, weighted by their boxes, of the Dice coefficient of the areas [%].

        A false alarm lowers the coefficient of its frame, but raises the frame's weight: with a small one in
        a good frame, the mean can rise.
        """
        return percent(self.of_both, self.targets + self.candidates)


def _sum_dice(truth: TrueBoxes, tracks: TrackBoxes, shared_frame: Ints, shared: Floats) -> float:
    """Sum the frames' Dice coefficients of areas, each times the number of boxes in its frame."""
    box_frame = np.concatenate([truth.frame, tracks.frame])
    box_area = np.concatenate([area(truth.box), area(tracks.box)])
    frames, frame = np.unique(box_frame, return_inverse=True)
    boxes = sum_by(frame, np.ones(len(frame)), len(frames))
    both = sum_by(frame, box_area, len(frames))
    common = sum_by(np.searchsorted(frames, shared_frame), shared, len(frames))
    return float((boxes * cover(2.0 * common, both)).sum())
