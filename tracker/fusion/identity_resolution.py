"""Identity resolution: re-identification of absent people, and repair of identity swaps."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from peopleboy.geometry.small_matrices import principal_axes
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.fusion.fused_person import FusedPerson, SensorTrack
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.track_to_track import cheapest
from peopleboy.tracker.rgbd.observation_model import similarity

_OWN: Final = 1.0  # discount for the person's previous track
_UNLIKE: Final = 5.0  # cost of an entirely different appearance
_GRACE_S: Final = 1.0
_DOUBTED_S: Final = 0.25  # after which a person without a match of appearance may be elsewhere
_DOUBTED: Final = 2  # consecutive frames with a different appearance after which a person may be another one


@dataclass(frozen=True, slots=True)
class IdentityResolution:
    """Compares current people with absent ones.

    Attributes:
        config: settings.
        time_s: [s] current time.
        is_lit: whether there is light for colours.
    """

    config: FusionConfig
    time_s: float
    is_lit: bool

    def settled(self, people: Sequence[FusedPerson], numbers: Iterator[int]) -> list[FusedPerson]:
        """Number new people as soon as their identity is unambiguous, or after a time limit.

        All new people are compared with all absent ones at once. A new person who matches a seemingly visible
        person without a recent match of appearance takes over the number.

        Args:
            people: all; new people have negative ids.
            numbers: for people who were never seen before.
        """
        guests = [one for one in people if one.is_guest]
        away = [one for one in people if not one.is_guest and self._is_away(one)]
        costs = np.array([[self._strangeness(one, guest) for one in away] for guest in guests])
        costs = costs.reshape(len(guests), len(away))
        found = cheapest(costs)
        known = {one.id: one for one in people}
        for k, guest in enumerate(guests):
            if not guest.is_seen or not self._is_plain(guest, costs[k], found.get(k)):
                continue
            del known[guest.id]
            named = guest.named(away[found[k]]) if k in found else replace(guest, id=next(numbers))
            known[named.id] = named
        return list(known.values())

    def _is_away(self, person: FusedPerson) -> bool:
        """Return whether a person may be elsewhere: not seen, or without a recent match of appearance."""
        is_doubted = (
            self.is_lit and person.appearance is not None and self.time_s - person.appearance_s > _DOUBTED_S
        )
        return not person.is_seen or is_doubted

    def _is_plain(self, guest: FusedPerson, costs: Floats, chosen: int | None) -> bool:
        """Return whether it is time to decide a person's identity.

        Args:
            guest: the new person.
            costs: (N,) cost of each absent person.
            chosen: index of the best candidate; None if there is none.
        """
        is_late = self.time_s - guest.born_s >= self.config.settled_s
        if not self.is_lit or is_late or len(costs) == 0:
            return True
        if guest.appearance is None:
            return False
        if chosen is None:
            return bool(np.isinf(costs).all())
        others = np.delete(costs, chosen)
        return bool((others - costs[chosen] >= self.config.plain).all())

    def resolve_swaps(self, people: Sequence[FusedPerson]) -> list[FusedPerson]:
        """Resolve identity swaps: give people the number of the person they resemble.

        A person with a different appearance for some time swaps with a person of that appearance who is
        absent, or also looks different. A new person may turn out to be an absent one.
        """
        known = {one.id: one for one in people}
        for number in list(known):
            one = known.get(number)
            if one is not None and one.is_guest:
                continue
            other = None if one is None else self._other(one, list(known.values()))
            if one is not None and other is not None:
                known[other.id] = one.named(other)
                known[one.id] = other.named(one)
                if self._is_young(one) and not other.is_seen:
                    del known[one.id]
        return list(known.values())

    def _strangeness(self, person: FusedPerson, guest: FusedPerson) -> float:
        """Return the cost of a new person being a known one; infinite if impossible."""
        if person.is_seen and guest.appearance is None:
            return math.inf
        is_own = person.depth == guest.depth if guest.depth is not None else person.heat == guest.heat
        return (
            self._distance(person, guest)
            + self._unlikeness(person, guest, is_own=is_own)
            - (_OWN if is_own else 0.0)
        )

    def _distance(self, person: FusedPerson, guest: FusedPerson) -> float:
        """Return the cost, at most 1, of the distance from the last match of appearance or observation."""
        config = self.config
        late_s, last_m = self.time_s - person.seen_s, person.motion.place_m
        if guest.appearance is not None and person.appearance_m is not None:
            late_s, last_m = self.time_s - person.appearance_s, person.appearance_m
        (xx, xy), (_, yy) = guest.motion.place_m2.tolist()
        (widest, _), _ = principal_axes(xx, xy, yy)
        slack_m = 2.0 * math.sqrt(widest)
        reach_m = config.reach_m + config.fastest_m_s * late_s + slack_m
        found = math.dist(guest.motion.place_m, last_m) / reach_m
        return found if found <= 1.0 else math.inf

    def _unlikeness(self, person: FusedPerson, guest: FusedPerson, *, is_own: bool) -> float:
        """Return the cost of differences in appearance and height; height alone without appearance."""
        config = self.config
        off = 0.0
        if guest.depth is not None and person.depth is not None:
            off = abs(guest.tall_m - person.tall_m) / config.tallest_off_m
        if guest.appearance is not None and person.appearance is not None:
            alike = similarity(person.appearance, guest.appearance)
            return _UNLIKE * (1.0 - alike) + min(off, 1.0) if alike >= config.least_alike else math.inf
        is_long_ago = not is_own and self.time_s - person.seen_s > config.lookless_s
        return math.inf if is_long_ago or off > 1.0 else off

    def _is_young(self, person: FusedPerson) -> bool:
        return self.time_s - person.born_s < self.config.young_s

    def _other(self, person: FusedPerson, people: Sequence[FusedPerson]) -> FusedPerson | None:
        """Return the person whose appearance matches that of a person who looks different, or is new."""
        reported, is_strange = person.deep, person.strange >= self.config.strange_frames
        if reported is None or reported.appearance is None:
            return None
        if not is_strange and not self._is_young(person):
            return None
        alike = {
            other.id: similarity(other.appearance, reported.appearance)
            for other in people
            if other.appearance is not None and self._may_be(person, other, reported, is_strange=is_strange)
        }
        best = max(alike, key=lambda number: alike[number], default=None)
        if best is None or alike[best] <= (
            self.config.least_alike if is_strange else self.config.young_alike
        ):
            return None
        return next(other for other in people if other.id == best)

    def _may_be(
        self, person: FusedPerson, other: FusedPerson, reported: SensorTrack, *, is_strange: bool
    ) -> bool:
        if other.id == person.id or other.is_guest or reported.tall_m is None:
            return False
        if other.is_seen:
            return is_strange and other.strange >= _DOUBTED
        if not is_strange and other.born_s > person.born_s - _GRACE_S:
            return False
        late_s = self.time_s - other.seen_s + _GRACE_S
        reach_m = self.config.reach_m + self.config.fastest_m_s * late_s
        return math.dist(person.motion.place_m, other.motion.place_m) <= reach_m
