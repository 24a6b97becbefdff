"""Who is who after a while: who turns up again, and who has been taken for another person."""

from __future__ import annotations

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

_OWN: Final = 1.0  # what it counts that a track was the person's before
_UNLIKE: Final = 5.0  # what entirely other appearance counts
_GRACE_S: Final = 1.0
_DOUBTED_S: Final = 0.25  # after which who is not known by appearance may be elsewhere
_DOUBTED: Final = 2  # frames in a row in which a person looked otherwise who may be taken for another


@dataclass(frozen=True, slots=True)
class IdentityResolution:
    """Compares those who are here with those who were.

    Attributes:
        config: settings.
        time_s: [s] now.
        is_lit: whether there is any appearance.
    """

    config: FusionConfig
    time_s: float
    is_lit: bool

    def settled(self, people: Sequence[FusedPerson], numbers: Iterator[int]) -> list[FusedPerson]:
        """Number those who turned up, as soon as it is plain who they are, or late enough.

        All of them are compared with all who are away at once. Who is taken for a person who seemed to be
        seen, but was not known by appearance of late, has that one's number.

        Args:
            people: everybody; who turned up has a negative id.
            numbers: of people who were never here before.
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
        """Return whether a person may be elsewhere: who is not seen, or not known by appearance of late."""
        is_doubted = (
            self.is_lit and person.appearance is not None and self.time_s - person.appearance_s > _DOUBTED_S
        )
        return not person.is_seen or is_doubted

    def _is_plain(self, guest: FusedPerson, costs: Floats, chosen: int | None) -> bool:
        """Return whether it is time to say who a person is.

        Args:
            guest: who turned up.
            costs: (N,) how unlikely it is that this is each of those who are away.
            chosen: which of them it is most likely; None for nobody.
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
        """Return people who look like another that one's number.

        Who has looked otherwise for a while changes with a person of its appearance who is away, or looks
        otherwise, too. A new person may turn out to be one who is away.
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
        """Rate how unlikely it is that a guest is a person; infinite if it is out of the question."""
        if person.is_seen and guest.appearance is None:
            return math.inf
        is_own = person.depth == guest.depth if guest.depth is not None else person.heat == guest.heat
        return (
            self._distance(person, guest)
            + self._unlikeness(person, guest, is_own=is_own)
            - (_OWN if is_own else 0.0)
        )

    def _distance(self, person: FusedPerson, guest: FusedPerson) -> float:
        """Rate the distance since a person was last recognised by appearance, or else seen: 1 at most."""
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
        """Rate how different appearance and height are; height alone decides without appearance."""
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
        """Find whose appearance a person has who looks otherwise, or is new."""
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
