"""The one call: from truth and tracks to every figure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.area_metrics import (
    PaperMetrics,
    ThesisMetrics,
    measure_paper,
    measure_thesis,
)
from peopleboy.tracker.evaluation.box_matching import MIN_VISIBLE, Rule, associate, pair_up, settle_uncounted
from peopleboy.tracker.evaluation.floor import NOWHERE, FloorErrors, Places, measure_floor
from peopleboy.tracker.evaluation.mot_metrics import MotMetrics, Sums, measure_mot
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True)
class Counts(Sums):
    """What was there to count, after uncounted people were settled.

    Attributes:
        frames: frames of the sequence, with or without people.
        targets: boxes to find.
        candidates: boxes that the tracker gave.
        ignored: further boxes that it gave, left out because they lie on uncounted people.
        matches: candidates that are associated with a target (thesis, section 3.4).
        tracks: track ids, ignored or not.
        false_tracks: track ids of which no box ever matches anyone, counted or ignored.
        partly_annotated: frames of sequences whose truth has one person alone, whoever else is there.
    """

    frames: int
    targets: int
    candidates: int
    ignored: int
    matches: int
    tracks: int
    false_tracks: int
    partly_annotated: int

    @property
    def true_tracks(self) -> int:
        """Track ids that are on a person at some time."""
        return self.tracks - self.false_tracks

    @property
    def misses(self) -> int:
        """Targets without a candidate."""
        return self.targets - self.matches

    @property
    def false_alarms(self) -> int:
        """Candidates without a target."""
        return self.candidates - self.matches


@dataclass(frozen=True, slots=True, eq=False)
class Scores(Sums):
    """How well people are found in one sequence, or, added up, in several."""

    counts: Counts
    thesis: ThesisMetrics
    paper: PaperMetrics
    mot: MotMetrics
    floor: FloorErrors = NOWHERE

    def __repr__(self) -> str:
        """Give the scores that are quoted most."""
        clear, identity = self.mot.clear, self.mot.identity
        return (
            f"Scores({self.counts.frames} frames: HOTA {self.mot.hota.hota:.1f} %, MOTA {clear.mota:.1f} %, "
            f"IDF1 {identity.idf1:.1f} %, {clear.switches} identity switches)"
        )


def evaluate(
    truth: TrueBoxes,
    tracks: TrackBoxes,
    *,
    frames: int | None = None,
    uncounted: Rule = "ignore",
    min_visible: float = MIN_VISIBLE,
    is_single: bool = False,
    standing: Places | None = None,
    believed: Places | None = None,
) -> Scores:
    """Score the tracks of one sequence against its truth.

    Every id in `tracks` is taken for a confirmed track. A frame without targets is a frame without people,
    also after the last target: candidates there are false alarms.

    Args:
        truth: the people.
        tracks: what the tracker claims.
        frames: length of the sequence, which the truth does not tell if nobody is there at its end; None
            takes the last frame that has a target or a candidate. It changes `counts.frames` only.
        uncounted: what to do about uncounted people: `ignore` candidates on them, or take them for `absent`.
        min_visible: people of whose body at most this fraction is visible are uncounted as well.
        is_single: whether the truth has one person alone, whoever else is there. Boxes elsewhere are then
            neither right nor wrong, and the figures that need to know are undefined (`table.FIGURES`).
        standing: where the people stand on the floor; None if nobody knows.
        believed: where the tracker says that they stand; None if it does not.

    Raises:
        BadInput: a target or candidate lies beyond `frames`, or an argument is out of range.
    """
    frames = _length(truth, tracks, frames)
    judged = settle_uncounted(truth, tracks, rule=uncounted, min_visible=min_visible)
    pairs = pair_up(judged.truth, judged.tracks)
    matched = associate(pairs)
    found_ids = np.concatenate([judged.tracks.id[pairs.candidate[matched]], judged.ignored.id])
    return Scores(
        counts=Counts(
            frames=frames,
            targets=len(judged.truth),
            candidates=len(judged.tracks),
            ignored=len(judged.ignored),
            matches=len(matched),
            tracks=len(np.unique(tracks.id)),
            false_tracks=len(np.setdiff1d(tracks.id, found_ids)),
            partly_annotated=frames if is_single else 0,
        ),
        thesis=measure_thesis(judged.truth, judged.tracks, pairs, matched),
        paper=measure_paper(judged.truth, judged.tracks, pairs),
        mot=measure_mot(judged.truth, judged.tracks, pairs),
        floor=measure_floor(
            judged.truth.frame[pairs.target[matched]],
            judged.truth.id[pairs.target[matched]],
            judged.tracks.id[pairs.candidate[matched]],
            standing,
            believed,
        ),
    )


def combine(sequences: Sequence[Scores]) -> Scores:
    """Take the sequences together: sums of numerators and denominators, not means of ratios.

    Raises:
        BadInput: there is no sequence.
    """
    if not sequences:
        raise BadInput("scores to combine: at least one sequence is needed, got none")
    first, *others = sequences
    return sum(others, start=first)


def _length(truth: TrueBoxes, tracks: TrackBoxes, frames: int | None) -> int:
    """Return the number of frames, which no row may exceed."""
    if frames is None:
        return max(truth.last_frame, tracks.last_frame)
    if frames < 0:
        raise BadInput(f"frames must be 0 or more, got {frames}")
    for name, seen in (("truth", truth.last_frame), ("tracks", tracks.last_frame)):
        if seen > frames:
            raise BadInput(f"{name}: frame must be at most {frames}, the length of the sequence, got {seen}")
    return frames
