"""Matching of candidates and targets, independently in each frame."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats, area, cover, intersection, iou
from peopleboy.tracker.evaluation.protocols import EMPTY, MORE_THAN_HALF, Surroundings
from peopleboy.tracker.evaluation.sequence import Ints, TrackBoxes, TrueBoxes

GATE = MORE_THAN_HALF  # a pair must overlap by more than this (thesis, section 3.4)
ROUNDING = float(np.finfo(np.float64).eps)  # tolerance of thresholds that a pair may just reach


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Every target with every candidate of its frame.

    Ordered by frame, target, candidate, so that the pairs of one frame are a matrix in row-major order.

    Attributes:
        target: (P,) row of the truth.
        candidate: (P,) row of the tracks.
        shared: (P,) intersection [px^2].
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
    """Choose pairs (M,), at most one per target and per candidate, with IoU above the gate.

    In each frame the sum of the chosen IoUs is maximal. Identities over time are ignored.

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
    """Return for each of the frames its first row in the sorted column, and its number of rows."""
    first = np.searchsorted(frame, frames, side="left")
    return first, np.searchsorted(frame, frames, side="right") - first


# Handling of people that the tracker is not required to find.
#
# A truth row is ignored if the person is not counted, such as one who is nearer than 3 m or farther than 10 m
# (`counted` is False), or if the visible fraction is at most `min_visible`. Ignored people never count as
# misses. There are two rules for candidates on them:
#
# - `ignore` (default, as the distractors of MOTChallenge): a candidate on an ignored person is neither right
# nor wrong and is removed. - `absent` (the sources, literally): such people are removed from the truth, so a
# candidate on one is a false positive.
#
# Either rule is applied once, before any metric, so that all metrics see the same data.

Flags = NDArray[np.bool_]
Rule = Literal["ignore", "absent"]
MIN_VISIBLE = 0.0  # a target counts if more than this fraction of the person is visible


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """The evaluated rows.

    Attributes:
        truth: the evaluated targets.
        tracks: the evaluated candidates.
        ignored: the removed candidates, on ignored people or in ignored regions.
    """

    truth: TrueBoxes
    tracks: TrackBoxes
    ignored: TrackBoxes


def counts(counted: Flags, visible: Floats, min_visible: float | None = MIN_VISIBLE) -> Flags:
    """Return which people are targets: counted, and with more than a least visible fraction.

    Args:
        counted: (N,) whether the truth counts the person.
        visible: (N,) visible fraction, 0..1.
        min_visible: that fraction; None to count people whatever their visible fraction.
    """
    return counted if min_visible is None else np.asarray(counted & (visible > min_visible))


def settle_uncounted(
    truth: TrueBoxes,
    tracks: TrackBoxes,
    *,
    rule: Rule = "ignore",
    min_visible: float | None = MIN_VISIBLE,
    around: Surroundings = EMPTY,
) -> Judged:
    """Remove the ignored people by the named rule.

    Raises:
        BadInput: the rule is unknown, or `min_visible` is not in 0..1.
    """
    if rule not in get_args(Rule):
        raise BadInput(f"unknown uncounted {rule!r}; choose from {', '.join(get_args(Rule))}")
    if min_visible is not None and not 0.0 <= min_visible <= 1.0:
        raise BadInput(f"min_visible must be 0 to 1, got {min_visible}")
    counted = counts(truth.counted, truth.visible, min_visible)
    truth = replace(truth, counted=counted)
    if rule == "ignore":
        return ignore_uncounted(truth, tracks, around)
    return Judged(truth.take(counted), tracks, tracks.take(np.zeros(len(tracks), dtype=np.bool_)))


def ignore_uncounted(truth: TrueBoxes, tracks: TrackBoxes, around: Surroundings = EMPTY) -> Judged:
    """Remove the ignored people, and the candidates on them.

    All people and objects are matched together at the largest sum of overlaps: where an ignored person and a
    target share a position, a candidate belongs to the one that it overlaps more. Each ignored person
    removes at most one candidate; of two candidates on one ignored person, one is a false positive.
    Candidates that match nothing are removed if they are low, or mostly in an ignored region.

    Source: TrackEval 1.0, `get_preprocessed_seq_data` of `MotChallenge2DBox` and `Kitti2DBox`.
    """
    everything = _with_objects(truth, around.objects)
    pairs = pair_up(everything, tracks)
    chosen = associate(pairs, around.gate)
    is_ignored = _is_beside(tracks, around)
    is_ignored[pairs.candidate[chosen]] = ~everything.counted[pairs.target[chosen]]
    return Judged(truth.take(truth.counted), tracks.take(~is_ignored), tracks.take(is_ignored))


def _with_objects(truth: TrueBoxes, objects: TrueBoxes) -> TrueBoxes:
    """Join people and objects, whose candidates stay, under ids of their own."""
    if not len(objects):
        return truth
    further = objects.id + truth.id.max(initial=0) + 1
    return replace(
        truth,
        frame=np.concatenate([truth.frame, objects.frame]),
        id=np.concatenate([truth.id, further]),
        box=np.concatenate([truth.box, objects.box]),
        counted=np.concatenate([truth.counted, np.ones(len(objects), dtype=np.bool_)]),
        visible=np.concatenate([truth.visible, objects.visible]),
    )


def _is_beside(tracks: TrackBoxes, around: Surroundings) -> Flags:
    """Return which candidates (N,) are too low, or lie to more than half in one ignored region."""
    is_low = tracks.box[:, 3] <= around.least_height_px + ROUNDING
    is_beside = np.asarray(is_low & (around.least_height_px > 0.0))
    pairs = pair_up(around.regions, tracks)
    inside = cover(pairs.shared, area(tracks.box[pairs.candidate]))
    is_beside[pairs.candidate[inside > GATE + ROUNDING]] = True
    return is_beside
