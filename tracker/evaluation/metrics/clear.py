"""CLEAR MOT: misses, false positives and identity switches in one figure."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.association import GATE, Pairs
from peopleboy.tracker.evaluation.metrics.sums import Sums, percent
from peopleboy.tracker.evaluation.sequence import Bools, Ints, TrackBoxes, TrueBoxes

ROUNDING = float(np.finfo(np.float64).eps)
KEPT = 1000.0  # a kept identity outweighs any overlap


@dataclass(frozen=True, slots=True)
class Clear(Sums):
    """Counts of CLEAR MOT, whose matches need IoU >= 0.5.

    A person keeps the track of the previous frame as long as the two overlap enough; the others are matched
    by the largest sum of IoU. "Previous" is the last frame that had both targets and candidates, as in
    TrackEval.

    Source: Bernardin and Stiefelhagen 2008, as TrackEval implements it.

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: number of matched pairs.
        switches: how often a person is matched to another track than at the last match (IDSW).
        overlap: sum of the IoU of the matched pairs.
    """

    targets: int
    candidates: int
    matches: int
    switches: int
    overlap: float

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Match one sequence frame after frame."""
        person, rows = truth.number_ids()
        track, _ = tracks.number_ids()
        person, track = person[pairs.target], track[pairs.candidate]  # (P,)
        last = np.full(len(rows), -1)  # each person's track at the last match
        previous = last.copy()  # the same, but -1 for those who were not matched in the previous frame
        matches, switches, overlap = 0, 0, 0.0
        for frame, width in pairs.frames():
            is_kept = previous[person[frame]] == track[frame]
            matched = frame.start + _match_frame(pairs.iou[frame], is_kept, width)
            who, by = person[matched], track[matched]
            switches += int(((last[who] >= 0) & (last[who] != by)).sum())
            matches += len(matched)
            overlap += float(pairs.iou[matched].sum())
            last[who] = by
            previous = np.full(len(rows), -1)
            previous[who] = by
        return cls(len(truth), len(tracks), matches, switches, overlap)

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
