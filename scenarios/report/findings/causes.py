"""What there was to be seen of a person at some moment, in words."""

from __future__ import annotations

import numpy as np

from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.story import PersonView, RunStory, Story

BEFORE_S = 0.5  # what happened this long before a loss may be its cause
_CUT_OFF = 0.85  # share of a person nobody hides that is inside the image, below which that is worth telling
_PLAIN = "was in plain sight"


def plight(story: RunStory, person: Story, start: int, end: int) -> str:
    """Say what there was to be seen of a person between two indices: what lasted longest, the worst first.

    Where nothing was amiss then, it is told besides what had been just before, as that may be the cause.
    """
    words = _amiss(story, person, start, end)
    if words:
        return words
    before = _amiss(story, person, max(start - round(BEFORE_S * story.run.rate_hz), 0), start)
    if before:
        return f"{_PLAIN}, but had just {before.replace('was ', 'been ', 1)}"
    behind = [spoken(other.name) for other in story.people if other.hider_in(start, end + 1) == person.name]
    return f"{_PLAIN}, in front of {behind[0]}" if behind else _PLAIN


def _amiss(story: RunStory, person: Story, start: int, end: int) -> str:
    """Say why a person could not be seen well between two indices; empty if there is no reason."""
    first, last = max(start, 0), end + 1
    view = person.view[first:last]
    wholly, away = int((view == PersonView.WHOLLY).sum()), int((view == PersonView.AWAY).sum())
    if away > wholly and view[-1] == PersonView.AWAY:
        return "left the image"
    if away > wholly:
        return f"was out of the image for {seconds(away / story.run.rate_hz)}"
    by = person.hider_in(first, last)
    hider = f" by {spoken(by)}" if by else ""
    if wholly:
        return f"was wholly hidden{hider}"
    if (view == PersonView.PARTLY).any():
        return f"was hidden to {np.nanmax(person.occluded[first:last]):.0%}{hider}"
    if not person.is_counted[first:last].all():
        nearest_m, farthest_m = story.counted_m
        is_far = np.nanmax(person.distance_m[first:last]) > farthest_m
        return f"was {f'beyond {farthest_m:g}' if is_far else f'nearer than {nearest_m:g}'} m"
    if person.visible[first:last].min() < _CUT_OFF:
        return "was cut off by the image border"
    return ""
