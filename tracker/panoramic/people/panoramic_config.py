"""Settings of the panoramic tracker."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class SightingConfig:
    """When a person is taken to be seen.

    Attributes:
        least_evidence: log odds from which a patch shows the person.
        error_share: weight of the error that the model reports: it was trained with more examples
            than those by which its errors were learned.
        gate: squared Mahalanobis distance from which a sighting is of another person.
        wide_m: standard deviation of a predicted place from which its neighbourhood is looked at, too [m].
        reach_m: how far to either side that is [m].
        partly_share: share of the body behind others from which a person is hidden in part.
        hidden_share: likewise from which who is not seen is hidden.
        blind_share: likewise from which nothing is to be seen.
    """

    least_evidence: float = -1.0
    error_share: float = 0.8
    gate: float = 16.0
    wide_m: float = 0.15
    reach_m: float = 0.3
    partly_share: float = 0.25
    hidden_share: float = 0.5
    blind_share: float = 0.7


@dataclass(frozen=True, slots=True, kw_only=True)
class LifespanConfig:
    """When tracks begin and end.

    Attributes:
        birth_sightings, birth_s: in so many images a person must be seen to be believed, or in two so long
            [s] apart.
        birth_trust: log odds from which a person new is believed.
        return_trust: log odds from which a person is believed who looks like one who went.
        death_trust: log odds below which nobody is there.
        most_trust: log odds of a single image count as no more than this.
        miss: log odds of an image in which who should be there is not seen.
        trust_s: images count for about so long [s].
        newcomers: how many places are looked at in an image for people who are not known.
        farthest_m: farther away nobody is found [m].
        newcomer_s: who is not believed yet and not seen for longer is forgotten [s].
        unseen_s: who is not seen for longer, and hidden by nobody, is gone [s].
        hidden_s: who is hidden for longer is gone [s].
        apart_m: nobody is found nearer to another person than this [m].
        double_m: two who are nearer to each other than this are one [m].
    """

    birth_sightings: int = 3
    birth_s: float = 0.3
    birth_trust: float = 6.0
    return_trust: float = 2.0
    death_trust: float = 0.0
    most_trust: float = 8.0
    miss: float = -3.0
    trust_s: float = 0.4
    newcomers: int = 3
    farthest_m: float = 7.0
    newcomer_s: float = 0.35
    unseen_s: float = 0.7
    hidden_s: float = 5.0
    apart_m: float = 0.4
    double_m: float = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentityConfig:
    """When a detection is a person who was lost before.

    Attributes:
        alike: unlikeness of looks up to which who comes is one who went.
        strange: unlikeness from which a person looks like another person.
        strange_s: for how long a person must, to be another person [s].
        reach_m, fastest_m_s: how far from where it was lost a person may be found, at once [m] and with time.
        forget_s: who has been gone for longer is not recognised [s].
    """

    alike: float = 2.5
    strange: float = 3.5
    strange_s: float = 1.5
    reach_m: float = 0.8
    fastest_m_s: float = 1.4
    forget_s: float = 20.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PeopleConfig:
    """All settings.

    Attributes:
        sighting, life, identity: as they say.
        restlessness: density of the white accelerations with which people move [m2/s3].
        fading_s: within this time, who is not seen is taken to stop [s].
        lasting_share: how much of an image's error, as a standard deviation, a person's further images have,
            too: gait and build make it.
    """

    sighting: SightingConfig = field(default_factory=SightingConfig)
    life: LifespanConfig = field(default_factory=LifespanConfig)
    identity: IdentityConfig = field(default_factory=IdentityConfig)
    restlessness: float = 0.2
    fading_s: float = 1.0
    lasting_share: float = 0.6
