"""Settings of the fusion of thermal, depth and colour."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FusionConfig:
    """Values chosen on seeds from 100 on of the occlusion library.

    Attributes:
        gate: greatest squared Mahalanobis distance between a track and its person.
        unlike_gate: the same including the costs of appearance and height.
        own_gate: the same as `gate` for the person's previous track.
        loyalty, loyalty_heat: discount for the person's previous track, of the depth and of the thermal
            tracker.
        beside_m: [m] across the line of sight; a thermal track farther off a person that depth sees fully
            contributes neither position nor contour.
        appearance_weight: cost of an entirely different appearance.
        height_sd_m: [m] standard deviation of the measured height.
        most_height: greatest cost of a different height.
        floor_m: [m] error of positions beyond the trackers' own estimates.
        restlessness: spectral density of the white acceleration of people [m2/s3].
        slow_s: [s] in which the velocity of an unobserved person decays.
        clear_m, partly_m: [m] error of a track's position beyond its tracker's own estimate, of a fully
            visible and of a partly occluded person.
        peek_m: [m] the same for the guided search.
        peek_s: [s] longest time for which the guided search continues.
        peek_warm: least share of warm pixels for the guided search.
        shared_m: [m] error common to all images of a person.
        learned: update rate of height and appearance.
        learned_width: the same for the width of the torso, which changes with every step.
        blink_s: [s] how long a person is output who is neither occluded nor reported.
        hidden_s: [s] the same for an occluded person.
        hidden_share: share of readings in front of a person from which it counts as occluded.
        remembered_s: [s] after which an absent person is forgotten.
        reach_m, fastest_m_s: [m], [m/s] greatest distance from the last position at which a person may
            reappear.
        away_s: [s] after which an unobserved person is absent, and re-identified rather than tracked.
        settled_s: [s] for which the identity of a new person may stay undecided,
        plain: unless one candidate is better than all others by this cost.
        lookless_s: [s] after which nobody is re-identified by position alone.
        least_alike: least similarity of appearance for re-identification.
        tallest_off_m: [m] greatest difference in height for re-identification.
        least_own: similarity to a person's own appearance below which it counts as different.
        strange_frames: consecutive different frames after which the person may be another one.
        relearn_frames: consecutive different frames after which the appearance is learned anew.
        young_s: [s] for which a new person may still turn out to be an absent one,
        young_alike: given this similarity of appearance.
        seen_through: share of readings behind a warm track from which there is no person.
        least_warm: least share of warm pixels of a person.
    """

    gate: float = 12.0
    unlike_gate: float = 18.0
    own_gate: float = 25.0
    loyalty: float = 6.0
    loyalty_heat: float = 12.0
    beside_m: float = 0.3
    appearance_weight: float = 20.0
    height_sd_m: float = 0.08
    most_height: float = 4.0
    floor_m: float = 0.12
    restlessness: float = 0.3
    slow_s: float = 4.0
    clear_m: float = 0.08
    partly_m: float = 0.12
    peek_m: float = 0.08
    peek_s: float = 1.5
    peek_warm: float = 0.25
    shared_m: float = 0.03
    learned: float = 0.1
    learned_width: float = 0.5
    blink_s: float = 0.35
    hidden_s: float = 0.4
    hidden_share: float = 0.4
    remembered_s: float = 20.0
    reach_m: float = 1.2
    fastest_m_s: float = 1.4
    away_s: float = 0.7
    settled_s: float = 0.5
    plain: float = 0.5
    lookless_s: float = 3.0
    least_alike: float = 0.7
    tallest_off_m: float = 0.12
    least_own: float = 0.6
    strange_frames: int = 10
    relearn_frames: int = 15
    young_s: float = 3.0
    young_alike: float = 0.85
    seen_through: float = 0.7
    least_warm: float = 0.15
