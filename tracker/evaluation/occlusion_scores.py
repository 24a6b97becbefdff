"""What becomes of a person's identity when something hides the person wholly: one record per occlusion.

The tracks say which id lies on a person at each frame: that of the matching candidate (thesis, section 3.4,
each frame on its own). Before an occlusion, and after it, a person's id is the one that lies on it most often
within a window.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.evaluation.box_matching import associate, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Shares hidden of what lies inside the image; the same as in the simulated world's event log, which is not
# known here.
TOTAL_STARTS = 0.98
TOTAL_ENDS = 0.90
SEEN_AGAIN = 0.5  # share hidden below which a person can be expected to be found
WINDOW_S = 1.0  # before an occlusion
PATIENCE_S = 3.0  # after it, within which the person must be found again
LENGTHS_S = (0.0, 0.35, 0.75, 1.5, 3.0, 6.0, math.inf)  # edges of the bins of occlusion length


@dataclass(frozen=True, slots=True, kw_only=True)
class Occlusion:
    """One time that a person was wholly hidden.

    Attributes:
        person: id in the truth.
        start_frame: first frame with more than `TOTAL_STARTS` hidden.
        end_frame: first frame after that with less than `SEEN_AGAIN` hidden.
        duration_s: time between the two with at least `TOTAL_ENDS` hidden. A person in a crowd may peep out
            of one total occlusion and vanish in the next; that is one occlusion.
        id_before: the track on the person before; None if nobody tracked it.
        id_after: the track that is first found on the person again; None if none is.
        found_after_s: from the end of the occlusion to that moment; NaN if it never comes.
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
        """Whether the person has the same id before and after."""
        return self.id_before is not None and self.id_before == self.id_after


@dataclass(frozen=True, slots=True, kw_only=True)
class LengthRow:
    """The occlusions of one range of lengths.

    Attributes:
        from_s, to_s: the range; `to_s` may be infinite.
        occlusions: of persons who were tracked before.
        kept: how many kept their identity.
        found: how many were found again at all.
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
        """Share that kept their identity; NaN without occlusions."""
        return self.kept / self.occlusions if self.occlusions else math.nan


def find_occlusions(frame: Ints, hidden: Floats) -> list[tuple[int, int]]:
    """Find the times at which one person is wholly hidden and comes back.

    Args:
        frame: (N,) rising frames in which the person is in the image.
        hidden: (N,) share hidden of what lies inside the image.

    Returns:
        First frame with more than `TOTAL_STARTS` hidden, and first one after it with less than `SEEN_AGAIN`.
        Who leaves the image meanwhile, or is never seen again, is left out.
    """
    found: list[tuple[int, int]] = []
    start: int | None = None
    for k in range(len(frame)):
        if start is not None and frame[k] != frame[k - 1] + 1:
            start = None
        if start is None and hidden[k] > TOTAL_STARTS:
            start = int(frame[k])
        elif start is not None and hidden[k] < SEEN_AGAIN:
            found.append((start, int(frame[k])))
            start = None
    return found


def score_occlusions(
    truth: TrueBoxes, tracks: TrackBoxes, hidden: Floats, in_image: NDArray[np.bool_], rate_hz: float
) -> list[Occlusion]:
    """Return for every total occlusion in a sequence what became of the identity.

    Args:
        truth: the people of the sequence.
        tracks: what a tracker claims.
        hidden: (N,) for each row of the truth, the share hidden of what lies inside the image.
        in_image: (N,) for each row, whether any of the silhouette lies inside the image, hidden or not.
        rate_hz: frames a second.
    """
    on_person = _ids_on_people(truth, tracks)
    scores = []
    for person in np.unique(truth.id):
        rows = np.flatnonzero((truth.id == person) & in_image & truth.counted)
        ids = {int(truth.frame[row]): on_person[row] for row in np.flatnonzero(truth.id == person)}
        spans = find_occlusions(truth.frame[rows], hidden[rows])
        ends = [*(start for start, _ in spans), truth.last_frame + 1][1:]
        wholly_hidden = truth.frame[rows][hidden[rows] >= TOTAL_ENDS]
        for (start, end), limit in zip(spans, ends, strict=True):
            frames = int(((wholly_hidden >= start) & (wholly_hidden < end)).sum())
            scores.append(_score(int(person), (start, end, limit), frames / rate_hz, ids, rate_hz))
    return scores


def by_length(occlusions: Sequence[Occlusion], edges_s: Sequence[float] = LENGTHS_S) -> list[LengthRow]:
    """Sum up by occlusion length; who was not tracked before had no identity to keep and is left out."""
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
    """The track id on each row of the truth."""
    pairs = pair_up(truth, tracks)
    ids: list[int | None] = [None] * len(truth)
    for pair in associate(pairs):
        ids[int(pairs.target[pair])] = int(tracks.id[pairs.candidate[pair]])
    return ids


def _score(
    person: int,
    span: tuple[int, int, int],
    duration_s: float,
    ids: dict[int, int | None],
    rate_hz: float,
) -> Occlusion:
    """Score one occlusion by its first frame, the first after it, and the first of the next one."""
    start, end, limit = span
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
    """The commonest id; of several the latest."""
    known = [track for track in ids if track is not None]
    return max(reversed(known), key=known.count, default=None)


def _first_steady(ids: Sequence[tuple[int, int | None]]) -> tuple[int, int] | None:
    """The commonest id, and the first frame at which it lies on the person: a fleeting one does not count."""
    track = _most_common([track for _, track in ids])
    if track is None:
        return None
    return next(frame for frame, other in ids if other == track), track
