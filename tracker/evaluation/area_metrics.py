"""Area metrics of the 2007 thesis; temporal, detection and localisation metrics of the 2005 paper.

The paper's metrics (its section 4.2) differ from the thesis's: counts ignore the quality of a candidate, and
areas are compared without the 50 % gate. Where the paper is silent, it is read as follows.

- A range is the set of frames of a track. Ranges are paired one to one over the sequence by the largest sum
of
  IoU. A target's range without a partner scores 0; a candidate's range without one belongs to no pair (it
  lowers OCP and BAP).
- A target's candidate is its partner in the frame's one-to-one association by IoU, however small the
  overlap.
- Averages are weighted by the ratio's denominator. Counts are capped at 100 % in each frame. A metric without
  a denominator is undefined (NaN).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import Floats, area, cover
from peopleboy.tracker.evaluation.box_matching import Pairs, associate
from peopleboy.tracker.evaluation.sequence import Ints, Sums, TrackBoxes, TrueBoxes, percent, sum_by


@dataclass(frozen=True, slots=True)
class AreaSums(Sums):
    """Sums of covered shares of area; a target or candidate without a partner has a share of 0.

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        of_targets: sum over targets of the share covered by the target's candidate.
        of_candidates: sum over candidates of the share on the candidate's target.
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
        """Sum up a sequence with the matched pairs in rows (M,) of `pairs`."""
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
        """Mean covered share of a target [%]."""
        return percent(self.of_targets, self.targets)

    @property
    def precision(self) -> float:
        """Mean share of a candidate on its target [%]."""
        return percent(self.of_candidates, self.candidates)

    @property
    def accuracy(self) -> float:
        """Mean over frames, weighted by their number of boxes, of the Dice coefficient of the areas [%].

        A false positive lowers the coefficient of its frame, but raises the frame's weight: a small one in a
        good frame can raise the mean.
        """
        return percent(self.of_both, self.targets + self.candidates)


def _sum_dice(truth: TrueBoxes, tracks: TrackBoxes, shared_frame: Ints, shared: Floats) -> float:
    """Sum the frames' Dice coefficients of areas, each multiplied by the frame's number of boxes."""
    box_frame = np.concatenate([truth.frame, tracks.frame])
    box_area = np.concatenate([area(truth.box), area(tracks.box)])
    frames, frame = np.unique(box_frame, return_inverse=True)
    boxes = sum_by(frame, np.ones(len(frame)), len(frames))
    both = sum_by(frame, box_area, len(frames))
    common = sum_by(np.searchsorted(frames, shared_frame), shared, len(frames))
    return float((boxes * cover(2.0 * common, both)).sum())


@dataclass(frozen=True, slots=True)
class RangeSums(Sums):
    """Frames in the time ranges of tracks.

    Attributes:
        of_targets: sum of |R_T| over all target ranges.
        of_partners: sum of |R_C| over the candidate ranges that are a target's partner.
        common: sum of |R_T n R_C| over the pairs.
    """

    of_targets: int
    of_partners: int
    common: int

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Pair the ranges of one sequence and sum up."""
        target, of_target = truth.number_ids()
        candidate, of_candidate = tracks.number_ids()
        shape = (len(of_target), len(of_candidate))
        key = target[pairs.target] * shape[1] + candidate[pairs.candidate]
        overlap = sum_by(key, pairs.iou, shape[0] * shape[1]).reshape(shape)
        common = np.bincount(key, minlength=shape[0] * shape[1]).reshape(shape)
        row, column = linear_sum_assignment(overlap, maximize=True)
        is_pair = overlap[row, column] > 0.0
        row, column = row[is_pair], column[is_pair]
        return cls(len(truth), int(of_candidate[column].sum()), int(common[row, column].sum()))


@dataclass(frozen=True, slots=True)
class PaperMetrics(Sums):
    """Temporal correspondence, counts and areas.

    Attributes:
        ranges: time ranges of tracks.
        least: min(N_T, N_C) summed over the frames.
        areas: areas of targets (A_T) and candidates (A_C), and their intersections.
    """

    ranges: RangeSums
    least: int
    areas: AreaSums

    @property
    def oc(self) -> float:
        """Overlap coefficient |R_T n R_C| / |R_T|, eq. 5 [%]."""
        return percent(self.ranges.common, self.ranges.of_targets)

    @property
    def dc(self) -> float:
        """Dice coefficient 2 |R_T n R_C| / (|R_T| + |R_C|), eq. 6 [%]."""
        return percent(2 * self.ranges.common, self.ranges.of_targets + self.ranges.of_partners)

    @property
    def ocr(self) -> float:
        """Object count recall N_C / N_T, at most 100 in each frame, eq. 7 [%]."""
        return percent(self.least, self.areas.targets)

    @property
    def ocp(self) -> float:
        """Object count precision N_T / N_C, at most 100 in each frame, eq. 8 [%]."""
        return percent(self.least, self.areas.candidates)

    @property
    def oca(self) -> float:
        """Object count accuracy 2 min(N_T, N_C) / (N_T + N_C), eq. 9 [%]."""
        return percent(2 * self.least, self.areas.targets + self.areas.candidates)

    @property
    def oar(self) -> float:
        """Object area recall |A_T n A_C| / |A_T|, mean over targets, eq. 10 [%]."""
        return self.areas.recall

    @property
    def bap(self) -> float:
        """Box area precision |A_T n A_C| / |A_C|, mean over candidates, eq. 11 [%]."""
        return self.areas.precision

    @property
    def adc(self) -> float:
        """Area Dice coefficient 2 |A_T n A_C| / (|A_T| + |A_C|), areas summed within a frame, eq. 12 [%]."""
        return self.areas.accuracy


def measure_paper(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> PaperMetrics:
    """Sum up one sequence."""
    targets = np.diff(pairs.start) // pairs.width
    return PaperMetrics(
        ranges=RangeSums.over(truth, tracks, pairs),
        least=int(np.minimum(targets, pairs.width).sum()),
        areas=AreaSums.over(truth, tracks, pairs, associate(pairs, gate=0.0)),
    )


# The 2007 thesis's detection and localisation metrics (section 3.4), in percent.
#
# Candidates are associated with targets in each frame independently, by pairs with IoU > 0.5 only; every
# other candidate is a false positive. Each metric is "a weighted average of all frames"; the weight is read
# as the ratio's denominator (N_T, N_C or N_T + N_C), so that CR, CP and CA are ratios of totals. A metric
# without a denominator is undefined (NaN). Results above 100 % would be capped, but do not occur with
# one-to-one association.


@dataclass(frozen=True, slots=True)
class ThesisMetrics(Sums):
    """Detection and localisation of people.

    Attributes:
        matches: N_R summed over the frames.
        areas: covered areas of targets (A_T) and candidates (A_C) by correctly detected candidates (A_R).
    """

    matches: int
    areas: AreaSums

    @property
    def cr(self) -> float:
        """Count recall N_R / N_T, eq. 3.1 [%]."""
        return percent(self.matches, self.areas.targets)

    @property
    def cp(self) -> float:
        """Count precision N_R / N_C, eq. 3.2 [%]."""
        return percent(self.matches, self.areas.candidates)

    @property
    def ca(self) -> float:
        """Count accuracy 2 N_R / (N_T + N_C), eq. 3.3 [%]."""
        return percent(2 * self.matches, self.areas.targets + self.areas.candidates)

    @property
    def ar(self) -> float:
        """Area recall |A_T n A_R| / |A_T|, mean over targets, eq. 3.4 [%]."""
        return self.areas.recall

    @property
    def ap(self) -> float:
        """Area precision |A_T n A_R| / |A_C|, mean over candidates, eq. 3.5 [%]."""
        return self.areas.precision

    @property
    def aa(self) -> float:
        """Area accuracy 2 |A_T n A_R| / (|A_T| + |A_C|), areas summed within a frame, eq. 3.6 [%]."""
        return self.areas.accuracy


def measure_thesis(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs, matched: Ints) -> ThesisMetrics:
    """Sum up one sequence, given the rows (M,) `matched` of the pairs that are correct detections."""
    return ThesisMetrics(len(matched), AreaSums.over(truth, tracks, pairs, matched))
