"""Who is whom: proposals are given to those who are expected there and look so, who was seen last first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.by_detection.config import MatchingConfig
from peopleboy.tracker.by_detection.target import Target

Floats = NDArray[np.float64]

_NEVER: Final = 1e6
_SEEN, _UNTOLD, _LOST = range(3)


def matched(
    targets: Sequence[Target],
    distance: Floats,
    overlap: Floats,
    likeness: Floats,
    is_coloured: NDArray[np.bool_],
    score: Floats,
    known: Mapping[int, int],
    time_s: float,
    config: MatchingConfig,
) -> dict[int, int]:
    """Give the number of the proposal that is each target's, by the target's number.

    Args:
        targets: K of them.
        distance: (K, M) Mahalanobis.
        overlap: (K, M) of boxes.
        likeness: (K, M) of looks, -1 to 1.
        is_coloured: (K, M) whether that is by colours, which tell somebody who was lost wherever he is.
        score: (M,) of proposals.
        known: whose proposals are known.
        time_s: now.
        config: what things cost.
    """
    ranks = np.array([_rank(target, time_s, config) for target in targets], int)
    is_lost = ranks[:, None] == _LOST
    is_same = is_coloured & (likeness > config.colours_of_same)
    distance = np.where(is_lost & is_same, np.minimum(distance, config.gate), distance)
    cost = (
        config.path * distance
        + config.overlap * (1.0 - overlap)
        + config.looks * (1.0 - likeness)
        - config.score * np.minimum(score, 4.0)[None]
    )
    cost[(distance > config.gate) | (cost > config.highest)] = _NEVER
    cost[is_lost & ~np.where(is_coloured, is_same, likeness > config.looks_of_lost)] = _NEVER
    found = dict(known)
    for rank in (_SEEN, _UNTOLD, _LOST):
        rows = np.array([i for i in np.flatnonzero(ranks == rank) if i not in known], int)
        columns = np.array([j for j in range(len(score)) if j not in found.values()], int)
        if len(rows) and len(columns):
            some = cost[np.ix_(rows, columns)]
            pairs = zip(*linear_sum_assignment(some), strict=True)
            found |= {int(rows[i]): int(columns[j]) for i, j in pairs if some[i, j] < _NEVER}
    return found


def _rank(target: Target, time_s: float, config: MatchingConfig) -> int:
    """Tell whose turn it is: those who are seen, those who may be somebody, and those who were lost."""
    if not target.is_told:
        return _UNTOLD
    return _SEEN if time_s - target.seen_s < config.lost_s else _LOST
