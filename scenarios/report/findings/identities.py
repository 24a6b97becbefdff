"""Where a person's number changed, where tracks ended, and why, as far as the data say."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from peopleboy.scenarios.report.findings.endings import Ending, how_it_ended, steadily_due
from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.spans import Flags, settle, spans
from peopleboy.scenarios.report.findings.story import STEADY_S, Sight, Story, present_tracks, steady_frames
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M

_BEFORE_S = 0.5  # what happened this long before a loss may be its cause
_LONG_AWAY_S = 2.0
_DECAY_S = 1.5  # over which the confidence is looked back at
_CUT_OFF = 0.85  # share of a person nobody hides that is inside the image, below which that is worth telling
_DECAYED = 0.15  # a fall by this much is worth telling


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A person's number became another one.

    Attributes:
        person: name.
        last_frame, first_frame: last with the old number, first with the new one; from 1.
        time_s: of the latter.
        old, new: the numbers.
        taken_from: whose number the new one was before; empty for a fresh number.
        why: what there was to be seen of the person in between, as the rest of "when Ben ...".
        is_return: whether the person had been out of the image for long, so that few would have known it.
    """

    person: str
    last_frame: int
    first_frame: int
    time_s: float
    old: int
    new: int
    taken_from: str
    why: str
    is_return: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A track was shown no more.

    Attributes:
        track: its number.
        frame: the first without it.
        time_s: of that.
        owner: on whom it lay last; empty for nobody.
        why: what happened to the owner, and to the confidence.
        believed: why the tracker gave it up, by its own log; empty if that does not say.
        afterwards: what came then.
        is_bad: whether the person could be seen and lost the number.
    """

    track: int
    frame: int
    time_s: float
    owner: str
    why: str
    believed: str
    afterwards: str
    is_bad: bool


@dataclass(frozen=True, slots=True)
class Fleeting:
    """Losses that are not told one by one.

    Attributes:
        breaks: after which the same number was shown again within `STEADY_S`.
        ends: of tracks that had been shown for less than that.
    """

    breaks: int
    ends: int

    @property
    def words(self) -> str:
        """What is left out and why, in sentences; empty if nothing is."""
        told, short = [], f"less than {STEADY_S:g} s"
        if self.breaks:
            told.append(
                f"Losses of {short} ({self.breaks} of them) are left out: the same number was shown again."
            )
        if self.ends:
            told.append(f"Ends of tracks that had been shown for {short} ({self.ends} of them) are left out.")
        return " ".join([*told, "All of them are in events.jsonl."]) if told else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stray:
    """A track that never lay on anybody; frames from 1, the last included."""

    track: int
    first_frame: int
    last_frame: int


def find_changes(run: FinishedRun, stories: Sequence[Story]) -> list[Change]:
    """Find all changes of numbers that lasted, in time."""
    changes = []
    for story in stories:
        held = [span for span in spans(story.track) if span.value]
        for old, new in pairwise(held):
            if old.value != new.value:
                changes.append(
                    Change(
                        person=story.name,
                        last_frame=old.end,
                        first_frame=new.start + 1,
                        time_s=run.time_s(new.start + 1),
                        old=old.value,
                        new=new.value,
                        taken_from=_owner_before(stories, new.value, new.start, story),
                        why=_plight(run, stories, story, old.end, new.start),
                        is_return=_is_return(run, story, old.end, new.start),
                    )
                )
    return sorted(changes, key=lambda change: change.first_frame)


def find_losses(run: FinishedRun, stories: Sequence[Story]) -> list[Loss]:
    """Find every time that a track ceased to be shown before the end, in time; fleeting ones are left out."""
    losses = []
    for number, shown in present_tracks(run).items():
        steady = settle(shown.astype(np.int64), steady_frames(run)) > 0
        losses += [
            _loss(run, stories, number, span.end, steady)
            for span in spans(steady)
            if span.value and span.end < run.frames
        ]
    return sorted(losses, key=lambda loss: (loss.frame, loss.track))


def count_fleeting(run: FinishedRun) -> Fleeting:
    """Count the losses that `find_losses` leaves out."""
    breaks = ends = 0
    for shown in present_tracks(run).values():
        steady = settle(shown.astype(np.int64), steady_frames(run)) > 0
        is_end = shown[:-1] & ~shown[1:]
        breaks += int((is_end & steady[:-1] & steady[1:]).sum())
        ends += int((is_end & ~steady[:-1]).sum())
    return Fleeting(breaks, ends)


def find_strays(run: FinishedRun, stories: Sequence[Story]) -> list[Stray]:
    """Find the tracks that never lay on anybody, the longest first."""
    owned = {int(number) for story in stories for number in np.unique(story.matched)}
    strays = []
    for number, shown in present_tracks(run).items():
        if number not in owned:
            at = np.flatnonzero(shown)
            strays.append(Stray(track=number, first_frame=int(at[0]) + 1, last_frame=int(at[-1]) + 1))
    return sorted(strays, key=lambda stray: stray.first_frame - stray.last_frame)


def _loss(run: FinishedRun, stories: Sequence[Story], number: int, end: int, shown: Flags) -> Loss:
    """Explain the loss of a track at index `end`, the first without it."""
    story = _owner(stories, number, end)
    again = np.flatnonzero(shown[end:])
    why, afterwards, is_bad = "there was nobody", "", False
    if story is not None:
        why = _plight(run, stories, story, end - 1, end + 1)
        afterwards, is_bad = _afterwards(run, story, number, end)
    if len(again):
        afterwards, is_bad = f"shown again after {seconds(again[0] / run.rate_hz)}, same number", False
    return Loss(
        track=number,
        frame=end + 1,
        time_s=run.time_s(end + 1),
        owner="" if story is None else story.name,
        why=f"{why}; {_confidence(run, number, end)}",
        believed=_belief(run, stories, number, end),
        afterwards=afterwards or "it never came back",
        is_bad=is_bad,
    )


def _afterwards(run: FinishedRun, story: Story, number: int, end: int) -> tuple[str, bool]:
    later = [span for span in spans(story.track[end:]) if span.value]
    name = spoken(story.name)
    if later and later[0].value != number:
        after_s = later[0].start / run.rate_hz
        is_bad = not _is_return(run, story, end, end + later[0].start)
        when = f"after {seconds(after_s)}" if later[0].start else "at once"
        return f"{name} was found {when} as number {later[0].value}", is_bad
    ended = how_it_ended(run, story)
    if ended is Ending.HIDDEN:
        return f"{name} was hidden until the end", False
    if not (steadily_due(run, story) >= end).any():
        return f"{name} did not come back into view", False
    if ended is Ending.TRACKED:
        return f"the run ended {seconds((run.frames - end) / run.rate_hz)} later", False
    return f"{name} was not found again", True


def _belief(run: FinishedRun, stories: Sequence[Story], number: int, end: int) -> str:
    """Give the tracker's own reason, and say on whom the tracks lay that it names."""
    about = ("lost", f"track {number}", end + 1)
    why = next((line.why for line in run.events if (line.kind, line.who, line.frame) == about), "")
    own = _owner(stories, number, end)
    return re.sub(
        r"track (\d+)", lambda found: f"number {found[1]}{_whose(run, stories, int(found[1]), end, own)}", why
    )


def _whose(run: FinishedRun, stories: Sequence[Story], number: int, end: int, own: Story | None) -> str:
    """Say on whom a track lay before an index, in brackets; nothing for nobody."""
    owner = _owner(stories, number, end)
    if owner is None:
        return ""
    recent = owner.track[max(end - round(_BEFORE_S * run.rate_hz), 0) : end]
    last = "" if number in recent else "last "
    return f" ({last}on {spoken(owner.name)}{' too' if owner is own else ''})"


def _is_return(run: FinishedRun, story: Story, start: int, end: int) -> bool:
    """Whether a person was out of the image for long between two indices."""
    return int((story.sight[start:end] == Sight.AWAY).sum()) >= _LONG_AWAY_S * run.rate_hz


def _plight(run: FinishedRun, stories: Sequence[Story], story: Story, start: int, end: int) -> str:
    """Say what there was to be seen of a person between two indices: what lasted longest, the worst first."""
    first, last = max(start - round(_BEFORE_S * run.rate_hz), 0), end + 1
    sight = story.sight[first:last]
    wholly, away = int((sight == Sight.WHOLLY).sum()), int((sight == Sight.AWAY).sum())
    if away > wholly and sight[-1] == Sight.AWAY:
        return "left the image"
    if away > wholly:
        return f"was out of the image for {seconds(away / run.rate_hz)}"
    by = story.hider_in(first, last)
    hider = f" by {spoken(by)}" if by else ""
    if wholly:
        return f"was wholly hidden{hider}"
    if (sight == Sight.PARTLY).any():
        return f"was hidden to {np.nanmax(story.occluded[first:last]):.0%}{hider}"
    if not story.is_counted[first:last].all():
        return _too_near_or_far(story, first, last)
    if story.visible[first:last].min() < _CUT_OFF:
        return "was cut off by the image border"
    behind = [other for other in stories if other.hider_in(first, last) == story.name]
    if behind:
        return f"was in plain sight, in front of {spoken(behind[0].name)}"
    return "was in plain sight"


def _too_near_or_far(story: Story, first: int, last: int) -> str:
    is_far = np.nanmax(story.distance_m[first:last]) > COUNTED_FARTHEST_M
    return f"was beyond {COUNTED_FARTHEST_M:g} m" if is_far else f"was nearer than {COUNTED_NEAREST_M:g} m"


def _confidence(run: FinishedRun, number: int, end: int) -> str:
    """Say how the confidence went until index `end`."""
    rows = run.beliefs.filter(np.asarray(run.beliefs["id"].to_numpy() == number))
    frame, value = rows["frame"].to_numpy() - 1, rows["confidence"].to_numpy()
    recent = value[(frame < end) & (frame >= end - round(_DECAY_S * run.rate_hz))]
    if len(recent) == 0 or not np.isfinite(recent).all():
        return "its confidence is not known"
    highest, last = float(recent.max()), float(recent[-1])
    if highest - last < _DECAYED:
        return f"its confidence was still {last:.2f}"
    return f"its confidence fell from {highest:.2f} to {last:.2f}"


def _owner(stories: Sequence[Story], number: int, end: int) -> Story | None:
    """On whom a track lay last before an index."""
    last = {story.id: np.flatnonzero(story.track[:end] == number) for story in stories}
    found = [story for story in stories if len(last[story.id])]
    return max(found, key=lambda story: int(last[story.id][-1]), default=None)


def _owner_before(stories: Sequence[Story], number: int, end: int, but: Story) -> str:
    """On whom else a track lay before an index; empty for nobody."""
    owner = _owner([story for story in stories if story.id != but.id], number, end)
    return "" if owner is None else owner.name
