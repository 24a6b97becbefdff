"""What every behaviour has in common."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from peopleboy.behaviours.command import Command
from peopleboy.behaviours.percept import Percept


@runtime_checkable
class Behaviour(Protocol):
    """Anything that drives the robot.

    Attributes:
        mode: what it is doing, one word for event log and curves: "search", "follow", "wait", "stand", ...
        reason: why it is doing that, for the event log; empty where there is nothing to decide.
        following: number of the track that it follows; None if it follows nobody.
    """

    @property
    def mode(self) -> str:
        """What it is doing."""
        ...

    @property
    def reason(self) -> str:
        """Why it is doing that."""
        ...

    @property
    def following(self) -> int | None:
        """Whom it follows."""
        ...

    def command(self, percept: Percept) -> Command:
        """Give the command for this sight; called once for every image, in order of time."""
        ...
