"""HOTA: detection and association in balance, averaged over how strictly boxes must fit."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from peopleboy.tracker.boxes import Floats, cover
from peopleboy.tracker.evaluation.association import Pairs, assign
from peopleboy.tracker.evaluation.metrics.sums import Sums, sum_by
from peopleboy.tracker.evaluation.sequence import Ints, TrackBoxes, TrueBoxes

ALPHAS = np.arange(0.05, 0.99, 0.05)  # (19,) IoU that a match needs
ROUNDING = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class Hota(Sums):
    """Counts of HOTA at each of the 19 thresholds alpha = 0.05 .. 0.95.

    One assignment serves all thresholds: it prefers pairs of person and track that overlap much over the
    whole sequence.

    Source: Luiten et al. 2021, "HOTA: a higher order metric for evaluating multi-object tracking".

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: (19,) matched pairs (TP).
        association: (19,) sum over the matched pairs of the Jaccard index of their person and track: frames
            in which these two are matched / frames in which either is present.
    """

    targets: int
    candidates: int
    matches: Ints
    association: Floats

    def __post_init__(self) -> None:
        self.matches.setflags(write=False)
        self.association.setflags(write=False)

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Match one sequence at all thresholds."""
        key, present = _pair_ids(truth, tracks, pairs)  # (P,), (K,)
        common = sum_by(key, _share(pairs, len(truth), len(tracks)), len(present))
        alignment = cover(common, present - common)
        chosen = assign(pairs, alignment[key] * pairs.iou)

        matches, association = [], []
        for alpha in ALPHAS:
            matched = key[chosen[pairs.iou[chosen] >= alpha - ROUNDING]]
            frames = sum_by(matched, np.ones(len(matched)), len(present))  # (K,)
            matches.append(len(matched))
            association.append(float((frames * cover(frames, present - frames)).sum()))
        return cls(len(truth), len(tracks), np.array(matches), np.array(association))

    @property
    def hota(self) -> float:
        """Mean over alpha of the geometric mean of DetA and AssA [%]."""
        return self._average(np.sqrt(self._detection() * self._association()))

    @property
    def deta(self) -> float:
        """Detection accuracy TP / (TP + FN + FP), mean over alpha [%]."""
        return self._average(self._detection())

    @property
    def assa(self) -> float:
        """Association accuracy, mean over the matched pairs and over alpha [%]; 0 without a match."""
        return self._average(self._association())

    def _detection(self) -> Floats:
        matches = self.matches.astype(np.float64)
        return cover(matches, self.targets + self.candidates - matches)

    def _association(self) -> Floats:
        return cover(self.association, self.matches.astype(np.float64))

    def _average(self, by_alpha: Floats) -> float:
        """Average over alpha; undefined if there is neither a target nor a candidate."""
        return 100.0 * float(by_alpha.mean()) if self.targets + self.candidates else math.nan


def _pair_ids(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> tuple[Ints, Floats]:
    """Number the combinations of person and track that ever share a frame.

    Returns:
        The combination of each pair (P,), and the rows that person and track have together (K,).
    """
    person, of_person = truth.number_ids()
    track, of_track = tracks.number_ids()
    both = person[pairs.target] * len(of_track) + track[pairs.candidate]
    combination, key = np.unique(both, return_inverse=True)
    who, by = np.divmod(combination, max(len(of_track), 1))
    return key, (of_person[who] + of_track[by]).astype(np.float64)


def _share(pairs: Pairs, targets: int, candidates: int) -> Floats:
    """Give each pair's IoU as a share (P,) of all overlap that its target and its candidate have."""
    of_target = sum_by(pairs.target, pairs.iou, targets)[pairs.target]
    of_candidate = sum_by(pairs.candidate, pairs.iou, candidates)[pairs.candidate]
    return cover(pairs.iou, of_target + of_candidate - pairs.iou)
