"""Association of detections with tracks by position and appearance; recently seen tracks come first."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import area, cover, intersection, iou, shared_of_smaller
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.tracking.appearance import (
    Colours,
    Pattern,
    colour_similarities,
)
from peopleboy.tracker.tracking.config import AssociationConfig
from peopleboy.tracker.tracking.track_state import TrackState

_NEVER: Final = 1e6
_SEEN, _TENTATIVE, _LOST = range(3)


def associate(
    targets: Sequence[TrackState],
    distance: Floats,
    overlap: Floats,
    likeness: Floats,
    is_coloured: NDArray[np.bool_],
    same_person: Floats | None,
    score: Floats,
    known: Mapping[int, int],
    time_s: float,
    config: AssociationConfig,
) -> dict[int, int]:
    """Return the index of each associated track's detection, by the index of the track.

    Args:
        targets: K tracks.
        distance: (K, M) Mahalanobis distances.
        overlap: (K, M) overlaps of the boxes.
        likeness: (K, M) similarity of appearance, -1 to 1.
        is_coloured: (K, M) whether the similarity is that of colours.
        same_person: (K, M) log-odds by which a detection continues a lost track, less those needed; None if
            lost tracks are recognised by their appearance alone.
        score: (M,) scores of the detections.
        known: tracks whose detections are already known.
        time_s: current time.
        config: association costs.
    """
    ranks = np.array([_rank(target, time_s, config) for target in targets], int)
    is_lost = ranks[:, None] == _LOST
    is_same = is_coloured & (likeness > config.colours_of_same)
    if same_person is None:  # colours reidentify a lost track anywhere
        distance = np.where(is_lost & is_same, np.minimum(distance, config.gate), distance)
    cost = (
        config.motion * distance
        + config.overlap * (1.0 - overlap)
        + config.appearance * (1.0 - likeness)
        - config.score * np.minimum(score, 4.0)[None]
    )
    cost[(distance > config.gate) | (cost > config.highest)] = _NEVER
    if same_person is None:
        cost[is_lost & ~np.where(is_coloured, is_same, likeness > config.pattern_of_lost)] = _NEVER
    else:
        cost = np.where(is_lost, np.where(same_person > 0.0, -same_person, _NEVER), cost)
    found = dict(known)
    for rank in (_SEEN, _TENTATIVE, _LOST):
        rows = np.array([i for i in np.flatnonzero(ranks == rank) if i not in known], int)
        columns = np.array([j for j in range(len(score)) if j not in found.values()], int)
        if len(rows) and len(columns):
            some = cost[np.ix_(rows, columns)]
            pairs = zip(*linear_sum_assignment(some), strict=True)
            found |= {int(rows[i]): int(columns[j]) for i, j in pairs if some[i, j] < _NEVER}
    return found


def _rank(target: TrackState, time_s: float, config: AssociationConfig) -> int:
    """Group the tracks in order of association: seen recently, tentative, lost."""
    if not target.is_confirmed:
        return _TENTATIVE
    return _SEEN if time_s - target.seen_s < config.lost_s else _LOST


# Overlaps of tracks in the image, and their depth order.

Flags = NDArray[np.bool_]

_COVERED: Final = 0.35  # share of a box that is covered by an occluder
_LOWER: Final = 0.03  # a person whose feet are this much lower in the image, in heights, is in front
CLEAR: Final = 0.2
"""Greatest overlap at which a person counts as separate from another one."""


def are_overlapped(expected: Floats, is_confirmed: Flags) -> Flags:
    """Return for K people with boxes (K, 4) whether each overlaps another confirmed person."""
    mutual = iou(expected[:, None], expected[None]) * ~np.eye(len(expected), dtype=bool)
    return np.asarray((is_confirmed[None] & (mutual > CLEAR)).any(axis=1))


def find_occluders(expected: Floats, is_confirmed: Flags, found: Iterable[int]) -> list[int | None]:
    """Return for each of K people with boxes (K, 4) the detected person that may occlude them."""
    covered = cover(intersection(expected[:, None], expected[None]), area(expected)[:, None])
    foot = expected[:, 1] + expected[:, 3]
    hides = (
        (covered > _COVERED) & (foot[None] > (foot - _LOWER * expected[:, 3])[:, None]) & is_confirmed[None]
    )
    is_found = np.zeros(len(expected), np.bool_)
    is_found[list(found)] = True
    hides &= is_found[None] & ~np.eye(len(expected), dtype=bool)
    return [
        int(np.argmax(covered[row] * hides[row])) if hides[row].any() else None for row in range(len(hides))
    ]


def shared_area(boxes: Floats, theirs: Sequence[int]) -> Floats:
    """Return the greatest share of the smaller box that each of (M, 4) shares with one of the others."""
    share = shared_of_smaller(boxes[:, None], boxes[None, theirs])
    share[theirs, np.arange(len(theirs))] = 0.0
    return np.asarray(share.max(axis=1, initial=0.0))


def likeness(
    targets: Sequence[TrackState], pattern: Pattern, colours: Colours
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the similarity of appearance of K tracks and M detections.

    Args:
        targets: K tracks.
        pattern: (M, 72) thermal patterns.
        colours: (M, 512) of clothes.

    Returns:
        (K, M) similarity from -1 to 1, by colours where they are known and else by the thermal pattern, and
        whether it is that of colours. Similarities of the same clothes are mostly above 0.6 and those of
        different clothes below -0.2; thermal patterns discriminate little.
    """
    warm = np.stack([target.pattern for target in targets]) @ pattern.T
    worn = np.stack([target.colours for target in targets])
    same, is_known = colour_similarities(worn, colours)
    return np.where(is_known, 2.0 * same - 1.0, warm).astype(np.float64), is_known
