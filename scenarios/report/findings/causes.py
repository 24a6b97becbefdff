"""Find causes: what could be seen of a person at a moment, and how it ended with the person."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum, auto

import numpy as np

from peopleboy.scenarios.report.findings.histories import Ints, PersonHistory, RunHistory, Visibility, settle
from peopleboy.scenarios.report.findings.sentences import Cause, seconds, spoken

BEFORE_S = 0.5  # what happened this long before a loss may be its cause
_CUT_OFF = 0.85  # share of a person nobody hides that is inside the image, below which that is worth telling


def find_cause(history: RunHistory, person: PersonHistory, start: int, end: int) -> Cause:
    """Find what there was to be seen of a person between two indices: what lasted longest, the worst first.

    Where nothing was amiss then, it is what was amiss just before, if anything was.
    """
    cause = _amiss(history, person, start, end)
    if cause is not None:
        return cause
    before = _amiss(history, person, max(start - round(BEFORE_S * history.run.rate_hz), 0), start)
    if before is not None:
        return replace(before, is_before=True)
    for other in history.people:
        if other.hider_in(start, end + 1) == person.name:
            return Cause("in front", {"other": spoken(other.name)})
    return Cause("plain")


def _amiss(history: RunHistory, person: PersonHistory, start: int, end: int) -> Cause | None:
    """Find why a person could not be seen well between two indices; None if there is no reason."""
    first, last = max(start, 0), end + 1
    view = person.view[first:last]
    wholly, away = int((view == Visibility.WHOLLY).sum()), int((view == Visibility.AWAY).sum())
    if away > wholly:
        is_leaving = view[-1] == Visibility.AWAY
        return (
            Cause("left") if is_leaving else Cause("away", {"duration": seconds(away / history.run.rate_hz)})
        )
    hider = person.hider_in(first, last)
    by = {"by": f" by {spoken(hider)}" if hider else ""}
    if wholly:
        return Cause("wholly", by)
    if (view == Visibility.PARTLY).any():
        return Cause("partly", by | {"share": f"{np.nanmax(person.occluded[first:last]):.0%}"})
    if not person.is_counted[first:last].all():
        nearest_m, farthest_m = history.counted_m
        is_far = np.nanmax(person.distance_m[first:last]) > farthest_m
        return Cause("far" if is_far else "near", {"limit": f"{farthest_m if is_far else nearest_m:g}"})
    return Cause("cut off") if person.visible[first:last].min() < _CUT_OFF else None


class Outcome(Enum):
    """How it ended with a person."""

    NEVER_DUE = auto()
    TRACKED = auto()
    HIDDEN = auto()  # tracked until wholly hidden, which lasted to the end
    LOST = auto()


def outcome_of(history: RunHistory, person: PersonHistory) -> Outcome:
    """Return whether a track lay on a person in the last second of being due, and what came then."""
    due = steady_due(history, person)
    if len(due) == 0:
        return Outcome.NEVER_DUE
    last = due[due > due[-1] - round(history.run.rate_hz)]
    if not (person.track[last] > 0).any():
        return Outcome.LOST
    return Outcome.HIDDEN if _is_hidden_to_end(history, person) else Outcome.TRACKED


def steady_due(history: RunHistory, person: PersonHistory) -> Ints:
    """Give the indices at which a person is due for more than a glimpse; of glimpses if there is no more."""
    steady = np.flatnonzero(settle(person.is_due.astype(np.int64), history.steady))
    return steady if len(steady) else np.flatnonzero(person.is_due)


def _is_hidden_to_end(history: RunHistory, person: PersonHistory) -> bool:
    """Return whether a person without a track stayed wholly hidden to the end, but for moments."""
    after = person.view[np.flatnonzero(person.track)[-1] + 1 :]
    hidden = np.flatnonzero(after == Visibility.WHOLLY)
    if len(hidden) == 0:
        return False
    in_view = np.isin(after[hidden[0] :], (Visibility.SEEN, Visibility.PARTLY)).astype(np.int64)
    return Visibility.AWAY not in after and not settle(in_view, history.steady).any()
