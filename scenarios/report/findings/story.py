"""What became of each person in a run, frame by frame: what could be seen, and which track lay there."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.report.findings.spans import Flags, Floats, Ints, between, settle
from peopleboy.sim.truth.events import (
    LEAVES_INSIDE,
    OCCLUSION_ENDS,
    OCCLUSION_STARTS,
    TOTAL_ENDS,
    TOTAL_STARTS,
)
from peopleboy.sim.truth.truth import BORDER
from peopleboy.tracker.evaluation.association import associate, pair_up

STEADY_S = 0.3  # a number that lies on a person for less is fleeting


class Sight(IntEnum):
    """What there is to be seen of a person."""

    AWAY = 0
    SEEN = 1
    PARTLY = 2
    WHOLLY = 3


class Hold(IntEnum):
    """What the tracker has of a person."""

    NOTHING_DUE = 0  # not there, wholly hidden, too near or too far
    ON = 1
    ADRIFT = 2  # the person's number lives on, but its box lies elsewhere
    MISSED = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Story:
    """One person in one run; all columns have F rows, one a frame.

    Attributes:
        id, name: of the person.
        position_m: (F, 2) world frame; NaN where the person is not present.
        distance_m: from the camera; NaN as above.
        visible: share of the whole silhouette; 0 as above.
        occluded: share hidden of what lies inside the image; NaN outside it.
        hider: who or what hides most of the person; empty for nobody.
        is_counted: 3 to 10 m away.
        sight: `Sight`, with the thresholds of the event log.
        matched: number of the track whose box lies on the person (IoU above 0.5), or 0.
        track: the same without fleeting ones and short breaks.
        iou, offset_px: of that box: overlap, and distance of the middles; NaN without one.
        hold: `Hold`.
    """

    id: int
    name: str
    position_m: Floats
    distance_m: Floats
    visible: Floats
    occluded: Floats
    hider: tuple[str, ...]
    is_counted: Flags
    sight: Ints
    matched: Ints
    track: Ints
    iou: Floats
    offset_px: Floats
    hold: Ints

    @property
    def is_due(self) -> Flags:
        """Where the person counts and can be seen: (F,)."""
        return np.asarray(self.is_counted & np.isin(self.sight, (Sight.SEEN, Sight.PARTLY)))

    def hider_in(self, start: int, end: int) -> str:
        """Name who hides the person most often in some frames; empty for nobody."""
        names = Counter(name for name in self.hider[max(start, 0) : end] if name)
        return names.most_common(1)[0][0] if names else ""


def tell_stories(run: FinishedRun) -> list[Story]:
    """Tell the story of everybody in a run, in the scenario's order."""
    lie = _lie(run)
    alive = present_tracks(run)
    who, first = np.unique(run.people["id"].to_numpy(), return_index=True)
    names = [run.people["name"][int(row)].as_py() for row in first]
    return [_tell(run, int(person), name, lie, alive) for person, name in zip(who, names, strict=True)]


def present_tracks(run: FinishedRun) -> dict[int, Flags]:
    """Give for each confirmed track the frames (F,) in which it is shown."""
    shown = {}
    for number in np.unique(run.tracks.id).tolist():
        frames = np.zeros(run.frames, np.int64)
        frames[run.tracks.frame[run.tracks.id == number] - 1] = 1
        shown[number] = frames > 0
    return shown


def steady_frames(run: FinishedRun) -> int:
    """How many frames `STEADY_S` has."""
    return max(round(STEADY_S * run.rate_hz), 1)


def _lie(run: FinishedRun) -> dict[tuple[int, int], tuple[int, float, float]]:
    """Which track lies on whom: (frame, person) to number, IoU and offset [px]."""
    pairs = pair_up(run.truth, run.tracks)
    found = {}
    for pair in associate(pairs).tolist():
        target, candidate = pairs.target[pair], pairs.candidate[pair]
        true, given = run.truth.box[target], run.tracks.box[candidate]
        offset = np.hypot(*(true[:2] + true[2:] / 2.0 - given[:2] - given[2:] / 2.0))
        key = int(run.truth.frame[target]), int(run.truth.id[target])
        found[key] = int(run.tracks.id[candidate]), float(pairs.iou[pair]), float(offset)
    return found


def _tell(
    run: FinishedRun,
    person: int,
    name: str,
    lie: dict[tuple[int, int], tuple[int, float, float]],
    alive: dict[int, Flags],
) -> Story:
    rows = run.people.filter(np.asarray(run.people["id"].to_numpy() == person))
    at = rows["frame"].to_numpy() - 1
    shares = [dict(hidden) for hidden in rows["hidden_by"].to_pylist()]
    is_ahead = rows["whole_px"].to_numpy() > 0
    inside = _column(run, at, is_ahead * [1.0 - share.get(BORDER, 0.0) for share in shares])
    occluded = _column(run, at, rows["occluded_fraction"].to_numpy())
    counted = _column(run, at, rows["is_counted"].to_numpy(zero_copy_only=False)) > 0.0
    hider = [""] * run.frames
    for frame, word in zip(at.tolist(), rows["occluder"].to_pylist(), strict=True):
        hider[frame] = word or ""
    sight = _sight(occluded, ~(inside < LEAVES_INSIDE) & np.isfinite(inside))
    found = [lie.get((frame, person), (0, np.nan, np.nan)) for frame in range(1, run.frames + 1)]
    matched = np.array([number for number, _, _ in found], np.int64)
    track = settle(matched, steady_frames(run))
    is_due = counted & np.isin(sight, (Sight.SEEN, Sight.PARTLY))
    return Story(
        id=person,
        name=name,
        position_m=np.stack([_column(run, at, rows[key].to_numpy()) for key in ("x_m", "y_m")], axis=1),
        distance_m=_column(run, at, rows["distance_m"].to_numpy()),
        visible=np.nan_to_num(_column(run, at, rows["visible_fraction"].to_numpy())),
        occluded=occluded,
        hider=tuple(hider),
        is_counted=counted,
        sight=sight,
        matched=matched,
        track=track,
        iou=np.array([iou for _, iou, _ in found]),
        offset_px=np.array([offset for _, _, offset in found]),
        hold=_hold(track, is_due, alive),
    )


def _column(run: FinishedRun, at: Ints, values: object) -> Floats:
    """Spread values over all frames (F,); NaN elsewhere."""
    column = np.full(run.frames, np.nan)
    column[at] = values
    return column


def _sight(occluded: Floats, is_inside: Flags) -> Ints:
    hidden = np.where(is_inside, occluded, np.nan)
    sight = np.where(is_inside, Sight.SEEN, Sight.AWAY)
    sight[between(hidden, OCCLUSION_STARTS, OCCLUSION_ENDS)] = Sight.PARTLY
    sight[between(hidden, TOTAL_STARTS, TOTAL_ENDS)] = Sight.WHOLLY
    return np.asarray(sight, np.int64)


def _hold(track: Ints, is_due: Flags, alive: dict[int, Flags]) -> Ints:
    """What the tracker has: a person's number is the last that lay on the person."""
    hold = np.zeros(len(track), np.int64)
    last = 0
    for k, number in enumerate(track.tolist()):
        last = number or last
        if number:
            hold[k] = Hold.ON
        elif is_due[k]:
            hold[k] = Hold.ADRIFT if last and alive[last][k] else Hold.MISSED
    return hold
