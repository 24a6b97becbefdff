"""Who is who after a while: who turns up again, and who has been taken for somebody else."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.person import Person
from peopleboy.tracker.fusion.told import Told
from peopleboy.tracker.rgbd.people.looks import similarity

_OWN: Final = 1.0  # what it counts that a track was the person's before
_UNLIKE: Final = 5.0  # what entirely other looks count
_GRACE_S: Final = 1.0
_DOUBTED: Final = 2  # frames in a row in which somebody looked otherwise who may be taken for another


@dataclass(frozen=True, slots=True)
class Recognition:
    """Compares those who are here with those who were.

    Attributes:
        config: settings.
        time_s: [s] now.
    """

    config: FusionConfig
    time_s: float

    def returned(
        self, told: Told, people: Sequence[Person], own: Callable[[Person], int | None]
    ) -> Person | None:
        """Find who of those who are not seen turns up again; None for nobody.

        Args:
            told: a track of nobody who is seen.
            people: everybody who is known.
            own: gives the id of a person's track of before by the same tracker.
        """
        away = {one.id: self._strangeness(one, told, own(one)) for one in people if not one.is_seen}
        nearest = min(away, key=lambda number: away[number], default=None)
        if nearest is None or math.isinf(away[nearest]):
            return None
        return next(one for one in people if one.id == nearest)

    def put_right(self, people: Sequence[Person]) -> list[Person]:
        """Give people who look like another that one's number.

        Who has looked otherwise for a while changes with somebody of its looks who is away, or looks
        otherwise, too. A new person may turn out to be one who is away.
        """
        known = {one.id: one for one in people}
        for number in list(known):
            one = known.get(number)
            other = None if one is None else self._other(one, list(known.values()))
            if one is not None and other is not None:
                known[other.id] = one.named(other)
                known[one.id] = other.named(one)
                if self._is_young(one) and not other.is_seen:
                    del known[one.id]
        return list(known.values())

    def _strangeness(self, person: Person, told: Told, own: int | None) -> float:
        """Rate how unlikely it is that somebody turns up here; infinite if it is out of the question."""
        config, late_s = self.config, self.time_s - person.seen_s
        slack_m = 2.0 * math.sqrt(float(np.linalg.eigvalsh(told.error_m2)[-1]))
        reach_m = config.reach_m + config.fastest_m_s * late_s + slack_m
        found = math.dist(told.place_m, person.motion.place_m) / reach_m
        if found > 1.0:
            return math.inf
        if told.looks is not None and person.looks is not None:
            alike = similarity(person.looks, told.looks)
            found += _UNLIKE * (1.0 - alike) if alike >= config.least_alike else math.inf
        elif told.id != own and late_s > config.lookless_s:
            return math.inf
        if told.tall_m is not None and person.depth is not None:
            off = abs(told.tall_m - person.tall_m) / config.tallest_off_m
            found += off if off <= 1.0 else math.inf
        return found - (_OWN if told.id == own else 0.0)

    def _is_young(self, person: Person) -> bool:
        return self.time_s - person.born_s < self.config.young_s

    def _other(self, person: Person, people: Sequence[Person]) -> Person | None:
        """Find whose looks somebody has who looks otherwise, or is new."""
        told, is_strange = person.deep, person.strange >= self.config.strange_frames
        if told is None or told.looks is None or not told.is_clear:
            return None
        if not is_strange and not self._is_young(person):
            return None
        alike = {
            other.id: similarity(other.looks, told.looks)
            for other in people
            if other.looks is not None and self._may_be(person, other, told, is_strange=is_strange)
        }
        best = max(alike, key=lambda number: alike[number], default=None)
        if best is None or alike[best] <= (
            self.config.least_alike if is_strange else self.config.young_alike
        ):
            return None
        return next(other for other in people if other.id == best)

    def _may_be(self, person: Person, other: Person, told: Told, *, is_strange: bool) -> bool:
        if other.id == person.id or told.tall_m is None:
            return False
        if abs(told.tall_m - other.tall_m) >= self.config.tallest_off_m:
            return False
        if other.is_seen:
            return is_strange and other.strange >= _DOUBTED
        if not is_strange and other.born_s > person.born_s - _GRACE_S:
            return False
        late_s = self.time_s - other.seen_s + _GRACE_S
        reach_m = self.config.reach_m + self.config.fastest_m_s * late_s
        return math.dist(person.motion.place_m, other.motion.place_m) <= reach_m
