"""Where the number on a person became another one, and where a number went to another person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from itertools import pairwise
from typing import NamedTuple

from peopleboy.scenarios.report.findings.causes import find_cause
from peopleboy.scenarios.report.findings.histories import PersonHistory, RunHistory, Span, Visibility, spans
from peopleboy.scenarios.report.findings.sentences import Cause

REIDENTIFIED_S = (
    1.0  # within which who has another number, or whose number is on another one, may be known again
)
LONG_AWAY_S = 2.0


class ChangeKind(Enum):
    """What a change of numbers means."""

    LOST = auto()  # a fresh number, which stayed
    TAKEN = auto()  # that of another person, reported as a `Transfer`
    FOR_A_MOMENT = auto()  # an own one came back within `REIDENTIFIED_S`
    BACK = auto()  # to a number that the person had before


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentityChange:
    """A person's number became another one."""

    person: str
    last_frame: int  # with the old number; from 1
    first_frame: int  # with the new one
    time_s: float  # of the latter
    old: int
    new: int
    turn: ChangeKind
    taken_from: str  # whose number the new one was before; empty for a fresh or an own number
    cause: Cause  # what there was to be seen of the person in between
    is_return: bool  # the person had been out of the image for so long that few would have known it
    reidentified_after_s: (
        float  # for how long the person had other numbers, of a way back to an own one; else 0
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Transfer:
    """A number went from one person to another."""

    number: int
    giver: str
    receiver: str
    last_frame: int  # on the first; from 1
    first_frame: int  # on the second
    time_s: float  # of the latter
    cause: Cause  # what there was to be seen of the first then


class _Held(NamedTuple):
    """A number lay on a person."""

    person: PersonHistory
    span: Span


def find_changes(history: RunHistory) -> list[IdentityChange]:
    """Find all changes of numbers that lasted `STEADY_S`, in time."""
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
    """Find where numbers passed to other people, in time, unless they were back within `REIDENTIFIED_S`."""
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
    """Whether a person was out of the image for long between two indices."""
    return int((person.view[start:end] == Visibility.AWAY).sum()) >= LONG_AWAY_S * history.run.rate_hz


def _holders(history: RunHistory) -> dict[int, list[_Held]]:
    """Tell on whom each number lay, in time; the first one is whose it is."""
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
    """Return what the change to `held[k]` means, and of a way back how long other numbers were there."""
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
