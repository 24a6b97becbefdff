"""One tracked person."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from peopleboy.tracker.panoramic.people.floor_motion import Floats, Motion
from peopleboy.tracker.panoramic.people.looks import NO_LOOKS, Looks
from peopleboy.tracker.track import Status


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramicPerson:
    """What is believed of one person.

    Attributes:
        id: of the track; 0 before it has one.
        motion: place and velocity in room coordinates.
        lasting_m2: (2, 2) covariance of the place that further images do not lessen, in room coordinates.
        born_s, seen_s: when it was seen first, and last [s].
        sightings: in how many images.
        trust: log odds that somebody is there, over the newest images.
        status: how well it is seen; a newcomer is tentative until it is believed.
        looks: its colours, over time.
        newest: its colours in the last image in which it was seen whole.
        strange_s: for how long it has looked like somebody else [s].
        occluder: id of who hides it.
    """

    id: int
    motion: Motion
    lasting_m2: Floats
    born_s: float
    seen_s: float
    sightings: int
    trust: float
    status: Status
    looks: Looks = NO_LOOKS
    newest: Looks = NO_LOOKS
    strange_s: float = 0.0
    occluder: int | None = None

    @property
    def confidence(self) -> float:
        """0..1, how surely somebody is there."""
        return 1.0 / (1.0 + math.exp(-self.trust))

    @property
    def is_seen(self) -> bool:
        """Whether it was seen in the newest image."""
        return self.status is not Status.TOTALLY_OCCLUDED

    def known_as(self, known: PanoramicPerson) -> PanoramicPerson:
        """Take somebody new for one who is known: the number, the age and the looks are that one's."""
        born_s = min(known.born_s, self.born_s)
        return replace(self, id=known.id, born_s=born_s, strange_s=0.0, looks=known.looks)
