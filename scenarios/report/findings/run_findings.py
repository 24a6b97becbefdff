"""Find failures in a run, and choose the headline and the worst moments of its report.

Numbers that passed to another person come first, as the gravest failures.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.report.findings.histories import (
    PersonHistory,
    RunHistory,
    TrackingState,
    read_files,
    spans,
)
from peopleboy.scenarios.report.findings.identity_changes import (
    ChangeKind,
    IdentityChange,
    Outcome,
    Transfer,
    find_changes,
    find_transfers,
    outcome_of,
)
from peopleboy.scenarios.report.findings.sentences import MOMENTS, Finding, listed, seconds, spoken
from peopleboy.scenarios.report.findings.track_losses import (
    FalseTrack,
    Loss,
    ShortLosses,
    count_short_losses,
    find_false_tracks,
    find_losses,
)
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.truth.scenes import SEEN
from peopleboy.wording import counted


class RunFindings(RunHistory):
    """A run and its findings."""

    @cached_property
    def changes(self) -> list[IdentityChange]:
        """Changes of people's numbers, in time order."""
        return find_changes(self)

    @cached_property
    def transfers(self) -> list[Transfer]:
        """Numbers that passed to another person, in time order."""
        return find_transfers(self)

    @cached_property
    def losses(self) -> list[Loss]:
        """Losses of tracks, in time order."""
        return find_losses(self)

    @cached_property
    def short_losses(self) -> ShortLosses:
        """Short losses, which are not listed individually."""
        return count_short_losses(self)

    @cached_property
    def false_tracks(self) -> list[FalseTrack]:
        """False tracks, the longest first."""
        return find_false_tracks(self)

    @property
    def due(self) -> int:
        """Number of people who were due to be tracked at some time."""
        return sum(bool(person.is_due.any()) for person in self.people)

    def people_with(self, *endings: Outcome) -> list[str]:
        """Return the names of people with one of these outcomes."""
        return [spoken(person.name) for person in self.people if outcome_of(self, person) in endings]

    @property
    def lost(self) -> list[IdentityChange]:
        """Changes of people's numbers to new numbers that stayed."""
        return [change for change in self.changes if change.turn is ChangeKind.LOST]

    @property
    def reidentified(self) -> list[IdentityChange]:
        """Changes of people's numbers back to their own ones."""
        return [change for change in self.changes if change.turn is ChangeKind.BACK]

    @property
    def faults(self) -> int:
        """Number of identity errors."""
        return len(self.transfers) + len(self.lost)

    @property
    def target(self) -> str:
        """Name of the person to follow: the scenario's first; empty if no person was ever present."""
        return self.people[0].name if self.people else ""

    @property
    def task_end(self) -> str:
        """How following ended: "never found", "lost for good" or "followed"; empty without that task."""
        following = self.run.metrics.get("following")
        if not following or not self.people:
            return ""
        if not following.get("found"):
            return "never found"
        is_kept = following.get("followed_to_end") and self.run.about.ended != "lost"
        return "followed" if is_kept else "lost for good"

    @property
    def lost_at_s(self) -> float:
        """Time of the last frame in which the person to follow had a track."""
        tracked = np.flatnonzero(self.people[0].matched) if self.people else np.zeros(0, np.int64)
        return self.run.time_s(int(tracked[-1]) + 1) if len(tracked) else 0.0

    @property
    def contacts(self) -> list[LogLine]:
        """Events in which the robot touches a person or an object."""
        return [line for line in self.run.events if line.kind == "contact starts"]


def analyse_run(run: FinishedRun) -> RunFindings:
    """Analyse the tracking of all people in a run.

    Raises:
        BadInput: a table is missing or unreadable.
    """
    return RunFindings(run=run, files=read_files(run))


_APART_S = 1.0  # moments of one person closer than this are merged


def headline(runs: Sequence[RunFindings]) -> str:
    """Summarise people tracked to the end and identity errors, in one run or in several."""
    is_of_many = len(runs) > 1
    findings = [*_task_findings(runs), *_findings(runs)]
    text = "; ".join(finding.sentence(is_of_many_runs=is_of_many) for finding in findings)
    return f"{counted(len(runs), 'run')}: {text}." if is_of_many else f"{text[:1].upper()}{text[1:]}."


def _task_findings(runs: Sequence[RunFindings]) -> Iterator[Finding]:
    """Yield how the robot fared with its task: the person that it followed, the corridor, and contacts."""
    goals = [goal for run in runs if (goal := run.run.metrics.get("goal"))]
    for kind, is_reached in (("reached", True), ("not reached", False)):
        some = [goal for goal in goals if goal["reached"] == is_reached]
        if some:
            values = {
                "time": seconds(some[0]["time_s"] or 0.0),
                "distance": f"{some[0]['nearest_m']:.1f}\u00a0m",
            }
            yield Finding(kind, len(some), values | {"runs": counted(len(some), "run")})
    for kind in ("never found", "lost for good", "followed"):
        found = [run for run in runs if run.task_end == kind]
        if found:
            values = {"person": spoken(found[0].target), "time": seconds(found[0].lost_at_s)}
            yield Finding(kind, len(found), values | {"runs": counted(len(found), "run")})
    ways_m = [way_m for run in runs if (way_m := run.run.metrics.get("corridor", {}).get("way_m"))]
    if ways_m:
        yield Finding("drove", len(ways_m), {"distance": f"{sum(ways_m):.1f}\u00a0m"})
    contacts = [line for run in runs for line in run.contacts]
    if contacts:
        names = listed(list(dict.fromkeys(spoken(line.other) for line in contacts)))
        values = {"names": names, "time": seconds(contacts[0].time_s)}
        yield Finding("collided", len(contacts), values | {"contacts": counted(len(contacts), "contact")})


def _findings(runs: Sequence[RunFindings]) -> Iterator[Finding]:
    """Yield the findings of tracking, the gravest first."""
    transfers = [one for run in runs for one in run.transfers]
    if transfers:
        one = transfers[0]
        values = {"number": one.number, "person": spoken(one.giver), "other": spoken(one.receiver)}
        when = {"time": seconds(one.time_s), "cause": one.cause, "runs": _runs_with(runs, "transfers")}
        yield Finding("transfer", len(transfers), values | when)
    due = sum(run.due for run in runs)
    yield Finding("people", due, _people(runs, due)) if due else Finding("no people", 1)
    lost = [change for run in runs for change in run.lost]
    if lost:
        values = {"time": seconds(lost[0].time_s), "person": spoken(lost[0].person), "cause": lost[0].cause}
        yield Finding("lost", len(lost), values | {"runs": _runs_with(runs, "lost")})
    elif due and not transfers:
        yield Finding("none lost", 1)
    known = [change for run in runs for change in run.reidentified]
    if known:
        first, longest_s = known[0], max(change.reidentified_after_s for change in known)
        values = {"person": spoken(first.person), "old": first.old, "new": first.new}
        times = {"duration": seconds(first.reidentified_after_s), "longest": seconds(longest_s)}
        yield Finding("reidentified", len(known), values | times)
    count = sum(len(run.false_tracks) for run in runs)
    if count or len(runs) > 1:
        yield Finding("false tracks", max(count, 1), {"tracks": counted(count, "false track")})


def _runs_with(runs: Sequence[RunFindings], what: str) -> str:
    return counted(sum(bool(getattr(run, what)) for run in runs), "run")


def _people(runs: Sequence[RunFindings], due: int) -> dict[str, object]:
    """Return the values of the sentence about people: numbers and names tracked to the end or not."""
    hidden = [name for run in runs for name in run.people_with(Outcome.HIDDEN)]
    others = [name for run in runs for name in run.people_with(Outcome.LOST, Outcome.HIDDEN)]
    tracked, first = due - len(others), runs[0]
    asides = [f"{listed(hidden)} hidden until the end"] if hidden and due > 1 else []
    never = len(first.people) - first.due
    if never:
        nearest_m, farthest_m = first.counted_m
        asides.append(f"{never} more never visible at {nearest_m:g} to {farthest_m:g} m")
    all_of_them = "both" if due == 2 else "all"
    return {
        "aside": f" ({'; '.join(asides)})" if asides else "",
        "how": "hidden until" if hidden else "tracked to" if tracked else "not tracked to",
        "which": {0: "none", due: all_of_them}.get(tracked, f"all but {listed(others)}"),
        "people": counted(due, "person", "people"),
        "tracked": tracked,
        "hidden": f", {len(hidden)} hidden until the end" if hidden else "",
    }


class BadMoment(NamedTuple):
    """A failure and its time."""

    # Order: a number on another person is worst, then a lost identity, contacts, false tracks, ...
    badness: float
    frames: tuple[int, ...]  # one or two frames to show, from 1
    title: str
    text: str
    subject: str  # the person or object concerned


def worst_moments(found: RunFindings, count: int) -> list[BadMoment]:
    """Return at most `count` moments in time order; without failures, the boxes that fit worst."""
    moments = [*_identity_moments(found), *_contacts(found), *_false_tracks(found)]
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
    return one.subject == other.subject and gap < _APART_S


def _moment(kind: str, badness: float, frames: tuple[int, ...], subject: str, **values: Any) -> BadMoment:
    """Return a moment of a kind of `MOMENTS`."""
    named = {"person": spoken(subject)} | values
    title, text = (template.format(**named) for template in MOMENTS[kind])
    return BadMoment(badness, frames, title, text, subject)


def _identity_moments(found: RunFindings) -> Iterator[BadMoment]:
    for one in found.transfers:
        names = {"person": spoken(one.giver), "other": spoken(one.receiver)}
        frames = (one.last_frame, one.first_frame)
        yield _moment("transfer", 200.0, frames, one.receiver, number=one.number, cause=one.cause, **names)
    for change in found.lost:
        frames, numbers = (change.last_frame, change.first_frame), {"old": change.old, "new": change.new}
        badness = 40.0 if change.is_return else 100.0
        yield _moment("lost", badness, frames, change.person, cause=change.cause, **numbers)


def _contacts(found: RunFindings) -> Iterator[BadMoment]:
    for line in found.contacts:
        yield _moment("contact", 90.0, (line.frame,), line.other)


def _false_tracks(found: RunFindings) -> Iterator[BadMoment]:
    for one in found.false_tracks:
        lasts_s = (one.last_frame - one.first_frame + 1) / found.run.rate_hz
        frames, values = ((one.first_frame + one.last_frame) // 2,), {"duration": seconds(lasts_s)}
        badness = min(lasts_s * 10.0, 80.0)
        yield _moment("false track", badness, frames, f"track {one.track}", number=one.track, **values)


def _gaps(found: RunFindings, person: PersonHistory) -> Iterator[BadMoment]:
    """Yield times at which a visible person had no box."""
    for span in spans(person.state):
        seen = person.visible[span.start : span.end]
        well = np.flatnonzero(seen > SEEN).tolist()
        if span.value not in (TrackingState.MISSED, TrackingState.ADRIFT) or not well:
            continue
        lasts_s, is_missed = span.length / found.run.rate_hz, span.value == TrackingState.MISSED
        kind, badness = ("missed", 8.0) if is_missed else ("adrift", 4.0)
        frames = (span.start + well[len(well) // 2] + 1,)
        values = {"duration": seconds(lasts_s), "share": f"{seen.max():.0%}"}
        yield _moment(kind, min(lasts_s * badness, 50.0), frames, person.name, **values)


def _worst_fit(person: PersonHistory) -> BadMoment:
    at = int(np.nanargmin(person.iou))
    iou, share = float(person.iou[at]), f"{person.visible[at]:.0%}"
    return _moment("worst fit", 1.0 - iou, (at + 1,), person.name, iou=f"{iou:.0%}", share=share)
