"""Detections, and non-maximum suppression: one box per person from many overlapping windows."""

import math
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection

Floats = NDArray[np.float64]

# The shipped networks were trained on detections that these numbers left: others need new training.
SHARED: Final = 0.65  # share of the smaller box from which two boxes show one person
_ALIKE: Final = 0.5  # IoU of boxes that are averaged
_TOUCHED: Final = 0.12  # least share of a box overlapped by its left, and by its right neighbour
_BETWEEN: Final = 0.6  # share of a box covered by both neighbours


class Detections(NamedTuple):
    """People detected in one image.

    Attributes:
        box: (N, 4) [px] from head to feet, the highest score first.
        score: (N,) log-odds, calibrated on images like those of the training.
        trees: (N,) log-odds of the cascade alone.
        edges: (N, 2) left and right edge of the whole person, from the middle of the box to the right, in
            heights of the box; NaN where unknown.
    """

    box: Floats
    score: Floats
    trees: Floats
    edges: Floats

    @classmethod
    def from_trees(cls, box: Floats, score: Floats) -> "Detections":
        """Make detections of the cascade alone, before rescoring."""
        return cls.of(box, score, score)

    @classmethod
    def of(cls, box: Floats, score: Floats, trees: Floats) -> "Detections":
        """Make detections of people whose edges are unknown."""
        return cls(box, score, trees, np.full((len(box), 2), math.nan))

    def take(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> "Detections":
        """Return the detections of these rows."""
        return Detections(*(column[rows] for column in self))

    def joined(self, others: "Detections") -> "Detections":
        """Return these detections, then others."""
        return Detections(*(np.concatenate(both) for both in zip(self, others, strict=True)))


NO_DETECTIONS: Final = Detections.from_trees(np.empty((0, 4)), np.empty(0))


def suppress(found: Detections) -> Detections:
    """Keep the best of overlapping boxes, each averaged with similar ones.

    Greedy (Dollár et al., PAMI 2012), with weights exp(score) in the average. A box is dropped if it lies
    between two boxes with higher scores that cover most of it.
    """
    ordered = found.take(np.argsort(-found.score, kind="stable"))
    means = np.empty((len(ordered.box), 4))
    kept = _best(ordered.box, ordered.score, means)
    ours = ordered.take(kept)._replace(box=means[: len(kept)])
    return ours.take(~_is_between(ours))


@njit(cache=True, nogil=True)
def _best(box: Floats, score: Floats, means: Floats) -> NDArray[np.intp]:  # pragma: no cover
    """Return the best of overlapping boxes (N, 4), the highest score first, and write the averages (N, 4)."""
    kept, is_left = np.empty(len(box), np.intp), np.ones(len(box), np.bool_)
    count = 0
    for k in range(len(box)):
        if not is_left[k]:
            continue
        total, mean = 0.0, np.zeros(4)
        for j in range(len(box)):
            across = min(box[k, 0] + box[k, 2], box[j, 0] + box[j, 2]) - max(box[k, 0], box[j, 0])
            down = min(box[k, 1] + box[k, 3], box[j, 1] + box[j, 3]) - max(box[k, 1], box[j, 1])
            common = max(across, 0.0) * max(down, 0.0)
            ours, theirs = box[k, 2] * box[k, 3], box[j, 2] * box[j, 3]
            if j == k or (is_left[j] and common > _ALIKE * (ours + theirs - common)):
                weight = math.exp(score[j] - score[k])
                total += weight
                mean += weight * box[j]
            is_left[j] &= common <= SHARED * min(ours, theirs)
        means[count], kept[count] = mean / total, k
        count += 1
    return kept[:count]


def _is_between(found: Detections) -> NDArray[np.bool_]:
    """Return which of N boxes only show arms of their left and right neighbours."""
    share = cover(intersection(found.box[:, None], found.box[None]), area(found.box)[:, None])
    share *= found.score[None] > found.score[:, None]
    middle = found.box[:, 0] + found.box[:, 2] / 2.0
    is_left = middle[None] < middle[:, None]
    left, right = ((share * side).max(axis=1, initial=0.0) for side in (is_left, ~is_left))
    return np.asarray((np.minimum(left, right) > _TOUCHED) & (left + right > _BETWEEN))
