"""Which candidate is which target, each frame on its own."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import Floats, intersection, iou
from peopleboy.tracker.evaluation.sequence import Ints, TrackBoxes, TrueBoxes

GATE = 0.5  # a pair must overlap by more than this (thesis, section 3.4)


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Every target with every candidate of its frame.

    Ordered by frame, target, candidate, so that the pairs of one frame are a matrix in row-major order.

    Attributes:
        target: (P,) row of the truth.
        candidate: (P,) row of the tracks.
        shared: (P,) area that both cover [px^2].
        iou: (P,) their intersection over union.
        start: (F + 1,) first pair of each of the F frames that have both targets and candidates, and P.
        width: (F,) how many candidates each of these frames has.
    """

    target: Ints
    candidate: Ints
    shared: Floats
    iou: Floats
    start: Ints
    width: Ints

    def frames(self) -> Iterator[tuple[slice, int]]:
        """Yield for each frame its pairs and its number of candidates."""
        start = self.start.tolist()
        for first, last, width in zip(start[:-1], start[1:], self.width.tolist(), strict=True):
            yield slice(first, last), width


def pair_up(truth: TrueBoxes, tracks: TrackBoxes) -> Pairs:
    """Pair every target with every candidate of its frame."""
    frames = np.intersect1d(truth.frame, tracks.frame)
    first_target, targets = _span(truth.frame, frames)
    first_candidate, candidates = _span(tracks.frame, frames)
    start = np.concatenate([[0], np.cumsum(targets * candidates)])
    frame = np.repeat(np.arange(len(frames)), targets * candidates)  # (P,)
    row, column = np.divmod(np.arange(start[-1]) - start[frame], candidates[frame])
    target, candidate = first_target[frame] + row, first_candidate[frame] + column
    boxes = truth.box[target], tracks.box[candidate]
    shared, overlap = (measure(*boxes, truth.around_px) for measure in (intersection, iou))
    return Pairs(target, candidate, shared, overlap, start, candidates)


def associate(pairs: Pairs, gate: float = GATE) -> Ints:
    """Choose pairs (M,), at most one per target and per candidate, each with more IoU than the gate.

    In each frame the sum of the chosen IoUs is the largest possible. Identity over time plays no part.

    Source: thesis, section 3.4; its "overlap ratio" is read as intersection over union.
    """
    score = np.where(pairs.iou > gate, pairs.iou, 0.0)
    chosen = assign(pairs, score)
    return chosen[score[chosen] > 0.0]


def assign(pairs: Pairs, score: Floats) -> Ints:
    """Choose pairs (M,), at most one per target and candidate, with the largest sum of scores (P,) per frame.

    As many pairs as possible are chosen: pairs of score 0 may be among them.
    """
    chosen = [np.zeros(0, dtype=np.int64)]
    for frame, width in pairs.frames():
        row, column = linear_sum_assignment(score[frame].reshape(-1, width), maximize=True)
        chosen.append(frame.start + row * width + column)
    return np.concatenate(chosen)


def _span(frame: Ints, frames: Ints) -> tuple[Ints, Ints]:
    """Find each of the frames in the sorted column: its first row, and its number of rows."""
    first = np.searchsorted(frame, frames, side="left")
    return first, np.searchsorted(frame, frames, side="right") - first
