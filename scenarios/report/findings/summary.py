"""What is found out about a run."""

from __future__ import annotations

from functools import cached_property

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.report.findings.changes import (
    Change,
    Passing,
    Turn,
    find_changes,
    find_passings,
)
from peopleboy.scenarios.report.findings.endings import Ending, how_it_ended
from peopleboy.scenarios.report.findings.losses import (
    Fleeting,
    Loss,
    Stray,
    count_fleeting,
    find_losses,
    find_strays,
)
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.findings.story import RunStory, read_files
from peopleboy.scenarios.run_folder.finished_run import FinishedRun


class RunFindings(RunStory):
    """A run, and what is found out about it."""

    @cached_property
    def changes(self) -> list[Change]:
        """Changes of people's numbers, in time."""
        return find_changes(self)

    @cached_property
    def passings(self) -> list[Passing]:
        """Numbers that went to somebody else, in time."""
        return find_passings(self)

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
        """Changes of people's numbers to fresh ones for good."""
        return [change for change in self.changes if change.turn is Turn.LOST]

    @property
    def known_again(self) -> list[Change]:
        """Changes of people's numbers back to their own."""
        return [change for change in self.changes if change.turn is Turn.BACK]

    @property
    def faults(self) -> int:
        """How many identities went wrong."""
        return len(self.passings) + len(self.lost)

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
