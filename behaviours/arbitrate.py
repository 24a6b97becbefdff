"""Safety last: no command reaches the robot without it."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from behaviours.behaviour import Behaviour
from behaviours.command import Command
from behaviours.echoes import Points, fill_drop_outs
from behaviours.memory import EchoMemory, MemoryConfig, remember
from behaviours.safety import SafetyConfig, limit
from behaviours.sight import Sight


class Guarded:
    """A behaviour under guard: it sees sonars without drop-outs, and what it asks for is limited by them.

    Attributes:
        is_limited: whether the last command was changed.
    """

    def __init__(self, behaviour: Behaviour, config: SafetyConfig | None = None, readings: int = 3) -> None:
        self._behaviour = behaviour
        self._config = SafetyConfig() if config is None else config
        self._recent: deque[Points] = deque(maxlen=readings)
        self._memory = EchoMemory()
        self.is_limited = False

    @property
    def mode(self) -> str:
        """The mode of the guarded behaviour."""
        return self._behaviour.mode

    def command(self, sight: Sight) -> Command:
        """Give the behaviour's command, as far as it is safe."""
        self._recent.append(sight.sonar_m)
        steady = replace(sight, sonar_m=fill_drop_outs(list(self._recent)))
        wanted = self._behaviour.command(steady)
        self._memory = remember(self._memory, steady, MemoryConfig())
        safe = limit(wanted, steady, self._config, self._memory.points)
        self.is_limited = safe != wanted
        return safe
