"""Sonars that have gone deaf: all report free space as far as they reach, where there cannot be any."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.percept import Percept


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
        """Tell whether somebody stands so near in front that there must be an echo."""
        return any(
            person.is_visible
            and person.height >= self._config.sure_height
            and abs(person.x) < self._config.ahead
            for person in percept.people
        )
