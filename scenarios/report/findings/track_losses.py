"""Find the losses of tracks, and their causes as far as the data show them."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.loop.run_events import KNOWN
from peopleboy.scenarios.report.findings.histories import (
    STEADY_S,
    Flags,
    Ints,
    PersonHistory,
    RunHistory,
    settle,
    spans,
)
from peopleboy.scenarios.report.findings.identity_changes import (
    BEFORE_S,
    Outcome,
    find_cause,
    is_return,
    outcome_of,
    steady_due,
)
from peopleboy.scenarios.report.findings.sentences import AFTERWARDS, Cause, seconds, spoken

_DECAY_S = 1.5  # time before a loss over which the confidence is examined
_DECAYED = 0.15  # a larger fall is reported


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """Loss of a track."""

    track: int
    frame: int  # the first frame without the track
    time_s: float  # time of that frame
    owner: str  # the person it was last on; empty for none
    why: str  # visibility of the owner, and course of the confidence
    believed: str  # reason in the tracker's log; empty without one
    afterwards: str
    is_bad: bool  # the person was visible and lost the number


@dataclass(frozen=True, slots=True)
class ShortLosses:
    """Numbers of losses that are not listed individually."""

    breaks: int  # gaps shorter than `STEADY_S`
    ends: int  # ends of tracks that were shown for less than that

    @property
    def words(self) -> str:
        """Sentences about omitted losses; empty without any."""
        short, texts = f"less than {STEADY_S:g} s", []
        if self.breaks:
            texts = [
                f"Losses of {short} ({self.breaks} of them) are omitted: the same number was shown again."
            ]
        if self.ends:
            texts.append(f"Ends of tracks that had been shown for {short} ({self.ends} of them) are omitted.")
        return " ".join([*texts, "events.jsonl lists all of them."]) if texts else ""


@dataclass(frozen=True, slots=True)
class FalseTrack:
    """A track that was never on a person; frames from 1, the last one included."""

    track: int
    first_frame: int
    last_frame: int


def find_losses(history: RunHistory) -> list[Loss]:
    """Find all losses of tracks before the end of the run, in time order.

    Short losses are omitted, and so are tracks that continued under an earlier number.
    """
    losses = [
        _loss(history, number, end, steady)
        for number, steady in _steady_tracks(history).items()
        for end in _ends(history, number, steady > 0)
    ]
    return sorted(losses, key=lambda loss: (loss.frame, loss.track))


def count_short_losses(history: RunHistory) -> ShortLosses:
    """Count the short losses that `find_losses` omits, not tracks that continued under an earlier number."""
    breaks = ends = 0
    for number, steady in _steady_tracks(history).items():
        for end in _ends(history, number, history.shown[number]):
            breaks += int(steady[end - 1] > 0 and steady[end] > 0)
            ends += int(steady[end - 1] == 0)
    return ShortLosses(breaks, ends)


def _ends(history: RunHistory, number: int, shown: Flags) -> Iterator[int]:
    """Yield the indices at which a track ends without continuing under an earlier number."""
    known = {
        line.frame - 1
        for line in history.run.events
        if line.kind == KNOWN and line.other and line.who == f"track {number}"
    }
    for span in spans(shown):
        if span.value and span.end < history.run.frames and span.end not in known:
            yield span.end


def find_false_tracks(history: RunHistory) -> list[FalseTrack]:
    """Find the tracks that were never on a person, the longest first."""
    owned = {int(number) for person in history.people for number in np.unique(person.matched)}
    frames = {number: (np.flatnonzero(shown) + 1).tolist() for number, shown in history.shown.items()}
    false_tracks = [FalseTrack(number, at[0], at[-1]) for number, at in frames.items() if number not in owned]
    return sorted(false_tracks, key=lambda stray: stray.first_frame - stray.last_frame)


def _steady_tracks(history: RunHistory) -> dict[int, Ints]:
    """Return for each confirmed track 1 where it is shown, without short gaps and spans, else 0: (F,)."""
    return {n: settle(shown.astype(np.int64), history.steady) for n, shown in history.shown.items()}


def _loss(history: RunHistory, number: int, end: int, steady: Ints) -> Loss:
    """Explain the loss of a track at index `end`, the first without it."""
    owner = _owner(history.people, number, end)
    again = np.flatnonzero(steady[end:])
    cause, afterwards, is_bad = Cause("no person"), _say("never"), False
    if owner is not None:
        cause = find_cause(history, owner, end - 1, min(end + 1, history.run.frames - 1))
        afterwards, is_bad = _afterwards(history, owner, number, end)
    if len(again):
        shown, is_same = _shown_again(history, number, owner, (end, end + int(again[0])))
        afterwards, is_bad = (shown, False) if is_same else (f"{shown}; {afterwards}", is_bad)
    return Loss(
        track=number,
        frame=end + 1,
        time_s=history.run.time_s(end + 1),
        owner="" if owner is None else owner.name,
        why=f"{cause}{_during_faults(history, end)}; {_confidence(history, number, end)}",
        believed=_belief(history, number, end, owner),
        afterwards=afterwards,
        is_bad=is_bad,
    )


def _shown_again(
    history: RunHistory, number: int, owner: PersonHistory | None, gap: tuple[int, int]
) -> tuple[str, bool]:
    """Describe the person a track was on after a gap, and whether it is the same person as before."""
    end, again = gap
    gap_s = (again - end) / history.run.rate_hz
    break_at = np.flatnonzero(~history.shown[number][again:])
    until = again + int(break_at[0]) if len(break_at) else history.run.frames
    steadily, at_all = (
        _first_on(
            [(p, numbers[again:until] == number) for p, numbers in zip(history.people, column, strict=True)]
        )
        for column in ([p.track for p in history.people], [p.matched for p in history.people])
    )
    first, person = steadily or at_all or (0, None)
    if person is None:
        return _say("again", gap=seconds(gap_s), late="", where="on no person"), owner is None
    late = f", on no person for {seconds(first / history.run.rate_hz)}" if first > history.steady else ""
    is_same = person is owner
    where = "same number" if is_same else f"on {spoken(person.name)}"
    return _say("again", gap=seconds(gap_s), late=late, where=where), is_same or owner is None


def _first_on(lies: Sequence[tuple[PersonHistory, Flags]]) -> tuple[int, PersonHistory] | None:
    """Return the first index and person of a track, from flags (N,) for each person; None without any."""
    first = [(int(at[0]), person) for person, flags in lies if len(at := np.flatnonzero(flags))]
    return min(first, key=lambda one: one[0], default=None)


def _afterwards(history: RunHistory, person: PersonHistory, number: int, end: int) -> tuple[str, bool]:
    """Describe the outcome for a person whose track was lost, and whether it is bad."""
    later = [span for span in spans(person.track[end:]) if span.value]
    name, rate = spoken(person.name), history.run.rate_hz
    if later and later[0].value != number:
        gap, new = later[0].start, later[0].value
        when = f"after {seconds(gap / rate)}" if gap else "at once"
        absence = ", having been out of the image" if is_return(history, person, end, end + gap) else ""
        return _say("renumbered", person=name, when=when, number=new, absence=absence), True
    outcome = outcome_of(history, person)
    if outcome is Outcome.HIDDEN:
        return _say("hidden", person=name), False
    if not (steady_due(history, person) >= end).any():
        return _say("away", person=name), False
    if outcome is Outcome.TRACKED:
        return _say("ended", rest=seconds((history.run.frames - end) / rate)), False
    return _say("lost", person=name), True


def _say(kind: str, **values: object) -> str:
    return AFTERWARDS[kind].format(**values)


def _belief(history: RunHistory, number: int, end: int, own: PersonHistory | None) -> str:
    """Return the tracker's own reason, with the people that the tracks named there were on."""
    about, since = ("lost", f"track {number}"), end + 1 - history.every
    events = (line for line in history.run.events if since < line.frame <= end + 1)
    why = next((line.why for line in events if (line.kind, line.who) == about), "")
    return re.sub(
        r"track (\d+)", lambda found: f"number {found[1]}{_whose(history, int(found[1]), end, own)}", why
    )


def _whose(history: RunHistory, number: int, end: int, own: PersonHistory | None) -> str:
    """Return the person a track was on before an index, in brackets; empty for none."""
    owner = _owner(history.people, number, end)
    if owner is None:
        return ""
    recent = owner.track[max(end - round(BEFORE_S * history.run.rate_hz), 0) : end]
    last = "" if number in recent else "last "
    return f" ({last}on {spoken(owner.name)}{' too' if owner is own else ''})"


def _during_faults(history: RunHistory, end: int) -> str:
    """Return the faults active at index `end`; empty without any."""
    there: dict[str, None] = {}
    for line in history.run.events:
        if line.frame > end + 1:
            break
        if line.kind == "fault starts":
            there[line.who] = None
        elif line.kind == "fault ends":
            there.pop(line.who, None)
    return f", during the fault {' and '.join(there)}" if there else ""


def _confidence(history: RunHistory, number: int, end: int) -> str:
    """Describe the course of the confidence until index `end`."""
    beliefs = history.files.beliefs
    rows = beliefs.filter(np.asarray(beliefs["id"].to_numpy() == number))
    frame, value = rows["frame"].to_numpy() - 1, rows["confidence"].to_numpy()
    recent = value[(frame < end) & (frame >= end - round(_DECAY_S * history.run.rate_hz))]
    if len(recent) == 0 or not np.isfinite(recent).all():
        return "its confidence is not known"
    highest, last = float(recent.max()), float(recent[-1])
    if highest - last < _DECAYED:
        return f"its confidence was still {last:.2f}"
    return f"its confidence fell from {highest:.2f} to {last:.2f}"


def _owner(people: Sequence[PersonHistory], number: int, end: int) -> PersonHistory | None:
    """Return the person that a track was last on before an index."""
    last = {person.id: np.flatnonzero(person.track[:end] == number) for person in people}
    found = [person for person in people if len(last[person.id])]
    return max(found, key=lambda person: int(last[person.id][-1]), default=None)
