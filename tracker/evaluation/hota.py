"""HOTA: detection and association in balance, averaged over IoU thresholds."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from peopleboy.tracker.boxes import Floats, cover
from peopleboy.tracker.evaluation.box_matching import ROUNDING, Pairs, assign
from peopleboy.tracker.evaluation.sequence import Ints, Sums, TrackBoxes, TrueBoxes, sum_by

ALPHAS = np.arange(0.05, 0.99, 0.05)  # (19,) IoU thresholds of a match


@dataclass(frozen=True, slots=True, eq=False)
class Hota(Sums):
    """Counts of HOTA at each of the 19 thresholds alpha = 0.05 .. 0.95.

    One assignment is used for all thresholds: it prefers pairs of person and track that overlap much over the
    whole sequence.

    Source: Luiten et al. 2021, "HOTA: a higher order metric for evaluating multi-object tracking".

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: (19,) matched pairs (TP).
        association: (19,) sum over the matched pairs of the Jaccard index of their person and track: frames
            in which these two are matched / frames in which either is present.
        recall: (19,) likewise / frames in which the person is present.
        precision: (19,) likewise / frames in which the track is present.
        overlap: (19,) sum of the IoU of the matched pairs.
    """

    targets: int
    candidates: int
    matches: Ints
    association: Floats
    recall: Floats
    precision: Floats
    overlap: Floats

    def __post_init__(self) -> None:
        for values in (self.matches, self.association, self.recall, self.precision, self.overlap):
            values.setflags(write=False)

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Match one sequence at all thresholds."""
        key, person, track = _pair_ids(truth, tracks, pairs)  # (P,), (K,), (K,)
        present = person + track
        common = sum_by(key, _share(pairs, len(truth), len(tracks)), len(present))
        alignment = cover(common, present - common)
        chosen = assign(pairs, alignment[key] * pairs.iou)

        sums = np.zeros((len(ALPHAS), 5))
        for row, alpha in zip(sums, ALPHAS, strict=True):
            matched = chosen[pairs.iou[chosen] >= alpha - ROUNDING]
            frames = sum_by(key[matched], np.ones(len(matched)), len(present))  # (K,)
            shares = (cover(frames, whole) for whole in (present - frames, person, track))
            row[:] = len(matched), *((frames * share).sum() for share in shares), pairs.iou[matched].sum()
        matches, *others = sums.T.copy()
        return cls(len(truth), len(tracks), matches.astype(np.int64), *others)

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

    @property
    def detre(self) -> float:
        """Detection recall TP / (TP + FN), mean over alpha [%]."""
        return self._average(cover(self._matches, np.asarray(float(self.targets))))

    @property
    def detpr(self) -> float:
        """Detection precision TP / (TP + FP), mean over alpha [%]."""
        return self._average(cover(self._matches, np.asarray(float(self.candidates))))

    @property
    def assre(self) -> float:
        """Association recall, mean over the matched pairs and over alpha [%]; 0 without a match."""
        return self._average(cover(self.recall, self._matches))

    @property
    def asspr(self) -> float:
        """Association precision, mean over the matched pairs and over alpha [%]; 0 without a match."""
        return self._average(cover(self.precision, self._matches))

    @property
    def loca(self) -> float:
        """Mean IoU of the matched pairs, mean over alpha [%]; 100 at an alpha without a match."""
        return self._average(np.where(self.matches > 0, cover(self.overlap, self._matches), 1.0))

    @property
    def _matches(self) -> Floats:
        return self.matches.astype(np.float64)

    def _detection(self) -> Floats:
        return cover(self._matches, self.targets + self.candidates - self._matches)

    def _association(self) -> Floats:
        return cover(self.association, self._matches)

    def _average(self, by_alpha: Floats) -> float:
        """Average over alpha; undefined if there is neither a target nor a candidate."""
        return 100.0 * float(by_alpha.mean()) if self.targets + self.candidates else math.nan


def _pair_ids(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> tuple[Ints, Floats, Floats]:
    """Number the combinations of person and track that share a frame.

    Returns:
        The combination of each pair (P,), and the number of rows of its person (K,) and of its track (K,).
    """
    person, of_person = truth.number_ids()
    track, of_track = tracks.number_ids()
    both = person[pairs.target] * len(of_track) + track[pairs.candidate]
    combination, key = np.unique(both, return_inverse=True)
    who, by = np.divmod(combination, max(len(of_track), 1))
    return key, of_person[who].astype(np.float64), of_track[by].astype(np.float64)


def _share(pairs: Pairs, targets: int, candidates: int) -> Floats:
    """Return each pair's IoU as a share (P,) of all overlap of its target and its candidate."""
    of_target = sum_by(pairs.target, pairs.iou, targets)[pairs.target]
    of_candidate = sum_by(pairs.candidate, pairs.iou, candidates)[pairs.candidate]
    return cover(pairs.iou, of_target + of_candidate - pairs.iou)
