"""Identity after full occlusions: one record per occlusion.

The id of a person in a frame is that of the matching candidate (thesis, section 3.4, each frame
independently). The ids before and after an occlusion are the most frequent ones within a window.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.evaluation.box_matching import associate, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Occluded shares of the part inside the image; equal to those of the simulator's event log, which is not
# imported here.
TOTAL_STARTS = 0.98
TOTAL_ENDS = 0.90
SEEN_AGAIN = 0.5  # occluded share below which a person can be found again
WINDOW_S = 1.0  # before an occlusion
PATIENCE_S = 3.0  # after it, within which the person must be found again
LENGTHS_S = (0.0, 0.35, 0.75, 1.5, 3.0, 6.0, math.inf)  # edges of the bins of occlusion length


@dataclass(frozen=True, slots=True, kw_only=True)
class Occlusion:
    """One full occlusion of a person.

    Attributes:
        person: id in the ground truth.
        start_frame: first frame with more than `TOTAL_STARTS` occluded.
        end_frame: first later frame with less than `SEEN_AGAIN` occluded.
        duration_s: time between the two with at least `TOTAL_ENDS` occluded. Brief partial visibility within
            a crowd does not end an occlusion.
        id_before: track id before the occlusion; None if the person was not tracked.
        id_after: first track id after the occlusion; None if the person is not found.
        found_after_s: time from the end of the occlusion until then; NaN if the person is not found.
    """

    person: int
    start_frame: int
    end_frame: int
    duration_s: float
    id_before: int | None
    id_after: int | None
    found_after_s: float

    @property
    def is_kept(self) -> bool:
        """Whether the id is the same before and after."""
        return self.id_before is not None and self.id_before == self.id_after


@dataclass(frozen=True, slots=True, kw_only=True)
class LengthRow:
    """The occlusions of one range of lengths.

    Attributes:
        from_s, to_s: the range; `to_s` may be infinite.
        occlusions: number of occlusions of tracked people.
        kept: number with the same id afterwards.
        found: number in which the person was found again.
        found_after_s: median time until then [s]; NaN if none was found.
    """

    from_s: float
    to_s: float
    occlusions: int
    kept: int
    found: int
    found_after_s: float

    @property
    def kept_share(self) -> float:
        """Share of kept identities; NaN without occlusions."""
        return self.kept / self.occlusions if self.occlusions else math.nan


@dataclass(frozen=True, slots=True, eq=False)
class OccludedShares:
    """How much of each person of a ground truth is occluded.

    Attributes:
        share: (N,) for each row of the truth, the occluded share of the part inside the image; NaN if none of
            the silhouette lies inside the image, occluded or not.
        rate_hz: frames per second.
        every: frames from one image to the next.
    """

    share: Floats
    rate_hz: float
    every: int = 1


class _Span(NamedTuple):
    """A full occlusion: first frame, first frame after it, start of the next one, and its duration."""

    start: int
    end: int
    limit: int
    duration_s: float


def find_occlusions(frame: Ints, hidden: Floats, every: int = 1) -> list[tuple[int, int]]:
    """Return the full occlusions of one person that end within the sequence.

    Args:
        frame: (N,) increasing frames in which the person is in the image.
        hidden: (N,) occluded share of the part inside the image.
        every: frames from one image to the next.

    Returns:
        First frame with more than `TOTAL_STARTS` occluded, and first later one with less than `SEEN_AGAIN`.
        Occlusions during which the person leaves the image, or which do not end, are left out.
    """
    found: list[tuple[int, int]] = []
    start: int | None = None
    for k in range(len(frame)):
        if start is not None and frame[k] != frame[k - 1] + every:
            start = None
        if start is None and hidden[k] > TOTAL_STARTS:
            start = int(frame[k])
        elif start is not None and hidden[k] < SEEN_AGAIN:
            found.append((start, int(frame[k])))
            start = None
    return found


def score_occlusions(truth: TrueBoxes, tracks: TrackBoxes, occluded: OccludedShares) -> list[Occlusion]:
    """Return the identity outcome of every full occlusion in a sequence."""
    on_person = _ids_on_people(truth, tracks)
    scores = []
    for person in np.unique(truth.id).tolist():
        ids = {int(truth.frame[row]): on_person[row] for row in np.flatnonzero(truth.id == person)}
        spans = _spans_of(person, truth, occluded)
        scores += [_score(person, span, ids, occluded.rate_hz) for span in spans]
    return scores


def longest_occlusions_s(truth: TrueBoxes, occluded: OccludedShares) -> dict[int, float]:
    """Return the duration of the longest full occlusion [s] of each person who has one."""
    spans = {person: _spans_of(person, truth, occluded) for person in np.unique(truth.id).tolist()}
    return {person: max(span.duration_s for span in found) for person, found in spans.items() if found}


def _spans_of(person: int, truth: TrueBoxes, occluded: OccludedShares) -> list[_Span]:
    """Return the full occlusions of a person."""
    rows = np.flatnonzero((truth.id == person) & np.isfinite(occluded.share) & truth.counted)
    frame, hidden = truth.frame[rows], occluded.share[rows]
    spans = find_occlusions(frame, hidden, occluded.every)
    limits = [*(start for start, _ in spans), truth.last_frame + 1][1:]
    wholly_hidden = frame[hidden >= TOTAL_ENDS]
    image_s = occluded.every / occluded.rate_hz
    return [
        _Span(start, end, limit, int(((wholly_hidden >= start) & (wholly_hidden < end)).sum()) * image_s)
        for (start, end), limit in zip(spans, limits, strict=True)
    ]


def by_length(occlusions: Sequence[Occlusion], edges_s: Sequence[float] = LENGTHS_S) -> list[LengthRow]:
    """Aggregate by occlusion length, without people who were not tracked before."""
    tracked = [o for o in occlusions if o.id_before is not None]
    table = []
    for low, high in pairwise(edges_s):
        inside = [o for o in tracked if low <= o.duration_s < high]
        times = [o.found_after_s for o in inside if o.id_after is not None]
        table.append(
            LengthRow(
                from_s=low,
                to_s=high,
                occlusions=len(inside),
                kept=sum(o.is_kept for o in inside),
                found=len(times),
                found_after_s=float(np.median(times)) if times else math.nan,
            )
        )
    return table


def _ids_on_people(truth: TrueBoxes, tracks: TrackBoxes) -> list[int | None]:
    """Return the track id on each row of the truth."""
    pairs = pair_up(truth, tracks)
    ids: list[int | None] = [None] * len(truth)
    for pair in associate(pairs):
        ids[int(pairs.target[pair])] = int(tracks.id[pairs.candidate[pair]])
    return ids


def name_length(from_s: float, to_s: float) -> str:
    """Return the name of a range of lengths, such as `0.35 to 0.75 s`."""
    return f"over {from_s:g} s" if math.isinf(to_s) else f"{from_s:g} to {to_s:g} s"


def _score(person: int, span: _Span, ids: dict[int, int | None], rate_hz: float) -> Occlusion:
    """Score one occlusion."""
    start, end, limit, duration_s = span
    window, patience = round(WINDOW_S * rate_hz), round(PATIENCE_S * rate_hz)
    before = [ids.get(frame) for frame in range(start - window, start)]
    after = [(frame, ids.get(frame)) for frame in range(end, min(end + patience, limit))]
    steady = _first_steady(after)
    return Occlusion(
        person=person,
        start_frame=start,
        end_frame=end,
        duration_s=duration_s,
        id_before=_most_common(before),
        id_after=None if steady is None else steady[1],
        found_after_s=math.nan if steady is None else (steady[0] - end) / rate_hz,
    )


def _most_common(ids: Sequence[int | None]) -> int | None:
    """Return the most frequent id; of several the latest."""
    known = [track for track in ids if track is not None]
    return max(reversed(known), key=known.count, default=None)


def _first_steady(ids: Sequence[tuple[int, int | None]]) -> tuple[int, int] | None:
    """Return the most frequent id, ignoring brief ones, and the first frame in which the person has it."""
    track = _most_common([track for _, track in ids])
    if track is None:
        return None
    return next(frame for frame, other in ids if other == track), track
