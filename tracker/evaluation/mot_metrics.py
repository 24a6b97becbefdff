"""The metrics of multi-object tracking benchmarks: CLEAR MOT, identity and HOTA, in percent.

They use NumPy and SciPy alone, and agree with the reference implementation TrackEval, except that a metric
without a denominator is undefined (NaN), where TrackEval gives 0.
"""

import math
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import Floats, cover
from peopleboy.tracker.evaluation.box_matching import GATE, Pairs, assign
from peopleboy.tracker.evaluation.sequence import Bools, Ints, TrackBoxes, TrueBoxes

# Numerators and denominators that add up over sequences, and the percentages computed from them.


@dataclass(frozen=True, slots=True, eq=False)
class Sums:
    """A record of sums: adding two gives the record of both sequences combined."""

    def __add__(self, other: Self) -> Self:
        names = [field.name for field in fields(self)]
        return type(self)(*(getattr(self, name) + getattr(other, name) for name in names))


def percent(numerator: float, denominator: float) -> float:
    """Return the ratio in percent, at most 100; NaN (undefined) if the denominator is 0."""
    return min(100.0, 100.0 * numerator / denominator) if denominator else math.nan


def sum_by(group: Ints, values: Floats, groups: int) -> Floats:
    """Sum the values (N,) of each group: (groups,), given the group (N,) of each value."""
    # Without values, bincount returns integers.
    return np.bincount(group, values, groups).astype(np.float64)


# CLEAR MOT: misses, false positives and identity switches in one metric.

KEPT = 1000.0  # a kept identity outweighs any overlap


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
        previous = last.copy()  # the same, but -1 for people without a match in the previous frame
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


# HOTA: detection and association in balance, averaged over IoU thresholds.

ALPHAS = np.arange(0.05, 0.99, 0.05)  # (19,) IoU thresholds of a match
ROUNDING = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class Hota(Sums):
    """Counts of HOTA at each of the 19 thresholds alpha = 0.05 .. 0.95.

    One assignment is used for all thresholds: it prefers pairs of person and track that overlap much over the
    whole sequence.

    Source: Luiten et al. 2021, "HOTA: a higher order metric for evaluating multi-object tracking".

    Attributes:
        targets: number of targets.
        candidates: number of candidates.
        matches: (19,) matched pairs (TP).
        association: (19,) sum over the matched pairs of the Jaccard index of their person and track: frames
            in which these two are matched / frames in which either is present.
    """

    targets: int
    candidates: int
    matches: Ints
    association: Floats

    def __post_init__(self) -> None:
        self.matches.setflags(write=False)
        self.association.setflags(write=False)

    @classmethod
    def over(cls, truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> Self:
        """Match one sequence at all thresholds."""
        key, present = _pair_ids(truth, tracks, pairs)  # (P,), (K,)
        common = sum_by(key, _share(pairs, len(truth), len(tracks)), len(present))
        alignment = cover(common, present - common)
        chosen = assign(pairs, alignment[key] * pairs.iou)

        matches, association = [], []
        for alpha in ALPHAS:
            matched = key[chosen[pairs.iou[chosen] >= alpha - ROUNDING]]
            frames = sum_by(matched, np.ones(len(matched)), len(present))  # (K,)
            matches.append(len(matched))
            association.append(float((frames * cover(frames, present - frames)).sum()))
        return cls(len(truth), len(tracks), np.array(matches), np.array(association))

    @property
    def hota(self) -> float:
        """Mean over alpha of the geometric mean of DetA and AssA [%]."""
        return self._average(np.sqrt(self._detection() * self._association()))

    @property
    def deta(self) -> float:
        """Detection accuracy TP / (TP + FN + FP), mean over alpha [%]."""
        return self._average(self._detection())

    @property
    def assa(self) -> float:
        """Association accuracy, mean over the matched pairs and over alpha [%]; 0 without a match."""
        return self._average(self._association())

    def _detection(self) -> Floats:
        matches = self.matches.astype(np.float64)
        return cover(matches, self.targets + self.candidates - matches)

    def _association(self) -> Floats:
        return cover(self.association, self.matches.astype(np.float64))

    def _average(self, by_alpha: Floats) -> float:
        """Average over alpha; undefined if there is neither a target nor a candidate."""
        return 100.0 * float(by_alpha.mean()) if self.targets + self.candidates else math.nan


def _pair_ids(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> tuple[Ints, Floats]:
    """Number the combinations of person and track that share a frame.

    Returns:
        The combination of each pair (P,), and the number of rows of person and track together (K,).
    """
    person, of_person = truth.number_ids()
    track, of_track = tracks.number_ids()
    both = person[pairs.target] * len(of_track) + track[pairs.candidate]
    combination, key = np.unique(both, return_inverse=True)
    who, by = np.divmod(combination, max(len(of_track), 1))
    return key, (of_person[who] + of_track[by]).astype(np.float64)


def _share(pairs: Pairs, targets: int, candidates: int) -> Floats:
    """Return each pair's IoU as a share (P,) of all overlap of its target and its candidate."""
    of_target = sum_by(pairs.target, pairs.iou, targets)[pairs.target]
    of_candidate = sum_by(pairs.candidate, pairs.iou, candidates)[pairs.candidate]
    return cover(pairs.iou, of_target + of_candidate - pairs.iou)


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
