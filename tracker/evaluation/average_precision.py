"""Average precision of detections in single images, by the rules of COCO (Lin et al., ECCV 2014)."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.evaluation.box_matching import Pairs, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Flags = NDArray[np.bool_]

OVERLAPS: Final = tuple(np.linspace(0.5, 0.95, 10).round(2).tolist())
"""IoU thresholds of COCO's AP, the mean of the average precisions at each of them."""
_RECALLS: Final = np.linspace(0.0, 1.0, 101)
_TIE: Final = 1e-10


@dataclass(frozen=True, slots=True)
class AveragePrecision:
    """Average precision in percent; NaN if there are no people.

    Attributes:
        ap: mean over `OVERLAPS`.
        ap50: at an IoU of 0.5.
    """

    ap: float
    ap50: float


def average_precision(
    truth: TrueBoxes, found: TrackBoxes, heights_px: tuple[float, float] = (0.0, np.inf)
) -> AveragePrecision:
    """Return the average precision of detections, whose confidence orders them.

    Args:
        truth: people; those that are not counted are ignored, and so are detections of them.
        found: detections; their ids only need to differ within a frame.
        heights_px: heights of the people that count, from the first up to, but not including, the second;
            others are ignored, and so are unmatched detections of other heights.
    """
    low, high = heights_px
    counted = truth.counted & (low <= truth.box[:, 3]) & (truth.box[:, 3] < high)
    fits = (low <= found.box[:, 3]) & (found.box[:, 3] < high)
    pairs, order = pair_up(truth, found), np.argsort(-found.confidence, kind="stable")
    values = []
    for overlap in OVERLAPS:
        is_right, is_ignored = _matched(pairs, order, counted, fits, overlap)
        values.append(100.0 * _precision(is_right[order], is_ignored[order], int(counted.sum())))
    return AveragePrecision(float(np.mean(values)), values[0])


def _matched(
    pairs: Pairs, order: NDArray[np.intp], counted: Flags, fits: Flags, overlap: float
) -> tuple[Flags, Flags]:
    """Return which detections (N,) are right, and which are ignored.

    In order of confidence, each detection matches the unmatched person with the largest overlap. Without one,
    it may match an ignored person, who can match several detections.
    """
    is_right, is_ignored = np.zeros(len(order), np.bool_), ~fits
    is_near = pairs.iou >= overlap - _TIE
    rows: dict[int, list[tuple[int, float]]] = {}
    for target, candidate, shared in zip(
        pairs.target[is_near].tolist(),
        pairs.candidate[is_near].tolist(),
        pairs.iou[is_near].tolist(),
        strict=True,
    ):
        rows.setdefault(candidate, []).append((target, shared))
    is_taken = np.zeros(len(counted), np.bool_)
    for candidate in order.tolist():
        near = rows.get(candidate, [])
        free = [(shared, -target) for target, shared in near if counted[target] and not is_taken[target]]
        if free:
            is_taken[-max(free)[1]] = is_right[candidate] = True
            is_ignored[candidate] = False
        elif any(not counted[target] for target, _ in near):
            is_ignored[candidate] = True
    return is_right, is_ignored


def _precision(is_right: Flags, is_ignored: Flags, people: int) -> float:
    """Return the mean precision at 101 recalls, from detections (N,) in descending order."""
    if not people:
        return np.nan
    right = np.cumsum(is_right[~is_ignored])
    precision = right / np.arange(1, len(right) + 1)
    envelope = np.maximum.accumulate(precision[::-1])[::-1]
    reached = np.searchsorted(right / people, _RECALLS)
    return float(np.append(envelope, 0.0)[reached].mean())
