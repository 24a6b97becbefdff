"""Settings of the fusion of heat, depth and colour."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FusionConfig:
    """Values chosen on seeds from 100 on of the occlusion library.

    Attributes:
        gate: squared distance, in standard deviations, beyond which a track is not a person's.
        unlike_gate: the same with what other appearance and another height count.
        own_gate: the same as `gate` for the track that was the person's before.
        loyalty, loyalty_heat: by how much a person's track of before counts as nearer: one by depth, and a
            thermal one.
        beside_m: [m] across the line of sight, by which a thermal track may be off a person that depth sees
            whole before neither its place nor its contour is taken.
        appearance_weight: cost of an entirely different appearance.
        height_sd_m: [m] by which a person's height may be measured wrongly.
        most_height: what another height counts at most.
        floor_m: [m] what places may be off beyond what the trackers believe.
        restlessness: density of the white accelerations with which people move [m2/s3].
        slow_s: [s] in which who is not seen loses most of its speed.
        clear_m, partly_m: [m] by which the place of a track may be off beyond what its tracker believes: of
            a person who is seen whole, and of a person who is hidden in part.
        peek_m: [m] the same of who is looked for where it is expected.
        peek_s: [s] for how long a person is looked for so.
        peek_warm: share of warm pixels that this takes.
        shared_m: [m] error that all images of a person have in common.
        learned: share of a newly measured height, or of new appearance.
        learned_width: the same of the width of the torso, which changes with every step.
        blink_s: [s] for how long a person is shown that is neither occluded nor reported.
        hidden_s: [s] the same of who is hidden.
        hidden_share: share of readings before a person, from which on it is hidden.
        remembered_s: [s] for how long a person is known who is away.
        reach_m, fastest_m_s: [m], [m/s] how far away from where it was lost a person may turn up.
        away_s: [s] after which who is not seen is away, and recognised rather than followed.
        settled_s: [s] for which it may be undecided who turned up,
        plain: unless a person is so much more likely than anybody else.
        lookless_s: [s] after which nobody is recognised by the place alone.
        least_alike: similarity of appearance of who turns up again.
        tallest_off_m: [m] by which the height of who turns up again may differ.
        least_own: similarity to a person's own appearance, below which it counts as strange.
        strange_frames: in a row, after which a strange person may be another person.
        relearn_frames: in a row, after which the appearance must have been wrong.
        young_s: [s] for which a new person may turn out to be one who is away,
        young_alike: by appearance of this similarity.
        seen_through: share of readings behind a warm track, from which on nobody is there.
        least_warm: share of warm pixels of what stands somewhere, below which it is nobody.
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
