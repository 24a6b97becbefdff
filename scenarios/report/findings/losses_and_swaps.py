"""Where a person's number changed, where tracks ended, and why, as far as the data say."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from itertools import pairwise

import numpy as np

from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.spans import Ints, settle, spans
from peopleboy.scenarios.report.findings.story import STEADY_S, PersonView, RunStory, Story
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M

_BEFORE_S = 0.5  # what happened this long before a loss may be its cause
_LONG_AWAY_S = 2.0
_DECAY_S = 1.5  # over which the confidence is looked back at
_CUT_OFF = 0.85  # share of a person nobody hides that is inside the image, below which that is worth telling
_DECAYED = 0.15  # a fall by this much is worth telling


class Ending(Enum):
    """How it ended with a person."""

    NEVER_DUE = auto()
    TRACKED = auto()
    HIDDEN = auto()  # tracked until wholly hidden, which lasted to the end
    LOST = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A person's number became another one."""

    person: str
    last_frame: int  # with the old number; from 1
    first_frame: int  # with the new one
    time_s: float  # of the latter
    old: int
    new: int
    taken_from: str  # whose number the new one was before; empty for a fresh number
    why: str  # what there was to be seen of the person in between, as the rest of "when Ben ..."
    is_return: bool  # the person had been out of the image for so long that few would have known it


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A track was shown no more."""

    track: int
    frame: int  # the first without it
    time_s: float  # of that
    owner: str  # on whom it lay last; empty for nobody
    why: str  # what happened to the owner, and to the confidence
    believed: str  # why the tracker gave it up, by its own log; empty if that does not say
    afterwards: str
    is_bad: bool  # the person could be seen and lost the number


@dataclass(frozen=True, slots=True)
class Fleeting:
    """Losses that are not told one by one."""

    breaks: int  # after which the same number was shown again within `STEADY_S`
    ends: int  # of tracks that had been shown for less than that

    @property
    def words(self) -> str:
        """What is left out and why, in sentences; empty if nothing is."""
        short, told = f"less than {STEADY_S:g} s", []
        if self.breaks:
            told = [
                f"Losses of {short} ({self.breaks} of them) are left out: the same number was shown again."
            ]
        if self.ends:
            told.append(f"Ends of tracks that had been shown for {short} ({self.ends} of them) are left out.")
        return " ".join([*told, "All of them are in events.jsonl."]) if told else ""


@dataclass(frozen=True, slots=True)
class Stray:
    """A track that never lay on anybody; frames from 1, the last included."""

    track: int
    first_frame: int
    last_frame: int


def how_it_ended(story: RunStory, person: Story) -> Ending:
    """Tell whether a track lay on a person in the last second of being due, and what came then."""
    due = _steadily_due(story, person)
    if len(due) == 0:
        return Ending.NEVER_DUE
    last = due[due > due[-1] - round(story.run.rate_hz)]
    if not (person.track[last] > 0).any():
        return Ending.LOST
    return Ending.HIDDEN if _is_hidden_to_end(story, person) else Ending.TRACKED


def find_changes(story: RunStory) -> list[Change]:
    """Find all changes of numbers that lasted, in time."""
    changes = []
    for person in story.people:
        held = [span for span in spans(person.track) if span.value]
        changes += [
            Change(
                person=person.name,
                last_frame=old.end,
                first_frame=new.start + 1,
                time_s=story.run.time_s(new.start + 1),
                old=old.value,
                new=new.value,
                taken_from=_owner_before(story, new.value, new.start, person),
                why=_plight(story, person, old.end, new.start),
                is_return=_is_return(story, person, old.end, new.start),
            )
            for old, new in pairwise(held)
            if old.value != new.value
        ]
    return sorted(changes, key=lambda change: change.first_frame)


def find_losses(story: RunStory) -> list[Loss]:
    """Find every time that a track ceased to be shown before the end, in time; fleeting ones are left out."""
    losses = [
        _loss(story, number, span.end, steady)
        for number, steady in _steady_tracks(story).items()
        for span in spans(steady)
        if span.value and span.end < story.run.frames
    ]
    return sorted(losses, key=lambda loss: (loss.frame, loss.track))


def count_fleeting(story: RunStory) -> Fleeting:
    """Count the losses that `find_losses` leaves out."""
    breaks = ends = 0
    for number, steady in _steady_tracks(story).items():
        shown = story.shown[number]
        is_end = shown[:-1] & ~shown[1:]
        breaks += int((is_end & (steady[:-1] > 0) & (steady[1:] > 0)).sum())
        ends += int((is_end & (steady[:-1] == 0)).sum())
    return Fleeting(breaks, ends)


def find_strays(story: RunStory) -> list[Stray]:
    """Find the tracks that never lay on anybody, the longest first."""
    owned = {int(number) for person in story.people for number in np.unique(person.matched)}
    frames = {number: (np.flatnonzero(shown) + 1).tolist() for number, shown in story.shown.items()}
    strays = [Stray(number, at[0], at[-1]) for number, at in frames.items() if number not in owned]
    return sorted(strays, key=lambda stray: stray.first_frame - stray.last_frame)


def _steady_tracks(story: RunStory) -> dict[int, Ints]:
    """For each confirmed track 1 where it is shown, but for short breaks and glimpses, else 0: (F,)."""
    return {n: settle(shown.astype(np.int64), story.steady) for n, shown in story.shown.items()}


def _steadily_due(story: RunStory, person: Story) -> Ints:
    """Give the indices at which a person is due for more than a glimpse; of glimpses if there is no more."""
    steady = np.flatnonzero(settle(person.is_due.astype(np.int64), story.steady))
    return steady if len(steady) else np.flatnonzero(person.is_due)


def _is_hidden_to_end(story: RunStory, person: Story) -> bool:
    """Whether a person whom no track lies on any more was wholly hidden to the end, but for moments."""
    after = person.view[np.flatnonzero(person.track)[-1] + 1 :]
    hidden = np.flatnonzero(after == PersonView.WHOLLY)
    if len(hidden) == 0:
        return False
    in_view = np.isin(after[hidden[0] :], (PersonView.SEEN, PersonView.PARTLY)).astype(np.int64)
    return PersonView.AWAY not in after and not settle(in_view, story.steady).any()


def _loss(story: RunStory, number: int, end: int, steady: Ints) -> Loss:
    """Explain the loss of a track at index `end`, the first without it."""
    owner = _owner(story.people, number, end)
    again = np.flatnonzero(steady[end:])
    why, afterwards, is_bad = "there was nobody", "it never came back", False
    if owner is not None:
        why = _plight(story, owner, end - 1, end + 1)
        afterwards, is_bad = _afterwards(story, owner, number, end)
    if len(again):
        afterwards, is_bad = f"shown again after {seconds(again[0] / story.run.rate_hz)}, same number", False
    return Loss(
        track=number,
        frame=end + 1,
        time_s=story.run.time_s(end + 1),
        owner="" if owner is None else owner.name,
        why=f"{why}; {_confidence(story, number, end)}",
        believed=_belief(story, number, end, owner),
        afterwards=afterwards,
        is_bad=is_bad,
    )


def _afterwards(story: RunStory, person: Story, number: int, end: int) -> tuple[str, bool]:
    """Say what became of a person whose track was lost, and whether that is bad."""
    later = [span for span in spans(person.track[end:]) if span.value]
    name, rate = spoken(person.name), story.run.rate_hz
    if later and later[0].value != number:
        when = f"after {seconds(later[0].start / rate)}" if later[0].start else "at once"
        is_bad = not _is_return(story, person, end, end + later[0].start)
        return f"{name} was found {when} as number {later[0].value}", is_bad
    ended = how_it_ended(story, person)
    if ended is Ending.HIDDEN:
        return f"{name} was hidden until the end", False
    if not (_steadily_due(story, person) >= end).any():
        return f"{name} did not come back into view", False
    if ended is Ending.TRACKED:
        return f"the run ended {seconds((story.run.frames - end) / rate)} later", False
    return f"{name} was not found again", True


def _belief(story: RunStory, number: int, end: int, own: Story | None) -> str:
    """Give the tracker's own reason, and say on whom the tracks lay that it names."""
    about = ("lost", f"track {number}", end + 1)
    why = next((line.why for line in story.run.events if (line.kind, line.who, line.frame) == about), "")
    return re.sub(
        r"track (\d+)", lambda found: f"number {found[1]}{_whose(story, int(found[1]), end, own)}", why
    )


def _whose(story: RunStory, number: int, end: int, own: Story | None) -> str:
    """Say on whom a track lay before an index, in brackets; nothing for nobody."""
    owner = _owner(story.people, number, end)
    if owner is None:
        return ""
    recent = owner.track[max(end - round(_BEFORE_S * story.run.rate_hz), 0) : end]
    last = "" if number in recent else "last "
    return f" ({last}on {spoken(owner.name)}{' too' if owner is own else ''})"


def _is_return(story: RunStory, person: Story, start: int, end: int) -> bool:
    """Whether a person was out of the image for long between two indices."""
    return int((person.view[start:end] == PersonView.AWAY).sum()) >= _LONG_AWAY_S * story.run.rate_hz


def _plight(story: RunStory, person: Story, start: int, end: int) -> str:
    """Say what there was to be seen of a person between two indices: what lasted longest, the worst first."""
    first, last = max(start - round(_BEFORE_S * story.run.rate_hz), 0), end + 1
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
        is_far = np.nanmax(person.distance_m[first:last]) > COUNTED_FARTHEST_M
        return f"was {f'beyond {COUNTED_FARTHEST_M:g}' if is_far else f'nearer than {COUNTED_NEAREST_M:g}'} m"
    if person.visible[first:last].min() < _CUT_OFF:
        return "was cut off by the image border"
    behind = [spoken(other.name) for other in story.people if other.hider_in(first, last) == person.name]
    return f"was in plain sight, in front of {behind[0]}" if behind else "was in plain sight"


def _confidence(story: RunStory, number: int, end: int) -> str:
    """Say how the confidence went until index `end`."""
    beliefs = story.files.beliefs
    rows = beliefs.filter(np.asarray(beliefs["id"].to_numpy() == number))
    frame, value = rows["frame"].to_numpy() - 1, rows["confidence"].to_numpy()
    recent = value[(frame < end) & (frame >= end - round(_DECAY_S * story.run.rate_hz))]
    if len(recent) == 0 or not np.isfinite(recent).all():
        return "its confidence is not known"
    highest, last = float(recent.max()), float(recent[-1])
    if highest - last < _DECAYED:
        return f"its confidence was still {last:.2f}"
    return f"its confidence fell from {highest:.2f} to {last:.2f}"


def _owner(people: Sequence[Story], number: int, end: int) -> Story | None:
    """On whom a track lay last before an index."""
    last = {person.id: np.flatnonzero(person.track[:end] == number) for person in people}
    found = [person for person in people if len(last[person.id])]
    return max(found, key=lambda person: int(last[person.id][-1]), default=None)


def _owner_before(story: RunStory, number: int, end: int, but: Story) -> str:
    """On whom else a track lay before an index; empty for nobody."""
    owner = _owner([person for person in story.people if person is not but], number, end)
    return "" if owner is None else owner.name
