"""The moments of a run that went worst."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.spans import spans
from peopleboy.scenarios.report.findings.story import Hold, Story
from peopleboy.scenarios.report.findings.summary import RunFindings
from peopleboy.sim.truth.scenes import SEEN

_APART_S = 1.0  # two moments of one person nearer than this are one


class BadMoment(NamedTuple):
    """What went wrong, and when."""

    # To choose by: a number on somebody else is worst, then a lost identity, contacts, tracks on nobody, ...
    badness: float
    frames: tuple[int, ...]  # one or two to look at, from 1
    title: str
    text: str
    who: str  # the person or thing that it is about


def worst_moments(found: RunFindings, count: int) -> list[BadMoment]:
    """Choose at most `count` moments, in time; where nothing went wrong, the boxes that fit worst."""
    moments = [*_passings(found), *_changes(found), *_contacts(found), *_strays(found)]
    for person in found.people:
        moments += _gaps(found, person)
    if len(moments) < count:
        moments += [_worst_fit(person) for person in found.people if np.isfinite(person.iou).any()]
    chosen: list[BadMoment] = []
    for moment in sorted(moments, key=lambda moment: -moment.badness):
        if len(chosen) < count and not any(_is_same(found, moment, other) for other in chosen):
            chosen.append(moment)
    return sorted(chosen, key=lambda moment: moment.frames)


def _is_same(found: RunFindings, one: BadMoment, other: BadMoment) -> bool:
    gap = abs(one.frames[-1] - other.frames[-1]) / found.run.rate_hz
    return one.who == other.who and gap < _APART_S


def _passings(found: RunFindings) -> Iterator[BadMoment]:
    for one in found.passings:
        name, other = spoken(one.from_person), spoken(one.to_person)
        text = f"{name} {one.why}; from then on {other} was number {one.number}."
        title = f"Number {one.number} goes from {name} to {other}"
        yield BadMoment(200.0, (one.last_frame, one.first_frame), title, text, one.to_person)


def _changes(found: RunFindings) -> Iterator[BadMoment]:
    for change in found.lost:
        name, badness = spoken(change.person), 40.0 if change.is_return else 100.0
        text = f"{name} {change.why}, and was then number {change.new}."
        frames = (change.last_frame, change.first_frame)
        yield BadMoment(badness, frames, f"{name} loses number {change.old}", text, change.person)


def _contacts(found: RunFindings) -> Iterator[BadMoment]:
    for line in found.contacts:
        name = spoken(line.other)
        yield BadMoment(90.0, (line.frame,), f"Contact with {name}", f"The robot touches {name}.", line.other)


def _strays(found: RunFindings) -> Iterator[BadMoment]:
    for stray in found.strays:
        lasts_s = (stray.last_frame - stray.first_frame + 1) / found.run.rate_hz
        frames = ((stray.first_frame + stray.last_frame) // 2,)
        text = f"This track lasts {seconds(lasts_s)} and never lies on a person."
        title, who = f"Number {stray.track} is on nobody", f"track {stray.track}"
        yield BadMoment(min(lasts_s * 10.0, 80.0), frames, title, text, who)


def _gaps(found: RunFindings, person: Story) -> Iterator[BadMoment]:
    """Times at which a person who was seen had no box."""
    name = spoken(person.name)
    for span in spans(person.hold):
        seen = person.visible[span.start : span.end]
        well = np.flatnonzero(seen > SEEN).tolist()
        if span.value not in (Hold.MISSED, Hold.ADRIFT) or not well:
            continue
        lasts_s, is_missed = span.length / found.run.rate_hz, span.value == Hold.MISSED
        title = f"{name} {'is not found' if is_missed else 'is left by the box'}"
        has = "has no track" if is_missed else "has a track whose box lies elsewhere"
        text = f"{name} {has} for {seconds(lasts_s)} while up to {seen.max():.0%} visible."
        badness = min(lasts_s * (8.0 if is_missed else 4.0), 50.0)
        yield BadMoment(badness, (span.start + well[len(well) // 2] + 1,), title, text, person.name)


def _worst_fit(person: Story) -> BadMoment:
    at, name = int(np.nanargmin(person.iou)), spoken(person.name)
    iou, visible = float(person.iou[at]), person.visible[at]
    text = f"Box and truth overlap by {iou:.0%}; {visible:.0%} of {name} is visible."
    return BadMoment(1.0 - iou, (at + 1,), f"The box that fits {name} worst", text, person.name)
