"""Find identity changes and identity transfers, and the visibility of the people at that time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from peopleboy.scenarios.report.findings.histories import (
    Ints,
    PersonHistory,
    RunHistory,
    Span,
    Visibility,
    settle,
    spans,
)
from peopleboy.scenarios.report.findings.sentences import Cause, seconds, spoken

BEFORE_S = 0.5  # an event this long before a loss may be its cause
_CUT_OFF = 0.85  # visible share of an unoccluded person below which the image border is reported as a cause


def find_cause(history: RunHistory, person: PersonHistory, start: int, end: int) -> Cause:
    """Find the cause of a loss between two indices: the visibility that lasted longest, the worst first.

    If the person was in plain sight, it is a cause from just before, if there was one.
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
    """Find why a person was not fully visible between two indices; None without a reason."""
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
    """State of a person's track at the end of a run."""

    NEVER_DUE = auto()
    TRACKED = auto()
    HIDDEN = auto()  # tracked until wholly hidden, which lasted to the end
    LOST = auto()


def outcome_of(history: RunHistory, person: PersonHistory) -> Outcome:
    """Return the outcome: whether a track was on a person in the last second in which it was due."""
    due = steady_due(history, person)
    if len(due) == 0:
        return Outcome.NEVER_DUE
    last = due[due > due[-1] - round(history.run.rate_hz)]
    if not (person.track[last] > 0).any():
        return Outcome.LOST
    return Outcome.HIDDEN if _is_hidden_to_end(history, person) else Outcome.TRACKED


def steady_due(history: RunHistory, person: PersonHistory) -> Ints:
    """Return the indices at which a person is due, without short spans unless there are no others."""
    steady = np.flatnonzero(settle(person.is_due.astype(np.int64), history.steady))
    return steady if len(steady) else np.flatnonzero(person.is_due)


def _is_hidden_to_end(history: RunHistory, person: PersonHistory) -> bool:
    """Return whether a person without a track stayed wholly hidden to the end, apart from moments."""
    after = person.view[np.flatnonzero(person.track)[-1] + 1 :]
    hidden = np.flatnonzero(after == Visibility.WHOLLY)
    if len(hidden) == 0:
        return False
    in_view = np.isin(after[hidden[0] :], (Visibility.SEEN, Visibility.PARTLY)).astype(np.int64)
    return Visibility.AWAY not in after and not settle(in_view, history.steady).any()


REIDENTIFIED_S = 1.0  # a person who gets the own number back within this time is re-identified
LONG_AWAY_S = 2.0


class ChangeKind(Enum):
    """Kind of a change of numbers."""

    LOST = auto()  # a new number, which stayed
    TAKEN = auto()  # the number of another person, reported as a `Transfer`
    FOR_A_MOMENT = auto()  # an own number came back within `REIDENTIFIED_S`
    BACK = auto()  # to a number that the person had before


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentityChange:
    """A person's number changed."""

    person: str
    last_frame: int  # last with the old number; from 1
    first_frame: int  # with the new one
    time_s: float  # of the latter
    old: int
    new: int
    turn: ChangeKind
    taken_from: str  # earlier owner of the new number; empty for a new or own number
    cause: Cause  # visibility of the person in between
    is_return: bool  # the person was out of the image for a long time
    reidentified_after_s: float  # time with other numbers before an own one came back; else 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Transfer:
    """A number passed from one person to another."""

    number: int
    giver: str
    receiver: str
    last_frame: int  # on the first; from 1
    first_frame: int  # on the second
    time_s: float  # of the latter
    cause: Cause  # visibility of the first person then


class _Held(NamedTuple):
    """A number was on a person."""

    person: PersonHistory
    span: Span


def find_changes(history: RunHistory) -> list[IdentityChange]:
    """Find all changes of numbers that lasted `STEADY_S`, in time order."""
    holders = _holders(history)
    changes = []
    for person in history.people:
        held = [span for span in spans(person.track) if span.value]
        changes += [
            _change(history, person, held, k, holders)
            for k, (old, new) in enumerate(pairwise(held), 1)
            if old.value != new.value
        ]
    return sorted(changes, key=lambda change: change.first_frame)


def find_transfers(history: RunHistory) -> list[Transfer]:
    """Find numbers that passed to other people, in time order, unless back within `REIDENTIFIED_S`."""
    transfers = []
    for number, holders in _holders(history).items():
        own, short = holders[0].person, REIDENTIFIED_S * history.run.rate_hz
        for k, (old, new) in enumerate(pairwise(holders), 1):
            back = holders[k + 1] if k + 1 < len(holders) else None
            is_short = back is not None and back.person is own and back.span.start - new.span.start <= short
            if new.person not in (old.person, own) and not is_short:
                transfers.append(_passing(history, number, old, new))
    return sorted(transfers, key=lambda one: one.first_frame)


def is_return(history: RunHistory, person: PersonHistory, start: int, end: int) -> bool:
    """Return whether a person was out of the image for a long time between two indices."""
    return int((person.view[start:end] == Visibility.AWAY).sum()) >= LONG_AWAY_S * history.run.rate_hz


def _holders(history: RunHistory) -> dict[int, list[_Held]]:
    """Return the people that each number was on, in time order; the first is its owner."""
    holders: dict[int, list[_Held]] = {}
    for person in history.people:
        for span in spans(person.track):
            if span.value:
                holders.setdefault(span.value, []).append(_Held(person, span))
    for held in holders.values():
        held.sort(key=lambda one: one.span.start)
    return holders


def _change(
    history: RunHistory, person: PersonHistory, held: Sequence[Span], k: int, holders: dict[int, list[_Held]]
) -> IdentityChange:
    old, new = held[k - 1], held[k]
    others = [one for one in holders[new.value] if one.span.start < new.start and one.person is not person]
    is_own = holders[new.value][0].person is person and any(span.value == new.value for span in held[:k])
    turn, known_s = _turn(history, held, k, is_own, bool(others))
    return IdentityChange(
        person=person.name,
        last_frame=old.end,
        first_frame=new.start + 1,
        time_s=history.run.time_s(new.start + 1),
        old=old.value,
        new=new.value,
        turn=turn,
        taken_from="" if is_own or not others else others[-1].person.name,
        cause=find_cause(history, person, old.end - 1, new.start),
        is_return=is_return(history, person, old.end, new.start),
        reidentified_after_s=known_s,
    )


def _turn(
    history: RunHistory, held: Sequence[Span], k: int, is_own: bool, is_taken: bool
) -> tuple[ChangeKind, float]:
    """Return the kind of the change to `held[k]`, and the time with other numbers if an own one came back."""
    rate, new = history.run.rate_hz, held[k]
    if is_own:
        last = max(n for n in range(k) if held[n].value == new.value)
        return ChangeKind.BACK, (new.start - held[last + 1].start) / rate
    if is_taken:
        return ChangeKind.TAKEN, 0.0
    had = {span.value for span in held[:k]}
    soon = [span for span in held[k + 1 :] if span.start - new.start <= REIDENTIFIED_S * rate]
    return (ChangeKind.FOR_A_MOMENT if any(span.value in had for span in soon) else ChangeKind.LOST), 0.0


def _passing(history: RunHistory, number: int, old: _Held, new: _Held) -> Transfer:
    return Transfer(
        number=number,
        giver=old.person.name,
        receiver=new.person.name,
        last_frame=old.span.end,
        first_frame=new.span.start + 1,
        time_s=history.run.time_s(new.span.start + 1),
        cause=find_cause(history, old.person, old.span.end - 1, new.span.start),
    )
