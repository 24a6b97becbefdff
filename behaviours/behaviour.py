"""What every behaviour has in common."""

from __future__ import annotations

import math
from collections.abc import Iterator, Set
from dataclasses import dataclass
from numbers import Integral
from typing import Protocol, runtime_checkable

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.percept import Percept
from peopleboy.own_code import blamed

# What a behaviour asks of the robot: a forward speed and a turn rate.


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A velocity command in the robot's frame.

    Attributes:
        linear_m_s: [m/s] forward speed, negative drives backwards.
        angular_rad_s: [rad/s] turn rate, positive turns left.
        is_emergency: whether the robot is to lose its speeds as fast as it can.

    Raises:
        BadInput: a value is not finite.
    """

    linear_m_s: float
    angular_rad_s: float
    is_emergency: bool = False

    def __post_init__(self) -> None:
        """Refuse what no motor can do."""
        if not (math.isfinite(self.linear_m_s) and math.isfinite(self.angular_rad_s)):
            raise BadInput(
                f"command must be finite, got {self.linear_m_s} m/s and {self.angular_rad_s} rad/s"
            )


STOP = Command(linear_m_s=0.0, angular_rad_s=0.0)
EMERGENCY_STOP = Command(linear_m_s=0.0, angular_rad_s=0.0, is_emergency=True)


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
        """Number of the track that it follows; None if there is none."""
        ...

    def command(self, percept: Percept) -> Command:
        """Return the command for this sight; called once for every image, in order of time."""
        ...


# A behaviour of a user's own, whose every answer is looked at, so that a mistake is reported where it is.


class CheckedBehaviour:
    """Gives what a behaviour gives, if that is what a behaviour may give.

    Args:
        behaviour: whose answers they are.
        who: names it in messages, such as "behaviour 'my_module:MyBehaviour'".
    """

    def __init__(self, behaviour: Behaviour, who: str) -> None:
        self._behaviour = behaviour
        self._who = who
        self._tracks: set[int] = set()  # that there were
        self.mode, self.reason, self.following = behaviour.mode, behaviour.reason, behaviour.following

    def command(self, percept: Percept) -> Command:
        """Let it look, and look at what it wants and says.

        Raises:
            BadInput: that is no command, or mode, reason or following are none.
            OwnCodeFailed: it raised an error.
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
    """Check that an object is a behaviour, and check each of its answers from then on.

    Args:
        behaviour: made by a class from outside.
        name: for messages, such as "behaviour 'my_module:MyBehaviour'".

    Raises:
        BadInput: it is no behaviour.
        OwnCodeFailed: its mode, reason or following raised an error.
    """
    with blamed(name):
        if not isinstance(behaviour, Behaviour):
            raise BadInput("is no behaviour; give it `command(percept)`, `mode`, `reason` and `following`")
        return CheckedBehaviour(behaviour, name)


def _faults(
    command: object, mode: object, reason: object, following: object, tracks: Set[int]
) -> Iterator[str]:
    """Return what is wrong with a behaviour's answer to these tracks, and what would be right."""
    if not isinstance(command, Command):
        yield f"command(percept) must give a Command, got {command!r}"
    if not (isinstance(mode, str) and mode and mode.isprintable()):
        yield f"mode must be a word, got {mode!r}"
    if not (isinstance(reason, str) and reason.isprintable()):
        yield f"reason must be text, on one line, got {reason!r}"
    if not (following is None or (isinstance(following, Integral) and following in tracks)):
        known = ", ".join(map(str, sorted(tracks))) or "none"
        yield f"following must be None or the id of a track that there was, {known}, got {following!r}"
