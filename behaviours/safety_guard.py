"""Safety last: no command reaches the robot without it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.behaviours.behaviour import EMERGENCY_STOP, Behaviour, Command
from peopleboy.behaviours.percept import Percept, Points
from peopleboy.behaviours.safety_limits import SafetyConfig, limit
from peopleboy.behaviours.sonar_echoes import (
    BESIDE_RAD,
    EchoMemory,
    EchoMemoryConfig,
    fill_drop_outs,
    remember,
)

# Sonars that have gone deaf: all report free space as far as they reach, where there cannot be any.


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarFailureConfig:
    """What cannot be.

    Attributes:
        sure_m: [m] an obstacle nearer than this does not get out of all sonars' reach from one frame to the
            next.
        sure_height: [image heights] a person as tall as this, or taller, is heard: 3.1 m for 1.75 m.
        ahead: [half image widths] as far off the middle the person may be for that.
    """

    sure_m: float = 3.5
    sure_height: float = 0.7
    ahead: float = 0.3


class SonarFailure:
    """Notices when every sonar falls silent at once.

    A ring that hears nothing reports one and the same range, its reach, for all sonars. In a large hall that
    is how things are; but not just after an echo from nearby, nor with a person in front.

    Attributes:
        has_heard: whether any sonar has ever heard anything. A ring that has not may be deaf from the start,
            or in the middle of a hall; nobody can tell which.
    """

    def __init__(self, config: SonarFailureConfig | None = None) -> None:
        self._config = SonarFailureConfig() if config is None else config
        self._nearest_m = np.inf
        self._is_deaf = False
        self.has_heard = False

    def listen(self, percept: Percept) -> bool:
        """Tell whether the sonars are deaf; once they are, they stay so until one of them hears something."""
        ranges = percept.sonar_m
        if len(ranges) < 2 or not np.all(ranges == ranges[0]):
            self._nearest_m, self._is_deaf = float(np.min(ranges, initial=np.inf)), False
            self.has_heard = True
            return False
        misses_echo = self._nearest_m < min(self._config.sure_m, float(ranges[0]))
        self._is_deaf = self._is_deaf or misses_echo or self._is_person_near(percept)
        self._nearest_m = np.inf
        return self._is_deaf

    def _is_person_near(self, percept: Percept) -> bool:
        """Return whether a person stands so near in front that there must be an echo."""
        return any(
            person.is_visible
            and person.height >= self._config.sure_height
            and abs(person.x) < self._config.ahead
            for person in percept.people
        )


# As long as something takes from one beam through the gap to the next; people have moved on by then.
PASSING = EchoMemoryConfig(keep_s=2.0, within_m=1.1)


class Guarded:
    """A behaviour under guard: it sees sonars without drop-outs, and what it asks for is limited by them.

    The robot stops at once when images stay out, nobody can tell who is in them, or the sonars have gone
    deaf; the behaviour is not asked then, and goes on afterwards where it was. Until the sonars have heard
    anything at all, it creeps.

    Attributes:
        is_limited: whether the last command was changed.
    """

    def __init__(self, behaviour: Behaviour, config: SafetyConfig | None = None, readings: int = 3) -> None:
        self._behaviour = behaviour
        self._config = SafetyConfig() if config is None else config
        self._recent: deque[Points] = deque(maxlen=readings)
        self._memory = EchoMemory()
        self._passing = EchoMemory()
        self._deafness = SonarFailure()
        self._fault = ""
        self.is_limited = False

    @property
    def mode(self) -> str:
        """The mode of the guarded behaviour, or "stop"."""
        return "stop" if self._fault else self._behaviour.mode

    @property
    def reason(self) -> str:
        """Why the behaviour is in this mode, or what the robot was stopped for."""
        return self._fault or self._behaviour.reason

    @property
    def following(self) -> int | None:
        """Whom the behaviour follows; nobody while the robot is stopped."""
        return None if self._fault else self._behaviour.following

    def command(self, percept: Percept) -> Command:
        """Return the behaviour's command, as far as it is safe."""
        self._fault = self._blindness(percept)
        if self._fault:
            self.is_limited = True
            return EMERGENCY_STOP
        self._recent.append(percept.sonar_m)
        steady = replace(percept, sonar_m=fill_drop_outs(list(self._recent)))
        if self._deafness.listen(steady):
            self._fault, self.is_limited = "the sonars hear nothing any more", True
            return EMERGENCY_STOP
        wanted = self._behaviour.command(steady)
        self._memory = remember(self._memory, steady, EchoMemoryConfig())
        self._passing = remember(self._passing, steady, PASSING, BESIDE_RAD)
        safe = limit(wanted, steady, self._limits(), self._memory.points, self._passing.points)
        self.is_limited = safe != wanted
        return safe

    def _limits(self) -> SafetyConfig:
        """Creep as long as the sonars have heard nothing at all: they may be deaf."""
        config = self._config
        if self._deafness.has_heard:
            return config
        return replace(config, max_linear_m_s=min(config.max_linear_m_s, config.unproven_m_s))

    def _blindness(self, percept: Percept) -> str:
        """Return why the images are of no use; empty if they are."""
        if percept.fault:
            return percept.fault
        is_late = not percept.image_age_s <= self._config.latest_image_s
        return f"no new image for {self._config.latest_image_s:g} s" if is_late else ""
