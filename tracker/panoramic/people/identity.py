"""Who is who: newcomers who were here before, and people who have been taken for each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from peopleboy.tracker.panoramic.people.panoramic_config import IdentityConfig
from peopleboy.tracker.panoramic.people.panoramic_person import PanoramicPerson


class Register:
    """Hands out numbers, and remembers the looks of those who are gone.

    Args:
        config: settings.
    """

    def __init__(self, config: IdentityConfig) -> None:
        self._config = config
        self._gone: tuple[PanoramicPerson, ...] = ()
        self._newest = 0

    def leave(self, persons: Sequence[PanoramicPerson], time_s: float) -> None:
        """Remember people who are gone, and forget who has been for too long."""
        known = (*self._gone, *(person for person in persons if person.id))
        self._gone = tuple(one for one in known if time_s - one.seen_s < self._config.forget_s)

    def named(self, person: PanoramicPerson, time_s: float) -> PanoramicPerson:
        """Give somebody a number: the one that it had before, or a new one."""
        known = self.recognised(person, time_s)
        if known is None:
            self._newest += 1
            return replace(person, id=self._newest, strange_s=0.0)
        self._gone = tuple(one for one in self._gone if one is not known)
        return person.known_as(known)

    def put_right(self, persons: Sequence[PanoramicPerson], time_s: float) -> tuple[PanoramicPerson, ...]:
        """Give people who have looked like somebody else for long the number of that one, or a new one."""
        strangers = [one for one in persons if one.id and one.strange_s >= self._config.strange_s]
        if not strangers:
            return tuple(persons)
        # Their memory stays with the number, whose owner has walked on ever since they look strange.
        # What they look like now is all that is known of themselves.
        self.leave([replace(one, seen_s=time_s - one.strange_s) for one in strangers], time_s)
        right = {
            one.id: self.named(replace(one, looks=one.newest, born_s=time_s), time_s) for one in strangers
        }
        return tuple(right[one.id] if one in strangers else one for one in persons)

    def recognised(self, person: PanoramicPerson, time_s: float) -> PanoramicPerson | None:
        """Find who of those who are gone this may be, by looks and by the way; None for nobody."""
        best, least = None, self._config.alike
        for one in self._gone:
            way = float(np.linalg.norm(one.motion.place_m - person.motion.place_m))
            unlikeness = one.looks.unlikeness(person.looks)
            reach = self._config.reach_m + self._config.fastest_m_s * (time_s - one.seen_s)
            if way < reach and unlikeness < least:
                best, least = one, unlikeness
        return best
