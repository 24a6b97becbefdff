"""The interface of behaviours."""

import math
from collections.abc import Iterator, Set
from dataclasses import dataclass
from numbers import Integral
from typing import Protocol, runtime_checkable

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.percept import Percept
from peopleboy.own_code import blamed

# Output of a behaviour: a forward speed and a turn rate.


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A velocity command in the robot frame.

    Attributes:
        linear_m_s: [m/s] forward speed, negative drives backwards.
        angular_rad_s: [rad/s] turn rate, positive turns left.
        is_emergency: whether the robot must stop as fast as possible.

    Raises:
        BadInput: a value is not finite.
    """

    linear_m_s: float
    angular_rad_s: float
    is_emergency: bool = False

    def __post_init__(self) -> None:
        """Check that values are finite."""
        if not (math.isfinite(self.linear_m_s) and math.isfinite(self.angular_rad_s)):
            raise BadInput(
                f"command must be finite, got {self.linear_m_s} m/s and {self.angular_rad_s} rad/s"
            )


STOP = Command(linear_m_s=0.0, angular_rad_s=0.0)
EMERGENCY_STOP = Command(linear_m_s=0.0, angular_rad_s=0.0, is_emergency=True)


@runtime_checkable
class Behaviour(Protocol):
    """A controller of the robot.

    Attributes:
        mode: current activity, as one word for the event log and plots, such as "search" or "follow".
        reason: reason for the mode, for the event log; may be empty.
        following: id of the followed track; None if there is none.
    """

    @property
    def mode(self) -> str:
        """Current activity."""
        ...

    @property
    def reason(self) -> str:
        """Reason for the mode."""
        ...

    @property
    def following(self) -> int | None:
        """Id of the followed track; None if there is none."""
        ...

    def command(self, percept: Percept) -> Command:
        """Return the command for a percept; called once per image, in order of time."""
        ...


# A wrapper that validates a user's behaviour, so that errors are reported where they occur.


class CheckedBehaviour:
    """Wrapper that validates a behaviour's output.

    Args:
        behaviour: the wrapped behaviour.
        who: name for messages, such as "behaviour 'my_module:MyBehaviour'".
    """

    def __init__(self, behaviour: Behaviour, who: str) -> None:
        self._behaviour = behaviour
        self._who = who
        self._tracks: set[int] = set()  # ids of all tracks so far
        self.mode, self.reason, self.following = behaviour.mode, behaviour.reason, behaviour.following

    def command(self, percept: Percept) -> Command:
        """Process a percept, and validate command, mode, reason and following.

        Raises:
            BadInput: one of them is invalid.
            OwnCodeFailed: the behaviour raised an error.
        """
        with blamed(self._who):
            command = self._behaviour.command(percept)
            self.mode, self.reason = self._behaviour.mode, self._behaviour.reason
            self.following = self._behaviour.following
            self._tracks.update(person.id for person in percept.people)
            for fault in _faults(command, self.mode, self.reason, self.following, self._tracks):
                raise BadInput(fault)
            return command


def checked_behaviour(behaviour: object, name: str) -> CheckedBehaviour:
    """Check that an object is a behaviour, and wrap it so that its outputs are validated.

    Args:
        behaviour: instance of a user's class.
        name: for messages, such as "behaviour 'my_module:MyBehaviour'".

    Raises:
        BadInput: the object is not a behaviour.
        OwnCodeFailed: its mode, reason or following raised an error.
    """
    with blamed(name):
        if not isinstance(behaviour, Behaviour):
            raise BadInput("is not a behaviour; it needs `command(percept)`, `mode`, `reason`, `following`")
        return CheckedBehaviour(behaviour, name)


def _faults(
    command: object, mode: object, reason: object, following: object, tracks: Set[int]
) -> Iterator[str]:
    """Yield errors in a behaviour's output for these tracks, with the valid values."""
    if not isinstance(command, Command):
        yield f"command(percept) must return a Command, got {command!r}"
    if not (isinstance(mode, str) and mode and mode.isprintable()):
        yield f"mode must be a word, got {mode!r}"
    if not (isinstance(reason, str) and reason.isprintable()):
        yield f"reason must be text on one line, got {reason!r}"
    if not (following is None or (isinstance(following, Integral) and following in tracks)):
        known = ", ".join(map(str, sorted(tracks))) or "none"
        yield f"following must be None or the id of a track that there was, {known}, got {following!r}"
