"""What to do about people whom nobody asked the tracker to find.

A truth row is uncounted if the person is nearer than 3 m or farther than 10 m (`counted` is False), or so
hidden that the visible fraction is at most `min_visible` (by default: totally hidden). Uncounted people are
never misses. A tracker may find them all the same, and there are two rules for that:

- `ignore` (default, as the distractors of MOTChallenge): a candidate on an uncounted person is neither right
  nor wrong and leaves the evaluation.
- `absent` (the sources to the letter): such people are simply not in the truth, so a candidate on one is a
  false alarm.

Either rule is applied once, before any metric, so that all metrics see the same data.
"""

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.association import GATE, associate, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Rule = Literal["ignore", "absent"]
MIN_VISIBLE = 0.0  # a target counts if more than this fraction of the person is visible


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """The rows that count.

    Attributes:
        truth: the counted targets.
        tracks: the candidates to judge.
        ignored: the candidates that were taken out, because they lie on uncounted people.
    """

    truth: TrueBoxes
    tracks: TrackBoxes
    ignored: TrackBoxes


def counts(counted: Flags, visible: Floats, min_visible: float = MIN_VISIBLE) -> Flags:
    """Tell who is a target: near enough to be counted, and more than a share of the person visible.

    Args:
        counted: (N,) whether the truth counts the person.
        visible: (N,) visible fraction, 0..1.
        min_visible: that share.
    """
    return np.asarray(counted & (visible > min_visible))


def settle_uncounted(
    truth: TrueBoxes, tracks: TrackBoxes, *, rule: Rule = "ignore", min_visible: float = MIN_VISIBLE
) -> Judged:
    """Take out the uncounted people by the named rule.

    Raises:
        BadInput: there is no such rule, or `min_visible` is not in 0..1.
    """
    if rule not in get_args(Rule):
        raise BadInput(f"uncounted must be one of {', '.join(get_args(Rule))}, got {rule!r}")
    if not 0.0 <= min_visible <= 1.0:
        raise BadInput(f"min_visible must be 0 to 1, got {min_visible}")
    counted = counts(truth.counted, truth.visible, min_visible)
    truth = replace(truth, counted=counted)
    if rule == "ignore":
        return ignore_uncounted(truth, tracks)
    return Judged(truth.take(counted), tracks, tracks.take(np.zeros(len(tracks), dtype=np.bool_)))


def ignore_uncounted(truth: TrueBoxes, tracks: TrackBoxes, gate: float = GATE) -> Judged:
    """Take out the uncounted people, and the candidates on them.

    All people choose together, so that the sum of overlaps is largest: where somebody uncounted and a target
    stand at one place, a candidate is on the one whom it overlaps more. Each uncounted person takes out at
    most one; two candidates on one uncounted person leave one false alarm.

    Source: TrackEval 1.0, `MotChallenge2DBox.get_preprocessed_seq_data`, of distractors.
    """
    pairs = pair_up(truth, tracks)
    chosen = associate(pairs, gate)
    is_ignored = np.zeros(len(tracks), dtype=np.bool_)
    is_ignored[pairs.candidate[chosen][~truth.counted[pairs.target[chosen]]]] = True
    return Judged(truth.take(truth.counted), tracks.take(~is_ignored), tracks.take(is_ignored))
