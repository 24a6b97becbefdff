"""How a person is believed in: seen, unseen, new, gone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from peopleboy.tracker.panoramic.people.floor_motion import Floats, Motion
from peopleboy.tracker.panoramic.people.looks import Looks
from peopleboy.tracker.panoramic.people.panoramic_config import PeopleConfig
from peopleboy.tracker.panoramic.people.panoramic_person import PanoramicPerson
from peopleboy.tracker.panoramic.people.sighting import Sighting
from peopleboy.tracker.track import Status

_ROUNDING_S = 1e-6


@dataclass(frozen=True, slots=True)
class Life:
    """What an image changes in what is believed of a person.

    Attributes:
        config: settings.
        time_s: of the image [s].
        dt_s: since the one before [s].
    """

    config: PeopleConfig
    time_s: float
    dt_s: float

    def newcomer(self, seen: Sighting, looks: Looks) -> PanoramicPerson:
        """Begin with somebody who is seen for the first time."""
        return PanoramicPerson(
            id=0,
            motion=Motion.begin(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            born_s=self.time_s,
            seen_s=self.time_s,
            sightings=1,
            trust=min(seen.evidence, self.config.life.most_trust),
            status=Status.TENTATIVE,
            looks=looks,
            newest=looks,
        )

    def seen(
        self, person: PanoramicPerson, seen: Sighting, looks: Looks, hider: int | None
    ) -> PanoramicPerson:
        """Take in that a person is seen, whole or with somebody in front."""
        is_whole, passed_s = hider is None, self.time_s - person.seen_s
        is_strange = is_whole and person.looks.unlikeness(looks) > self.config.identity.strange
        return replace(
            person,
            motion=person.motion.corrected(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            seen_s=self.time_s,
            sightings=person.sightings + 1,
            trust=self._trust(person.trust, seen.evidence, passed_s),
            status=Status.TRACKED if is_whole else Status.PARTLY_OCCLUDED,
            looks=person.looks if is_strange or not is_whole else person.looks.joined(looks),
            newest=looks,
            strange_s=person.strange_s + passed_s if is_strange else 0.0,
            occluder=hider,
        )

    def unseen(self, person: PanoramicPerson, hider: int | None) -> PanoramicPerson:
        """Take in that a person is not seen; who is hidden is trusted as before."""
        miss = self._trust(person.trust, self.config.life.miss, self.dt_s)
        return replace(
            person,
            motion=person.motion.slowed(self.dt_s, self.config.fading_s),
            trust=miss if hider is None else person.trust,
            status=Status.TOTALLY_OCCLUDED,
            occluder=hider,
            strange_s=0.0,
        )

    def is_gone(self, person: PanoramicPerson) -> bool:
        """Tell whether somebody has been out of sight for too long, or was nobody."""
        unseen_s = self.time_s - person.seen_s
        return unseen_s > self._patience_s(person) or person.trust < self.config.life.death_trust

    def is_settled(self, person: PanoramicPerson) -> bool:
        """Tell whether somebody is seen, and has been for long enough to be believed."""
        life = self.config.life
        has_stayed = person.sightings > 1 and self.time_s - person.born_s >= life.birth_s - _ROUNDING_S
        return person.is_seen and (has_stayed or person.sightings >= life.birth_sightings)

    def may_be(self, person: PanoramicPerson, place_m: Floats, looks: Looks) -> bool:
        """Tell whether somebody who is out of sight may be who is seen here: by the way, and by the looks."""
        identity = self.config.identity
        reach = identity.reach_m + identity.fastest_m_s * (self.time_s - person.seen_s)
        way = math.dist(person.motion.place_m, place_m)
        return not person.is_seen and way < reach and person.looks.unlikeness(looks) < identity.alike

    def _patience_s(self, person: PanoramicPerson) -> float:
        """Tell for how long somebody may stay unseen."""
        life = self.config.life
        if person.id == 0:
            return life.newcomer_s
        return life.unseen_s if person.occluder is None else life.hidden_s

    def _trust(self, trust: float, evidence: float, dt_s: float) -> float:
        """Let the log odds of a new image join those before."""
        life = self.config.life
        newest = min(evidence, life.most_trust)
        return trust + (1.0 - math.exp(-dt_s / life.trust_s)) * (newest - trust)
