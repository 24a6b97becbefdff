"""What every behaviour has in common."""

from __future__ import annotations

from typing import Protocol

from behaviours.command import Command
from behaviours.sight import Sight


class Behaviour(Protocol):
    """Anything that drives the robot.

    Attributes:
        mode: what it is doing, one word for event log and curves: "search", "follow", "wait", "stand", ...
    """

    @property
    def mode(self) -> str:
        """What it is doing."""
        ...

    def command(self, sight: Sight) -> Command:
        """Give the command for this sight; called once for every image, in order of time."""
        ...
