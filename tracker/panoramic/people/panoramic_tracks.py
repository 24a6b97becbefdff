"""State of the tracks of the panoramic tracker."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.tracker.panoramic.people.band_colours import NO_COLOURS, BandColours
from peopleboy.tracker.panoramic.people.floor_motion import Floats, FloorMotion
from peopleboy.tracker.panoramic.people.panoramic_config import IdentityConfig, PeopleConfig
from peopleboy.tracker.panoramic.people.panoramic_observation import Sighting
from peopleboy.tracker.track import Status


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramicPerson:
    """State of one track.

    Attributes:
        id: of the track; 0 before it has one.
        motion: position and velocity in room coordinates.
        lasting_m2: (2, 2) covariance of the position that further images do not reduce, in room coordinates.
        born_s, seen_s: times of the first and the last detection [s].
        sightings: number of images with a detection.
        trust: log-odds that a person is there, over the newest images.
        status: visibility; a new track is tentative until it is confirmed.
        appearance: colours over time.
        newest: colours in the last image in which the person was fully visible.
        strange_s: how long it has looked like another person [s].
        occluder: id of the occluding track.
    """

    id: int
    motion: FloorMotion
    lasting_m2: Floats
    born_s: float
    seen_s: float
    sightings: int
    trust: float
    status: Status
    clothing: BandColours = NO_COLOURS
    newest: BandColours = NO_COLOURS
    strange_s: float = 0.0
    occluder: int | None = None

    @property
    def confidence(self) -> float:
        """0..1, probability that a person is there."""
        return 1.0 / (1.0 + math.exp(-self.trust))

    @property
    def is_seen(self) -> bool:
        """Whether it was detected in the newest image."""
        return self.status is not Status.TOTALLY_OCCLUDED

    def known_as(self, known: "PanoramicPerson") -> "PanoramicPerson":
        """Continue a known person's track: take over its id, age and appearance."""
        born_s = min(known.born_s, self.born_s)
        return replace(self, id=known.id, born_s=born_s, strange_s=0.0, clothing=known.clothing)


# Existence of a person: detected, missed, new, deleted.

_ROUNDING_S = 1e-6


@dataclass(frozen=True, slots=True)
class Life:
    """Updates of tracks with one image.

    Attributes:
        config: settings.
        time_s: of the image [s].
        dt_s: time since the previous image [s].
    """

    config: PeopleConfig
    time_s: float
    dt_s: float

    def initiate(self, seen: Sighting, clothing: BandColours) -> PanoramicPerson:
        """Initiate a track with a first detection."""
        return PanoramicPerson(
            id=0,
            motion=FloorMotion.begin(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            born_s=self.time_s,
            seen_s=self.time_s,
            sightings=1,
            trust=min(seen.evidence, self.config.life.most_trust),
            status=Status.TENTATIVE,
            clothing=clothing,
            newest=clothing,
        )

    def seen(
        self, person: PanoramicPerson, seen: Sighting, clothing: BandColours, occluder: int | None
    ) -> PanoramicPerson:
        """Update a track with a detection, fully visible or partly occluded."""
        is_whole, passed_s = occluder is None, self.time_s - person.seen_s
        is_strange = is_whole and person.clothing.unlikeness(clothing) > self.config.identity.strange
        return replace(
            person,
            motion=person.motion.corrected(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            seen_s=self.time_s,
            sightings=person.sightings + 1,
            trust=self._trust(person.trust, seen.evidence, passed_s),
            status=Status.TRACKED if is_whole else Status.PARTLY_OCCLUDED,
            clothing=person.clothing if is_strange or not is_whole else person.clothing.joined(clothing),
            newest=clothing,
            strange_s=person.strange_s + passed_s if is_strange else 0.0,
            occluder=occluder,
        )

    def unseen(self, person: PanoramicPerson, occluder: int | None) -> PanoramicPerson:
        """Update a track without a detection; the log-odds of an occluded one do not change."""
        miss = self._trust(person.trust, self.config.life.miss, self.dt_s)
        return replace(
            person,
            motion=person.motion.slowed(self.dt_s, self.config.fading_s),
            trust=miss if occluder is None else person.trust,
            status=Status.TOTALLY_OCCLUDED,
            occluder=occluder,
            strange_s=0.0,
        )

    def is_gone(self, person: PanoramicPerson) -> bool:
        """Return whether a track is to be deleted: unseen for too long, or a false positive."""
        unseen_s = self.time_s - person.seen_s
        return unseen_s > self._patience_s(person) or person.trust < self.config.life.death_trust

    def is_settled(self, person: PanoramicPerson) -> bool:
        """Return whether a track is visible, and long enough for confirmation."""
        life = self.config.life
        has_stayed = person.sightings > 1 and self.time_s - person.born_s >= life.birth_s - _ROUNDING_S
        return person.is_seen and (has_stayed or person.sightings >= life.birth_sightings)

    def could_be(self, person: PanoramicPerson, place_m: Floats, clothing: BandColours) -> bool:
        """Return whether a lost person may be the detected one, by distance and appearance."""
        identity = self.config.identity
        reach = identity.reach_m + identity.fastest_m_s * (self.time_s - person.seen_s)
        way = math.dist(person.motion.place_m, place_m)
        return not person.is_seen and way < reach and person.clothing.unlikeness(clothing) < identity.alike

    def _patience_s(self, person: PanoramicPerson) -> float:
        """Return how long a track may stay undetected."""
        life = self.config.life
        if person.id == 0:
            return life.newcomer_s
        return life.unseen_s if person.occluder is None else life.hidden_s

    def _trust(self, trust: float, evidence: float, dt_s: float) -> float:
        """Add the log-odds of a new image."""
        life = self.config.life
        newest = min(evidence, life.most_trust)
        return trust + (1.0 - math.exp(-dt_s / life.trust_s)) * (newest - trust)


# Re-identification of people who were here before, and repair of identity swaps.


class Register:
    """Assigns ids, and remembers the appearance of lost people.

    Args:
        config: settings.
    """

    def __init__(self, config: IdentityConfig) -> None:
        self._config = config
        self._gone: tuple[PanoramicPerson, ...] = ()
        self._newest = 0

    def leave(self, persons: Sequence[PanoramicPerson], time_s: float) -> None:
        """Store deleted tracks, and forget the oldest."""
        known = (*self._gone, *(person for person in persons if person.id))
        self._gone = tuple(one for one in known if time_s - one.seen_s < self._config.forget_s)

    def named(self, person: PanoramicPerson, time_s: float) -> PanoramicPerson:
        """Return a track with an id: that of the same lost person, or a new one."""
        known = self.recognised(person, time_s)
        if known is None:
            self._newest += 1
            return replace(person, id=self._newest, strange_s=0.0)
        self._gone = tuple(one for one in self._gone if one is not known)
        return person.known_as(known)

    def resolve_swaps(self, persons: Sequence[PanoramicPerson], time_s: float) -> tuple[PanoramicPerson, ...]:
        """Give tracks that have looked like another person for long that person's id, or a new one."""
        strangers = [one for one in persons if one.id and one.strange_s >= self._config.strange_s]
        if not strangers:
            return tuple(persons)
        # The old appearance stays with the id, whose owner has walked on since the appearance changed.
        # The current appearance is all that is known of the track itself.
        self.leave([replace(one, seen_s=time_s - one.strange_s) for one in strangers], time_s)
        right = {
            one.id: self.named(replace(one, clothing=one.newest, born_s=time_s), time_s) for one in strangers
        }
        return tuple(right[one.id] if one in strangers else one for one in persons)

    def recognised(self, person: PanoramicPerson, time_s: float) -> PanoramicPerson | None:
        """Return the lost person that a track matches by appearance and distance, or None."""
        best, least = None, self._config.alike
        for one in self._gone:
            way = float(np.linalg.norm(one.motion.place_m - person.motion.place_m))
            unlikeness = one.clothing.unlikeness(person.clothing)
            reach = self._config.reach_m + self._config.fastest_m_s * (time_s - one.seen_s)
            if way < reach and unlikeness < least:
                best, least = one, unlikeness
        return best
