"""Where people stood: what is told to have vanished there was part of them, or in their hands."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from typing import Final

from peopleboy.tracker.scene_model.scene import Change, Happening

BODY_M: Final = 0.3
"""[m] on the floor from the middle of a person, within which nothing stands by itself."""

BEFORE_S: Final = 2.0
"""[s] before something vanished, in which somebody may have stood there."""

TOLD_S: Final = 60.0
"""[s] from when something vanished until it is told, at most: it may be hidden long before it is missed."""


class Bodies:
    """Remembers where everybody was, as long as something may be told of it."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, tuple[tuple[float, float], ...]]] = deque()

    def look(self, time_s: float, places_m: Iterable[tuple[float, float]]) -> None:
        """Take in where people are at an instant, (x, y) in the frame of the robot's first place."""
        self._places.append((time_s, tuple(places_m)))
        while self._places[0][0] < time_s - TOLD_S - BEFORE_S:
            self._places.popleft()

    def are_at(self, happening: Happening) -> bool:
        """Tell whether what is said now to have vanished was where somebody stood."""
        if happening.change is not Change.VANISHED or happening.from_m is None:
            return False
        place = happening.from_m[:2]
        return any(
            math.dist(place, body) < BODY_M
            for time_s, bodies in self._places
            if happening.time_s - BEFORE_S <= time_s <= happening.time_s
            for body in bodies
        )
