"""The metrics of multi-object tracking benchmarks: CLEAR MOT, identity and HOTA, in percent.

They use NumPy and SciPy alone, and agree with the reference implementation TrackEval, except that a metric
without a denominator is undefined (NaN), where TrackEval gives 0.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import Floats, cover
from peopleboy.tracker.evaluation.box_matching import GATE, ROUNDING, Pairs
from peopleboy.tracker.evaluation.hota import Hota
from peopleboy.tracker.evaluation.sequence import Bools, Ints, Sums, TrackBoxes, TrueBoxes, percent

# CLEAR MOT: misses, false positives and identity switches in one metric.

KEPT = 1000.0  # a kept identity outweighs any overlap
MOSTLY_TRACKED = 0.8  # share of a person's frames with a match, above which the person is mostly tracked
MOSTLY_LOST = 0.2  # share below which the person is mostly lost


@dataclass(frozen=True, slots=True)
class Clear(Sums):
    """Counts of CLEAR MOT, whose matches need IoU >= 0.5.

    A person keeps the track of the previous frame as long as the overlap suffices; the others are matched by
    the largest sum of IoU. "Previous" is the last frame that had both targets and candidates, as in
    TrackEval.

    Source: Bernardin and Stiefelhagen 2008, as TrackEval implements it.

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: number of matched pairs.
        switches: number of matches of a person to another track than at the last match (IDSW).
        overlap: sum of the IoU of the matched pairs.
        mostly_tracked: persons matched in more than 80 % of their frames (MT).
        mostly_lost: persons matched in less than 20 % of their frames (ML).
        fragments: interruptions of matches, after which a person is matched again (Frag).
    """

    targets: int
    candidates: int
    matches: int
    switches: int
    overlap: float
    mostly_tracked: int
    mostly_lost: int
    fragments: int

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Match one sequence frame after frame."""
        person, rows = truth.number_ids()
        track, _ = tracks.number_ids()
        person, track = person[pairs.target], track[pairs.candidate]  # (P,)
        last = np.full(len(rows), -1)  # each person's track at the last match
        previous = last.copy()  # the same, but -1 for people without a match in the previous frame
        found, spans = np.zeros((2, len(rows)), dtype=np.int64)  # each person's matches, and runs of them
        switches, overlap = 0, 0.0
        for frame, width in pairs.frames():
            is_kept = previous[person[frame]] == track[frame]
            matched = frame.start + _match_frame(pairs.iou[frame], is_kept, width)
            who, by = person[matched], track[matched]
            switches += int(((last[who] >= 0) & (last[who] != by)).sum())
            found[who] += 1
            spans[who] += previous[who] < 0
            overlap += float(pairs.iou[matched].sum())
            last[who] = by
            previous = np.full(len(rows), -1)
            previous[who] = by
        share = cover(found.astype(np.float64), rows.astype(np.float64))
        return cls(
            len(truth),
            len(tracks),
            int(found.sum()),
            switches,
            overlap,
            mostly_tracked=int((share > MOSTLY_TRACKED).sum()),
            mostly_lost=int((share < MOSTLY_LOST).sum()),
            fragments=int((spans - 1).clip(0).sum()),
        )

    @property
    def misses(self) -> int:
        """Targets that are not matched (FN)."""
        return self.targets - self.matches

    @property
    def false_positives(self) -> int:
        """Candidates that are not matched (FP)."""
        return self.candidates - self.matches

    @property
    def mota(self) -> float:
        """1 - (FN + FP + IDSW) / targets [%]; negative if there are more errors than targets."""
        errors = self.misses + self.false_positives + self.switches
        return percent(self.targets - errors, self.targets)

    @property
    def motp(self) -> float:
        """Mean IoU of the matched pairs [%]."""
        return percent(self.overlap, self.matches)


def _match_frame(overlap: Floats, is_kept: Bools, width: int) -> Ints:
    """Choose pairs (M,) among those of one frame (P,), which are a matrix with `width` columns."""
    score = np.where(overlap >= GATE - ROUNDING, KEPT * is_kept + overlap, 0.0)
    row, column = linear_sum_assignment(score.reshape(-1, width), maximize=True)
    chosen: Ints = row * width + column
    return chosen[score[chosen] > 0.0]


# Identity metrics: how long each person keeps one track id.


@dataclass(frozen=True, slots=True)
class Identity(Sums):
    """Counts of the identity metrics.

    Persons are paired one to one with tracks over the whole sequence, at the largest number of frames in
    which partners have IoU >= 0.5.

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


@dataclass(frozen=True, slots=True, eq=False)
class MotMetrics(Sums):
    """The three families of metrics."""

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
