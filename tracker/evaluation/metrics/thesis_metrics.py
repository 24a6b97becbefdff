"""The 2007 thesis's detection and localisation metrics (section 3.4), in percent.

Candidates are associated with targets in each frame on its own, by pairs with IoU > 0.5 only; every other
candidate is a false alarm. Each metric is "a weighted average of all frames"; the weight is read as the count
that the ratio is over (N_T, N_C or N_T + N_C), so that CR, CP and CA are ratios of totals. A metric without a
denominator is undefined (NaN). Results above 100 % are capped, which one-to-one association never needs.
"""

from dataclasses import dataclass

from peopleboy.tracker.evaluation.association import Pairs
from peopleboy.tracker.evaluation.metrics.areas import AreaSums
from peopleboy.tracker.evaluation.metrics.sums import Sums, percent
from peopleboy.tracker.evaluation.sequence import Ints, TrackBoxes, TrueBoxes


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
    """Sum up one sequence, whose correct detections are the rows `matched` (M,) of the pairs."""
    return ThesisMetrics(len(matched), AreaSums.over(truth, tracks, pairs, matched))
