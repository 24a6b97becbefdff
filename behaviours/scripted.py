"""Behaviours that ignore all sensors: predefined commands, and standing still."""

import bisect
import math
from collections.abc import Sequence

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.percept import Percept


class Scripted:
    """Behaviour with commands by time.

    Raises:
        BadInput: the times are not finite or not increasing.
    """

    mode = "scripted"
    reason = ""
    following = None

    def __init__(self, script: Sequence[tuple[float, Command]]) -> None:
        self._from_s = [from_s for from_s, _ in script]
        self._commands = [command for _, command in script]
        pairs = zip(self._from_s, self._from_s[1:], strict=False)
        if not (all(map(math.isfinite, self._from_s)) and all(a < b for a, b in pairs)):
            raise BadInput(f"script: times must be finite and increasing, got {self._from_s}")

    def command(self, percept: Percept) -> Command:
        """Return the current command; before the first one, the stop command."""
        index = bisect.bisect_right(self._from_s, percept.time_s)
        return self._commands[index - 1] if index else STOP


class Stand:
    """Behaviour of a standing robot."""

    mode = "stand"
    reason = ""
    following = None

    def command(self, percept: Percept) -> Command:  # noqa: ARG002
        """Return the stop command."""
        return STOP
