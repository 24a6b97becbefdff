"""Safety guard: validates and limits every command before it reaches the robot."""

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.behaviours.behaviour import EMERGENCY_STOP, Behaviour, Command
from peopleboy.behaviours.percept import Percept, Points
from peopleboy.behaviours.safety_limits import SafetyConfig, limit, safe_speed
from peopleboy.behaviours.sonar_echoes import (
    BESIDE_RAD,
    EchoMemory,
    EchoMemoryConfig,
    fill_drop_outs,
    remember,
)

# Detection of sonar failure: all sonars report full range although there must be an obstacle.


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarFailureConfig:
    """Conditions under which a ring of sonars without echoes has failed.

    Attributes:
        sure_m: [m] an obstacle nearer than this cannot leave the range of all sonars between two frames.
        sure_height: [image heights] a person of at least this height is in range: 3.1 m for 1.75 m.
        ahead: [half image widths] greatest distance of that person from the middle.
        moving_m_s: [m/s] a robot that drives faster cannot read the same ranges twice.
    """

    sure_m: float = 3.5
    sure_height: float = 0.7
    ahead: float = 0.3
    moving_m_s: float = 0.05


class SonarFailure:
    """Detector of a failure of all sonars.

    A ring without echoes reports its full range for all sonars. That is normal in a large hall, but not
    directly after a near echo, nor with a person in front, nor for longer than the robot's motion explains:
    the last echoes prove the floor free up to the nearest of them, and the robot can drive so far only
    before another one is due. A ring that repeats its readings while the robot moves is stuck, because
    readings have noise.

    Attributes:
        has_heard: whether there has been an echo. Before the first echo, a failed ring cannot be
            distinguished from one in the middle of a hall.
        free_m: [m] radius about the robot's origin within which the last echoes prove the floor free; inf
            while there are echoes.
    """

    def __init__(self, config: SonarFailureConfig | None = None) -> None:
        self._config = SonarFailureConfig() if config is None else config
        self._nearest_m = np.inf
        self._driven_m = 0.0
        self._is_silent = self._is_deaf = self._is_stuck = False
        self._time_s = np.nan
        self._raw: Points = np.zeros(0)
        self.has_heard = False
        self.free_m = np.inf

    def listen(self, percept: Percept, raw: Points) -> str:
        """Return why the sonars have failed; empty if they work. No echo is a failure until there is one.

        Args:
            percept: percept with ranges without drop-outs.
            raw: (N,) [m] ranges as they were read.
        """
        ranges, step_s = percept.sonar_m, percept.time_s - self._time_s
        is_repeated = bool(np.any(raw != raw[:1])) and np.array_equal(raw, self._raw)
        self._time_s, self._raw = percept.time_s, raw
        if len(ranges) < 2 or not np.all(ranges == ranges[0]):
            self._nearest_m, self.free_m, self._driven_m = float(np.min(ranges, initial=np.inf)), np.inf, 0.0
            self._is_silent = self._is_deaf = False
            self.has_heard = True
            # A stuck ring is so until its readings change, also when the robot has stopped.
            is_moving = abs(percept.linear_m_s) > self._config.moving_m_s
            self._is_stuck = is_repeated and (self._is_stuck or is_moving)
            return "the sonars have failed: they repeat their readings" if self._is_stuck else ""
        reach_m = float(ranges[0])
        misses_echo = not self._is_silent and self._nearest_m < min(self._config.sure_m, reach_m)
        self._is_silent = True
        self._is_deaf = self._is_deaf or misses_echo or self._is_person_near(percept)
        if step_s > 0.0:
            self._driven_m += abs(percept.linear_m_s) * step_s
        self.free_m = min(self._nearest_m, reach_m) - self._driven_m
        return "the sonars have failed: no echoes" if self._is_deaf else ""

    def _is_person_near(self, percept: Percept) -> bool:
        """Return whether a person in front is so near that there must be an echo."""
        return any(
            person.is_visible
            and person.height >= self._config.sure_height
            and abs(person.x) < self._config.ahead
            for person in percept.people
        )


# Time in which an object passes from one beam through the gap to the next; people move on within it.
PASSING = EchoMemoryConfig(keep_s=2.0, within_m=1.1)


class Guarded:
    """Wrapper that passes sonar ranges without drop-outs to a behaviour, and limits its commands by them.

    A behaviour with a goal also gets that, in percepts that have none.

    The robot stops at once when images are missing, people cannot be detected in them, or the sonars have
    failed; the behaviour is not called then, and resumes afterwards: after missing images when several came
    in a row.

    Without echoes the robot drives only as fast and as far as it can stop within the floor that the last
    echoes proved free. Until the first echo, it creeps.

    Attributes:
        is_limited: whether the last command was changed.
    """

    def __init__(
        self,
        behaviour: Behaviour,
        config: SafetyConfig | None = None,
        readings: int = 3,
        goal_m: tuple[float, float] | None = None,
    ) -> None:
        self._behaviour = behaviour
        self._goal_m = goal_m
        self._config = SafetyConfig() if config is None else config
        self._recent: deque[Points] = deque(maxlen=readings)
        self._memory = EchoMemory()
        self._passing = EchoMemory()
        self._deafness = SonarFailure()
        self._fault = ""
        self._images_due = 0
        self.is_limited = False

    @property
    def mode(self) -> str:
        """Mode of the wrapped behaviour, or "stop"."""
        return "stop" if self._fault else self._behaviour.mode

    @property
    def reason(self) -> str:
        """Reason for the mode, or for the stop."""
        return self._fault or self._behaviour.reason

    @property
    def following(self) -> int | None:
        """Id of the followed track; None while the robot is stopped."""
        return None if self._fault else self._behaviour.following

    def command(self, percept: Percept) -> Command:
        """Return the behaviour's command, limited to a safe one."""
        self._fault = self._blindness(percept)
        if self._fault:
            self.is_limited = True
            return EMERGENCY_STOP
        self._recent.append(percept.sonar_m)
        goal_m = self._goal_m if percept.goal_m is None else percept.goal_m
        steady = replace(percept, sonar_m=fill_drop_outs(list(self._recent)), goal_m=goal_m)
        self._fault = self._deafness.listen(steady, percept.sonar_m)
        room_m = self._room_m()
        if not self._fault and room_m <= self._config.last_m:
            self._fault = "the sonars have failed: no echoes over as far as the last ones proved free"
        if self._fault:
            self.is_limited = True
            return EMERGENCY_STOP
        wanted = self._behaviour.command(steady)
        self._memory = remember(self._memory, steady, EchoMemoryConfig())
        self._passing = remember(self._passing, steady, PASSING, BESIDE_RAD)
        safe = limit(wanted, steady, self._limits(room_m), self._memory.points, self._passing.points)
        self.is_limited = safe != wanted
        return safe

    def _room_m(self) -> float:
        """Return how far [m] the robot can drive on floor that the last echoes proved free."""
        hull_m = max(self._config.front_m, self._config.rear_m)
        return self._deafness.free_m - hull_m - self._config.margin_m

    def _limits(self, room_m: float) -> SafetyConfig:
        """Bound the speed so that the robot stops within room_m [m]; creep before the first echo."""
        config = self._config
        highest = safe_speed(room_m, config) if math.isfinite(room_m) else config.max_linear_m_s
        if not self._deafness.has_heard:
            highest = min(highest, config.unproven_m_s)
        return replace(config, max_linear_m_s=highest)

    def _blindness(self, percept: Percept) -> str:
        """Return why the images are unusable, or were so lately; empty if they are usable."""
        config = self._config
        is_late = not percept.image_age_s <= config.latest_image_s
        if percept.fault or is_late:
            self._images_due = config.resume_images
            return percept.fault or f"no new image for {config.latest_image_s:g} s"
        self._images_due = max(self._images_due - 1, 0)
        return f"waiting for {config.resume_images} new images in a row" if self._images_due else ""
