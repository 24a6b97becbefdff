"""OSPA and OSPA(2): distances between the set of people and the set of tracks, 0 (equal) to 1.

The distance between two boxes is 1 - IoU, the cut-off 1 and the order 1, so a person or a track without a
partner costs 1.

Sources: Schuhmacher, Vo and Vo 2008 (OSPA); Beard, Vo and Vo 2020 (OSPA(2)); Rezatofighi et al. 2020, "How
trustworthy are performance evaluations for basic vision tasks?" (both with the IoU of boxes).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.boxes import cover
from peopleboy.tracker.evaluation.box_matching import Pairs, assign
from peopleboy.tracker.evaluation.sequence import Sums, TrackBoxes, TrueBoxes, sum_by


@dataclass(frozen=True, slots=True)
class SetDistances(Sums):
    """Sums of distances between sets.

    Attributes:
        frames: frames with a target or a candidate.
        apart: sum over these frames of the OSPA distance between targets and candidates.
        ids: number of persons or of track ids, whichever is larger.
        ids_apart: OSPA(2) distance between persons and tracks over the whole sequence, times `ids`.
    """

    frames: int
    apart: float
    ids: int
    ids_apart: float

    @property
    def ospa(self) -> float:
        """Mean OSPA distance over the frames with a target or a candidate; NaN without such frames."""
        return self.apart / self.frames if self.frames else math.nan

    @property
    def ospa2(self) -> float:
        """OSPA(2) distance, weighted over sequences by `ids`; NaN without persons and tracks."""
        return self.ids_apart / self.ids if self.ids else math.nan


def measure_sets(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> SetDistances:
    """Sum up one sequence."""
    apart, frames = _over_frames(truth, tracks, pairs)
    ids_apart, ids = _over_ids(truth, tracks, pairs)
    return SetDistances(frames, apart, ids, ids_apart)


def _over_frames(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> tuple[float, int]:
    """Return the sum of the OSPA distances of all frames, and the number of frames."""
    numbers, frame = np.unique(np.concatenate([truth.frame, tracks.frame]), return_inverse=True)
    targets = np.bincount(frame[: len(truth)], minlength=len(numbers))
    candidates = np.bincount(frame[len(truth) :], minlength=len(numbers))
    chosen = assign(pairs, pairs.iou)
    overlap = sum_by(frame[pairs.target[chosen]], pairs.iou[chosen], len(numbers))
    most = np.maximum(targets, candidates)
    return float((1.0 - overlap / most).sum()), len(numbers)


def _over_ids(truth: TrueBoxes, tracks: TrackBoxes, pairs: Pairs) -> tuple[float, int]:
    """Return the OSPA(2) distance of one sequence times the larger number of ids, and this number.

    The distance of a person and a track is the mean over the frames in which either is present: 1 - IoU if
    both are, otherwise 1.
    """
    person, of_person = truth.number_ids()
    track, of_track = tracks.number_ids()
    shape = len(of_person), len(of_track)
    key = person[pairs.target] * shape[1] + track[pairs.candidate]
    overlap = sum_by(key, pairs.iou, shape[0] * shape[1]).reshape(shape)
    common = np.bincount(key, minlength=shape[0] * shape[1]).reshape(shape)
    likeness = cover(overlap, (of_person[:, None] + of_track - common).astype(np.float64))
    partners = linear_sum_assignment(likeness, maximize=True)
    return max(shape) - float(likeness[partners].sum()), max(shape)
