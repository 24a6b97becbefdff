"""What came out, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.report.findings.losses_and_swaps import (
    Change,
    Ending,
    Fleeting,
    Loss,
    Stray,
    count_fleeting,
    find_changes,
    find_losses,
    find_strays,
    how_it_ended,
)
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken, times
from peopleboy.scenarios.report.findings.story import RunStory, read_files
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.wording import counted


class RunFindings(RunStory):
    """A run, and what is found out about it."""

    @cached_property
    def changes(self) -> list[Change]:
        """Changes of people's numbers, in time."""
        return find_changes(self)

    @cached_property
    def losses(self) -> list[Loss]:
        """Tracks that were shown no more, in time."""
        return find_losses(self)

    @cached_property
    def fleeting(self) -> Fleeting:
        """Losses that are not told one by one."""
        return count_fleeting(self)

    @cached_property
    def strays(self) -> list[Stray]:
        """Tracks on nobody, the longest first."""
        return find_strays(self)

    @property
    def due(self) -> int:
        """How many people were to be tracked at some time."""
        return sum(bool(person.is_due.any()) for person in self.people)

    def who_ended(self, *endings: Ending) -> list[str]:
        """Name those with whom it ended in one of these ways."""
        return [spoken(person.name) for person in self.people if how_it_ended(self, person) in endings]

    @property
    def lost(self) -> list[Change]:
        """Changes of numbers of people who had been in the image nearly all the time."""
        return [change for change in self.changes if not change.is_return]

    @property
    def returned(self) -> list[Change]:
        """New numbers of people who came back into the image."""
        return [change for change in self.changes if change.is_return]

    @property
    def contacts(self) -> list[LogLine]:
        """When the robot touched whom or what."""
        return [line for line in self.run.events if line.kind == "contact starts"]


def look_into(run: FinishedRun) -> RunFindings:
    """Find out what became of everybody in a run.

    Raises:
        BadInput: a table is missing or spoilt.
    """
    return RunFindings(run=run, files=read_files(run))


def headline(found: RunFindings) -> str:
    """Say of one run who was tracked to the end, and where identities were lost."""
    parts = [_people(found), _identities(found)] if found.due else ["Nobody was there to be found"]
    if found.returned:
        parts.append(_returns(len(found.returned)))
    if found.strays:
        parts.append(f"{counted(len(found.strays), 'track')} on nobody")
    if found.contacts:
        names = listed(list(dict.fromkeys(spoken(line.other) for line in found.contacts)))
        parts.append(f"the robot touched {names}, first at {seconds(found.contacts[0].time_s)}")
    return "; ".join(parts) + "."


def headline_of_many(runs: Sequence[RunFindings]) -> str:
    """Say the same of several runs."""
    due, lost, returned, strays, touches = (
        sum(counts)
        for counts in zip(
            *((r.due, len(r.lost), len(r.returned), len(r.strays), len(r.contacts)) for r in runs),
            strict=True,
        )
    )
    tracked, hidden = (sum(len(r.who_ended(how)) for r in runs) for how in (Ending.TRACKED, Ending.HIDDEN))
    where = counted(sum(bool(r.lost) for r in runs), "run")
    of = f"{counted(len(runs), 'run')}: of {counted(due, 'person', 'people')} {tracked} tracked to the end"
    parts = [
        of + (f", {hidden} hidden until the end" if hidden else ""),
        f"identity lost {times(lost)}, in {where}" if lost else "no identity lost",
        *([_returns(returned)] if returned else []),
        f"{counted(strays, 'track')} on nobody",
        *([f"{counted(touches, 'contact')} of the robot"] if touches else []),
    ]
    return "; ".join(parts) + "."


def _returns(count: int) -> str:
    return f"{times(count)} somebody came back into the image under a new number"


def _people(found: RunFindings) -> str:
    due, hidden = found.due, found.who_ended(Ending.HIDDEN)
    others = found.who_ended(Ending.LOST, Ending.HIDDEN)
    tracked = due - len(others)
    asides = [f"{listed(hidden)} hidden until the end"] if hidden and due > 1 else []
    never = len(found.people) - due
    asides += [f"{never} more never came within 3 to 10 m in sight"] if never else []
    aside = f" ({'; '.join(asides)})" if asides else ""
    if due == 1:
        how = "hidden until" if hidden else "tracked to" if tracked else "not tracked to"
        return f"1 person, {how} the end{aside}"
    which = {0: "none", due: "both" if due == 2 else "all"}.get(tracked, f"all but {listed(others)}")
    return f"{due} people, {which} tracked to the end{aside}"


def _identities(found: RunFindings) -> str:
    if not found.lost:
        return "no identity lost"
    first = found.lost[0]
    when = f"at {seconds(first.time_s)}, when {spoken(first.person)} {first.why}"
    count = len(found.lost)
    return f"identity lost once, {when}" if count == 1 else f"identity lost {times(count)}, first {when}"
