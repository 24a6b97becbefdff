"""Where the number on a person became another one, and where a number went to somebody else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from itertools import pairwise
from typing import NamedTuple

from peopleboy.scenarios.report.findings.causes import plight
from peopleboy.scenarios.report.findings.spans import Span, spans
from peopleboy.scenarios.report.findings.story import PersonView, RunStory, Story

KNOWN_AGAIN_S = (
    1.0  # within which who has another number, or whose number is on another one, may be known again
)
LONG_AWAY_S = 2.0


class Turn(Enum):
    """What a change of numbers means."""

    LOST = auto()  # a fresh number, which stayed
    TAKEN = auto()  # that of somebody else, told as a `Passing`
    FOR_A_MOMENT = auto()  # an own one came back within `KNOWN_AGAIN_S`
    BACK = auto()  # to a number that the person had before


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A person's number became another one."""

    person: str
    last_frame: int  # with the old number; from 1
    first_frame: int  # with the new one
    time_s: float  # of the latter
    old: int
    new: int
    turn: Turn
    taken_from: str  # whose number the new one was before; empty for a fresh or an own number
    why: str  # what there was to be seen of the person in between, as the rest of "when Ben ..."
    is_return: bool  # the person had been out of the image for so long that few would have known it
    known_after_s: float  # for how long the person had other numbers, of a way back to an own one; else 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Passing:
    """A number went from one person to another."""

    number: int
    from_person: str
    to_person: str
    last_frame: int  # on the first; from 1
    first_frame: int  # on the second
    time_s: float  # of the latter
    why: str  # what there was to be seen of the first then, as the rest of "Anna ..."


class _Held(NamedTuple):
    """A number lay on a person."""

    person: Story
    span: Span


def find_changes(story: RunStory) -> list[Change]:
    """Find all changes of numbers that lasted `STEADY_S`, in time."""
    holders = _holders(story)
    changes = []
    for person in story.people:
        held = [span for span in spans(person.track) if span.value]
        changes += [
            _change(story, person, held, k, holders)
            for k, (old, new) in enumerate(pairwise(held), 1)
            if old.value != new.value
        ]
    return sorted(changes, key=lambda change: change.first_frame)


def find_passings(story: RunStory) -> list[Passing]:
    """Find where numbers went to somebody else, in time; but not if they were back within `KNOWN_AGAIN_S`."""
    passings = []
    for number, holders in _holders(story).items():
        own, short = holders[0].person, KNOWN_AGAIN_S * story.run.rate_hz
        for k, (old, new) in enumerate(pairwise(holders), 1):
            back = holders[k + 1] if k + 1 < len(holders) else None
            is_short = back is not None and back.person is own and back.span.start - new.span.start <= short
            if new.person not in (old.person, own) and not is_short:
                passings.append(_passing(story, number, old, new))
    return sorted(passings, key=lambda one: one.first_frame)


def is_return(story: RunStory, person: Story, start: int, end: int) -> bool:
    """Whether a person was out of the image for long between two indices."""
    return int((person.view[start:end] == PersonView.AWAY).sum()) >= LONG_AWAY_S * story.run.rate_hz


def _holders(story: RunStory) -> dict[int, list[_Held]]:
    """Tell on whom each number lay, in time; the first one is whose it is."""
    holders: dict[int, list[_Held]] = {}
    for person in story.people:
        for span in spans(person.track):
            if span.value:
                holders.setdefault(span.value, []).append(_Held(person, span))
    for held in holders.values():
        held.sort(key=lambda one: one.span.start)
    return holders


def _change(
    story: RunStory, person: Story, held: Sequence[Span], k: int, holders: dict[int, list[_Held]]
) -> Change:
    old, new = held[k - 1], held[k]
    others = [one for one in holders[new.value] if one.span.start < new.start and one.person is not person]
    is_own = holders[new.value][0].person is person and any(span.value == new.value for span in held[:k])
    turn, known_s = _turn(story, held, k, is_own, bool(others))
    return Change(
        person=person.name,
        last_frame=old.end,
        first_frame=new.start + 1,
        time_s=story.run.time_s(new.start + 1),
        old=old.value,
        new=new.value,
        turn=turn,
        taken_from="" if is_own or not others else others[-1].person.name,
        why=plight(story, person, old.end - 1, new.start),
        is_return=is_return(story, person, old.end, new.start),
        known_after_s=known_s,
    )


def _turn(story: RunStory, held: Sequence[Span], k: int, is_own: bool, is_taken: bool) -> tuple[Turn, float]:
    """Tell what the change to `held[k]` means, and of a way back how long other numbers were there."""
    rate, new = story.run.rate_hz, held[k]
    if is_own:
        last = max(n for n in range(k) if held[n].value == new.value)
        return Turn.BACK, (new.start - held[last + 1].start) / rate
    if is_taken:
        return Turn.TAKEN, 0.0
    had = {span.value for span in held[:k]}
    soon = [span for span in held[k + 1 :] if span.start - new.start <= KNOWN_AGAIN_S * rate]
    return (Turn.FOR_A_MOMENT if any(span.value in had for span in soon) else Turn.LOST), 0.0


def _passing(story: RunStory, number: int, old: _Held, new: _Held) -> Passing:
    return Passing(
        number=number,
        from_person=old.person.name,
        to_person=new.person.name,
        last_frame=old.span.end,
        first_frame=new.span.start + 1,
        time_s=story.run.time_s(new.span.start + 1),
        why=plight(story, old.person, old.span.end - 1, new.span.start),
    )
