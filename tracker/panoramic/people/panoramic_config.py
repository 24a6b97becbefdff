"""Settings of the panoramic tracker."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class SightingConfig:
    """Detection of a person.

    Attributes:
        least_evidence: log-odds from which a patch shows a person.
        error_share: factor on the model's reported error: the model was trained with more examples than those
            from which its errors were learned.
        gate: squared Mahalanobis distance beyond which a detection belongs to another person.
        wide_m: standard deviation of a prediction from which its neighbourhood is searched, too [m].
        reach_m: half-width of that neighbourhood [m].
        partly_share: covered share of the body from which a person is partly occluded.
        hidden_share: covered share from which an undetected person is occluded.
        blind_share: covered share from which a person cannot be detected.
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
    """Initiation, confirmation and deletion of tracks.

    Attributes:
        birth_sightings, birth_s: number of images with a detection needed for confirmation, or two images
            this far apart [s].
        birth_trust: log-odds for the confirmation of a new person.
        return_trust: log-odds for the confirmation of a person who resembles a lost one.
        death_trust: log-odds below which a track is deleted.
        most_trust: limit of the log-odds of a single image.
        miss: log-odds of an image without an expected detection.
        trust_s: time constant of the log-odds [s].
        newcomers: number of positions searched per image for new people.
        farthest_m: greatest distance of detections [m].
        newcomer_s: time without a detection after which a tentative track is deleted [s].
        unseen_s: the same for an unoccluded confirmed track [s].
        hidden_s: the same for an occluded track [s].
        apart_m: least distance of a new person from others [m].
        double_m: distance below which two tracks are one person [m].
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
    """Re-identification of lost people.

    Attributes:
        alike: greatest difference of appearance for re-identification.
        strange: difference from which a person looks like another one.
        strange_s: time after which such a person is another one [s].
        reach_m, fastest_m_s: greatest distance from the last position, at once [m] and growing with time.
        forget_s: time after which a lost person is forgotten [s].
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
        sighting, life, identity: settings of detection, of the track's life, and of re-identification.
        restlessness: spectral density of the white acceleration of people [m2/s3].
        fading_s: time constant with which the velocity of an unseen person decays [s].
        lasting_share: share of an image's standard deviation that is common to a person's further images,
            from gait and build.
    """

    sighting: SightingConfig = field(default_factory=SightingConfig)
    life: LifespanConfig = field(default_factory=LifespanConfig)
    identity: IdentityConfig = field(default_factory=IdentityConfig)
    restlessness: float = 0.2
    fading_s: float = 1.0
    lasting_share: float = 0.6
