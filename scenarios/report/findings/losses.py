"""Where tracks ended, and why, as far as the data say."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.loop.track_events import KNOWN
from peopleboy.scenarios.report.findings.causes import BEFORE_S, plight
from peopleboy.scenarios.report.findings.changes import is_return
from peopleboy.scenarios.report.findings.endings import Ending, how_it_ended, steadily_due
from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.report.findings.spans import Flags, Ints, settle, spans
from peopleboy.scenarios.report.findings.story import STEADY_S, RunStory, Story

_DECAY_S = 1.5  # over which the confidence is looked back at
_DECAYED = 0.15  # a fall by this much is worth telling


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


def find_losses(story: RunStory) -> list[Loss]:
    """Find every time that a track ceased to be shown before the end, in time.

    Fleeting ones are left out, and so are tracks that went on under a number known from before.
    """
    losses = [
        _loss(story, number, end, steady)
        for number, steady in _steady_tracks(story).items()
        for end in _ends(story, number, steady > 0)
    ]
    return sorted(losses, key=lambda loss: (loss.frame, loss.track))


def count_fleeting(story: RunStory) -> Fleeting:
    """Count the losses that `find_losses` leaves out, but for tracks that went on under another number."""
    breaks = ends = 0
    for number, steady in _steady_tracks(story).items():
        for end in _ends(story, number, story.shown[number]):
            breaks += int(steady[end - 1] > 0 and steady[end] > 0)
            ends += int(steady[end - 1] == 0)
    return Fleeting(breaks, ends)


def _ends(story: RunStory, number: int, shown: Flags) -> Iterator[int]:
    """Yield the indices at which a track is shown no more, though nobody goes on as somebody known again."""
    known = {
        line.frame - 1
        for line in story.run.events
        if line.kind == KNOWN and line.other and line.who == f"track {number}"
    }
    for span in spans(shown):
        if span.value and span.end < story.run.frames and span.end not in known:
            yield span.end


def find_strays(story: RunStory) -> list[Stray]:
    """Find the tracks that never lay on anybody, the longest first."""
    owned = {int(number) for person in story.people for number in np.unique(person.matched)}
    frames = {number: (np.flatnonzero(shown) + 1).tolist() for number, shown in story.shown.items()}
    strays = [Stray(number, at[0], at[-1]) for number, at in frames.items() if number not in owned]
    return sorted(strays, key=lambda stray: stray.first_frame - stray.last_frame)


def _steady_tracks(story: RunStory) -> dict[int, Ints]:
    """For each confirmed track 1 where it is shown, but for short breaks and glimpses, else 0: (F,)."""
    return {n: settle(shown.astype(np.int64), story.steady) for n, shown in story.shown.items()}


def _loss(story: RunStory, number: int, end: int, steady: Ints) -> Loss:
    """Explain the loss of a track at index `end`, the first without it."""
    owner = _owner(story.people, number, end)
    again = np.flatnonzero(steady[end:])
    why, afterwards, is_bad = "there was nobody", "it never came back", False
    if owner is not None:
        why = plight(story, owner, end - 1, min(end + 1, story.run.frames - 1))
        afterwards, is_bad = _afterwards(story, owner, number, end)
    if len(again):
        shown, is_same = _shown_again(story, number, owner, (end, end + int(again[0])))
        afterwards, is_bad = (shown, False) if is_same else (f"{shown}; {afterwards}", is_bad)
    return Loss(
        track=number,
        frame=end + 1,
        time_s=story.run.time_s(end + 1),
        owner="" if owner is None else owner.name,
        why=f"{why}{_during_faults(story, end)}; {_confidence(story, number, end)}",
        believed=_belief(story, number, end, owner),
        afterwards=afterwards,
        is_bad=is_bad,
    )


def _shown_again(story: RunStory, number: int, owner: Story | None, gap: tuple[int, int]) -> tuple[str, bool]:
    """Say on whom a track lay that was shown again after a gap, and whether that is whom it was on before."""
    end, again = gap
    shown = f"shown again after {seconds((again - end) / story.run.rate_hz)}"
    break_at = np.flatnonzero(~story.shown[number][again:])
    until = again + int(break_at[0]) if len(break_at) else story.run.frames
    steadily, at_all = (
        _first_on(
            [(p, numbers[again:until] == number) for p, numbers in zip(story.people, column, strict=True)]
        )
        for column in ([p.track for p in story.people], [p.matched for p in story.people])
    )
    first, person = steadily or at_all or (0, None)
    if person is None:
        return f"{shown}, on nobody", owner is None
    late = f", on nobody for {seconds(first / story.run.rate_hz)}" if first > story.steady else ""
    same = person is owner
    return f"{shown}{late}, {'same number' if same else f'on {spoken(person.name)}'}", same or owner is None


def _first_on(lies: Sequence[tuple[Story, Flags]]) -> tuple[int, Story] | None:
    """Give when and on whom a track lay first, of flags (N,) for each person; None if it lay on nobody."""
    first = [(int(at[0]), person) for person, flags in lies if len(at := np.flatnonzero(flags))]
    return min(first, key=lambda one: one[0], default=None)


def _afterwards(story: RunStory, person: Story, number: int, end: int) -> tuple[str, bool]:
    """Say what became of a person whose track was lost, and whether that is bad."""
    later = [span for span in spans(person.track[end:]) if span.value]
    name, rate = spoken(person.name), story.run.rate_hz
    if later and later[0].value != number:
        when = f"after {seconds(later[0].start / rate)}" if later[0].start else "at once"
        away = ", having been out of the image" if is_return(story, person, end, end + later[0].start) else ""
        return f"{name} was found {when} as number {later[0].value}{away}", True
    ended = how_it_ended(story, person)
    if ended is Ending.HIDDEN:
        return f"{name} was hidden until the end", False
    if not (steadily_due(story, person) >= end).any():
        return f"{name} did not come back into view", False
    if ended is Ending.TRACKED:
        return f"the run ended {seconds((story.run.frames - end) / rate)} later", False
    return f"{name} was not found again", True


def _belief(story: RunStory, number: int, end: int, own: Story | None) -> str:
    """Give the tracker's own reason, and say on whom the tracks lay that it names."""
    about, since = ("lost", f"track {number}"), end + 1 - story.every
    events = (line for line in story.run.events if since < line.frame <= end + 1)
    why = next((line.why for line in events if (line.kind, line.who) == about), "")
    return re.sub(
        r"track (\d+)", lambda found: f"number {found[1]}{_whose(story, int(found[1]), end, own)}", why
    )


def _whose(story: RunStory, number: int, end: int, own: Story | None) -> str:
    """Say on whom a track lay before an index, in brackets; nothing for nobody."""
    owner = _owner(story.people, number, end)
    if owner is None:
        return ""
    recent = owner.track[max(end - round(BEFORE_S * story.run.rate_hz), 0) : end]
    last = "" if number in recent else "last "
    return f" ({last}on {spoken(owner.name)}{' too' if owner is own else ''})"


def _during_faults(story: RunStory, end: int) -> str:
    """Name the faults that there were at index `end`; nothing if there were none."""
    there: dict[str, None] = {}
    for line in story.run.events:
        if line.frame > end + 1:
            break
        if line.kind == "fault starts":
            there[line.who] = None
        elif line.kind == "fault ends":
            there.pop(line.who, None)
    return f", during the fault {' and '.join(there)}" if there else ""


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
