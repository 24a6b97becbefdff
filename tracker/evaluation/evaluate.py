"""Evaluation of tracks against ground truth: all scores in one call."""

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
from peopleboy.tracker.evaluation.latency import UNTIMED, Latency
from peopleboy.tracker.evaluation.mot_metrics import MotMetrics, measure_mot
from peopleboy.tracker.evaluation.ospa import SetDistances, measure_sets
from peopleboy.tracker.evaluation.protocols import EMPTY, Surroundings
from peopleboy.tracker.evaluation.sequence import Sums, TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True)
class Counts(Sums):
    """Counts after ignored people were removed.

    Attributes:
        frames: frames of the sequence, with or without people.
        targets: boxes of people to be found.
        candidates: boxes of the tracker.
        ignored: further boxes of the tracker, removed because they lie on ignored people or in ignored
        regions. matches: candidates that match a target (thesis, section 3.4).
        tracks: track ids, ignored or not.
        false_tracks: track ids whose boxes never match a person, counted or ignored.
        partly_annotated: frames of sequences in which only one person is annotated.
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
        """Track ids that match a person at some time."""
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
    """Scores of one sequence, or of several combined.

    Floor errors and latency are empty if they are unknown.
    """

    counts: Counts
    thesis: ThesisMetrics
    paper: PaperMetrics
    mot: MotMetrics
    sets: SetDistances
    floor: FloorErrors = NOWHERE
    latency: Latency = UNTIMED

    def __repr__(self) -> str:
        """Show the main scores."""
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
    min_visible: float | None = MIN_VISIBLE,
    around: Surroundings = EMPTY,
    is_single: bool = False,
    standing: Places | None = None,
    believed: Places | None = None,
) -> Scores:
    """Score the tracks of one sequence against its ground truth.

    All tracks count as confirmed. A frame without targets is a frame without people, also after the last
    target: candidates in it are false positives.

    Args:
        truth: ground truth.
        tracks: output of the tracker.
        frames: length of the sequence, as people may be missing at its end; None for the last frame with a
            target or a candidate. Only `counts.frames` depends on it.
        uncounted: whether candidates on uncounted people are ignored (`ignore`) or false positives
            (`absent`).
        min_visible: people with at most this visible fraction are uncounted as well; None to score all.
        around: what is annotated besides people.
        is_single: whether only one person is annotated. Boxes elsewhere are then neither right nor wrong, and
            metrics that depend on them are undefined (`table.FIGURES`).
        standing: true positions on the floor; None if unknown.
        believed: the tracker's positions on the floor; None if it has none.

    Raises:
        BadInput: a target or candidate is beyond `frames`, or an argument is out of range.
    """
    frames = _length(truth, tracks, frames)
    judged = settle_uncounted(truth, tracks, rule=uncounted, min_visible=min_visible, around=around)
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
        sets=measure_sets(judged.truth, judged.tracks, pairs),
        floor=measure_floor(
            judged.truth.frame[pairs.target[matched]],
            judged.truth.id[pairs.target[matched]],
            judged.tracks.id[pairs.candidate[matched]],
            standing,
            believed,
        ),
    )


def combine(sequences: Sequence[Scores]) -> Scores:
    """Combine sequences: sums of numerators and denominators, not means of ratios.

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
