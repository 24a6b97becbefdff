"""What is found out about a run."""

from __future__ import annotations

from functools import cached_property

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.report.findings.causes import Outcome, outcome_of
from peopleboy.scenarios.report.findings.histories import RunHistory, read_files
from peopleboy.scenarios.report.findings.identity_changes import (
    ChangeKind,
    IdentityChange,
    Transfer,
    find_changes,
    find_transfers,
)
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.findings.track_losses import (
    FalseTrack,
    Loss,
    ShortLosses,
    count_short_losses,
    find_false_tracks,
    find_losses,
)
from peopleboy.scenarios.run_folder.finished_run import FinishedRun


class RunFindings(RunHistory):
    """A run, and what is found out about it."""

    @cached_property
    def changes(self) -> list[IdentityChange]:
        """Changes of people's numbers, in time."""
        return find_changes(self)

    @cached_property
    def transfers(self) -> list[Transfer]:
        """Numbers that went to somebody else, in time."""
        return find_transfers(self)

    @cached_property
    def losses(self) -> list[Loss]:
        """Tracks that were shown no more, in time."""
        return find_losses(self)

    @cached_property
    def short_losses(self) -> ShortLosses:
        """Losses that are not told one by one."""
        return count_short_losses(self)

    @cached_property
    def false_tracks(self) -> list[FalseTrack]:
        """Tracks on nobody, the longest first."""
        return find_false_tracks(self)

    @property
    def due(self) -> int:
        """How many people were to be tracked at some time."""
        return sum(bool(person.is_due.any()) for person in self.people)

    def people_with(self, *endings: Outcome) -> list[str]:
        """Name those with whom it ended in one of these ways."""
        return [spoken(person.name) for person in self.people if outcome_of(self, person) in endings]

    @property
    def lost(self) -> list[IdentityChange]:
        """Changes of people's numbers to fresh ones for good."""
        return [change for change in self.changes if change.turn is ChangeKind.LOST]

    @property
    def reidentified(self) -> list[IdentityChange]:
        """Changes of people's numbers back to their own."""
        return [change for change in self.changes if change.turn is ChangeKind.BACK]

    @property
    def faults(self) -> int:
        """How many identities went wrong."""
        return len(self.transfers) + len(self.lost)

    @property
    def contacts(self) -> list[LogLine]:
        """When the robot touched whom or what."""
        return [line for line in self.run.events if line.kind == "contact starts"]


def analyse_run(run: FinishedRun) -> RunFindings:
    """Find out what became of everybody in a run.

    Raises:
        BadInput: a table is missing or spoilt.
    """
    return RunFindings(run=run, files=read_files(run))
