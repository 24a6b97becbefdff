"""The metrics of multi-object tracking benchmarks: CLEAR MOT, identity and HOTA, in percent.

They are computed here with numpy and scipy alone, and agree with the reference implementation TrackEval,
except that a figure without a denominator is undefined (NaN), where TrackEval gives 0.
"""

from dataclasses import dataclass

from peopleboy.tracker.evaluation.association import Pairs
from peopleboy.tracker.evaluation.metrics.clear import Clear
from peopleboy.tracker.evaluation.metrics.hota import Hota
from peopleboy.tracker.evaluation.metrics.identity_metrics import Identity
from peopleboy.tracker.evaluation.metrics.sums import Sums
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True, eq=False)
class MotMetrics(Sums):
    """The three families."""

    clear: Clear
    identity: Identity
    hota: Hota


def measure_mot(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> MotMetrics:
    """Sum up one sequence."""
    return MotMetrics(
        clear=Clear.over(truth, tracks, pairs),
        identity=Identity.over(truth, tracks, pairs),
        hota=Hota.over(truth, tracks, pairs),
    )
