"""The moments of a run that went worst."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.spans import Flags, spans
from peopleboy.scenarios.report.findings.story import Hold, Story
from peopleboy.scenarios.report.findings.summary import Outcome

_WELL_VISIBLE = 0.3
_APART_S = 1.0  # two moments of one person nearer than this are one


@dataclass(frozen=True, slots=True, kw_only=True)
class BadMoment:
    """What went wrong, and when.

    Attributes:
        badness: to choose by: a lost identity is worst, then contacts, tracks on nobody, people not found.
        frames: one or two to look at, from 1.
        title: what it is about.
        text: what happened.
        who: the person or thing that it is about.
    """

    badness: float
    frames: tuple[int, ...]
    title: str
    text: str
    who: str


def worst_moments(outcome: Outcome, count: int) -> list[BadMoment]:
    """Choose at most `count` moments, in time; where nothing went wrong, the boxes that fit worst."""
    found = [*_changes(outcome), *_contacts(outcome), *_strays(outcome)]
    for story in outcome.stories:
        found += _gaps(outcome, story)
    if len(found) < count:
        found += [_worst_fit(story) for story in outcome.stories if np.isfinite(story.iou).any()]
    chosen: list[BadMoment] = []
    for moment in sorted(found, key=lambda moment: -moment.badness):
        if len(chosen) < count and not any(_is_same(outcome, moment, other) for other in chosen):
            chosen.append(moment)
    return sorted(chosen, key=lambda moment: moment.frames)


def _is_same(outcome: Outcome, one: BadMoment, other: BadMoment) -> bool:
    gap = abs(one.frames[-1] - other.frames[-1]) / outcome.run.rate_hz
    return one.who == other.who and gap < _APART_S


def _changes(outcome: Outcome) -> list[BadMoment]:
    moments = []
    for change in outcome.changes:
        whose = f", which was {spoken(change.taken_from)}'s" if change.taken_from else ""
        name = spoken(change.person)
        moments.append(
            BadMoment(
                badness=40.0 if change.is_return else 100.0,
                frames=(change.last_frame, change.first_frame),
                title=f"{name} loses number {change.old}",
                text=f"{name} {change.why}, and was then number {change.new}{whose}.",
                who=change.person,
            )
        )
    return moments


def _contacts(outcome: Outcome) -> list[BadMoment]:
    return [
        BadMoment(
            badness=90.0,
            frames=(line.frame,),
            title=f"Contact with {spoken(line.other)}",
            text=f"The robot touches {spoken(line.other)}.",
            who=line.other,
        )
        for line in outcome.run.events
        if line.kind == "contact starts"
    ]


def _strays(outcome: Outcome) -> list[BadMoment]:
    moments = []
    for stray in outcome.strays:
        lasts_s = (stray.last_frame - stray.first_frame + 1) / outcome.run.rate_hz
        moments.append(
            BadMoment(
                badness=min(lasts_s * 10.0, 80.0),
                frames=((stray.first_frame + stray.last_frame) // 2,),
                title=f"Number {stray.track} is on nobody",
                text=f"This track lasts {seconds(lasts_s)} and never lies on a person.",
                who=f"track {stray.track}",
            )
        )
    return moments


def _gaps(outcome: Outcome, story: Story) -> list[BadMoment]:
    """Times at which a person who could be seen well had no box."""
    moments = []
    rate, name = outcome.run.rate_hz, spoken(story.name)
    for span in spans(story.hold):
        seen = story.visible[span.start : span.end]
        if span.value not in (Hold.MISSED, Hold.ADRIFT) or seen.max(initial=0.0) < _WELL_VISIBLE:
            continue
        lasts_s = span.length / rate
        is_missed = span.value == Hold.MISSED
        has = "has no track" if is_missed else "has a track whose box lies elsewhere"
        moments.append(
            BadMoment(
                badness=min(lasts_s * (8.0 if is_missed else 4.0), 50.0),
                frames=(span.start + _middle_of(seen >= _WELL_VISIBLE) + 1,),
                title=f"{name} {'is not found' if is_missed else 'is left by the box'}",
                text=f"{name} {has} for {seconds(lasts_s)} while up to {seen.max():.0%} visible.",
                who=story.name,
            )
        )
    return moments


def _middle_of(flags: Flags) -> int:
    at = np.flatnonzero(flags)
    return int(at[len(at) // 2])


def _worst_fit(story: Story) -> BadMoment:
    at = int(np.nanargmin(story.iou))
    name = spoken(story.name)
    return BadMoment(
        badness=1.0 - float(story.iou[at]),
        frames=(at + 1,),
        title=f"The box that fits {name} worst",
        text=f"Box and truth overlap by {story.iou[at]:.0%}; {story.visible[at]:.0%} of {name} is visible.",
        who=story.name,
    )


def common_frames(moments: Sequence[BadMoment]) -> list[int]:
    """All frames to be looked at, in order, each once."""
    return sorted({frame for moment in moments for frame in moment.frames})
