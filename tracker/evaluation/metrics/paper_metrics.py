"""The 2005 paper's temporal, detection and localisation metrics (section 4.2), in percent.

They differ from the thesis's: counts take no notice of how well a candidate fits, and areas are compared
without the 50 % gate. Where the paper is silent, it is read as follows.

- A range is the set of frames that a track has. Ranges are paired one to one over the sequence by the largest
  sum of IoU. A target's range without a partner scores 0; a candidate's range without one belongs to no pair
  (it costs OCP and BAP).
- The candidate that corresponds to a target is its partner in the frame's one-to-one association by IoU,
  however small the overlap.
- Averages are weighted by the count that the ratio is over. Counts are capped at 100 % in each frame. A
  metric without a denominator is undefined (NaN).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.evaluation.association import Pairs, associate
from peopleboy.tracker.evaluation.metrics.areas import AreaSums
from peopleboy.tracker.evaluation.metrics.sums import Sums, percent, sum_by
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True)
class RangeSums(Sums):
    """Frames in the time ranges of tracks.

    Attributes:
        of_targets: sum of |R_T| over all target ranges.
        of_partners: sum of |R_C| over the candidate ranges that are some target's partner.
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
        areas: areas of targets (A_T) and candidates (A_C), and what they share.
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
