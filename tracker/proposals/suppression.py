"""One box for each person, of the many windows that show them."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection, iou

Floats = NDArray[np.float64]

_SHARED: Final = 0.65  # of the smaller box: from then on two boxes are of one person
_ALIKE: Final = 0.5  # IoU of boxes of whom the mean is taken


class Proposals(NamedTuple):
    """Where people may be.

    Attributes:
        box: (N, 4) [px] from head to feet, the surest first.
        score: (N,) log odds, as far as training goes: 0 is even.
    """

    box: Floats
    score: Floats


def suppress(box: Floats, score: Floats) -> Proposals:
    """Keep the best of boxes that share much of the smaller one's area, each the mean of those like it.

    Greedy (Dollár et al., PAMI 2012). A box weighs exp(score) in the mean.

    Args:
        box: (N, 4) [px].
        score: (N,).
    """
    order = np.argsort(-score, kind="stable")
    box, score = box[order], score[order]
    is_left, kept, means = np.ones(len(box), np.bool_), [], []
    for k in range(len(box)):
        if not is_left[k]:
            continue
        shared = cover(intersection(box[k], box), np.minimum(area(box[k]), area(box)))
        weight = np.where(is_left & (iou(box[k], box) > _ALIKE), np.exp(score - score[k]), 0.0)
        means.append(weight @ box / weight.sum())
        kept.append(k)
        is_left &= shared <= _SHARED
    return Proposals(np.array(means).reshape(-1, 4), score[kept])
