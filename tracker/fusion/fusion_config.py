"""Settings of the fusion of heat, depth and colour."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FusionConfig:
    """Values chosen on seeds from 100 on of the occlusion library.

    Attributes:
        gate: squared distance, in standard deviations, beyond which a track is not a person's.
        own_gate: the same for the track that was the person's before.
        loyalty: by how much a person's track of before counts as nearer.
        looks_weight: what entirely other looks count.
        height_sd_m: [m] by which a person's height may be measured wrongly.
        most_height: what another height counts at most.
        floor_m: [m] what places may be off beyond what the trackers believe.
        restlessness: density of the white accelerations with which people move [m2/s3].
        slow_s: [s] in which who is not seen loses most of its speed.
        deep_m, warm_m, partly_m: [m] by which a place may be off beyond what its tracker believes: one by
            depth, one by heat, and any of somebody who is hidden in part.
        shared_m: [m] error that all images of a person have in common.
        learned: share of a newly measured height, width or histogram.
        blink_s: [s] for how long somebody is shown whom nothing hides and nobody tells of.
        hidden_s: [s] the same of who is hidden.
        hidden_share: share of readings before somebody, from which on it is hidden.
        remembered_s: [s] for how long somebody is known who is away.
        reach_m, fastest_m_s: [m], [m/s] how far away from where it was lost somebody may turn up.
        least_alike: similarity of looks of who turns up again.
        tallest_off_m: [m] by which the height of who turns up again may differ.
        seen_through: share of readings behind a warm track, from which on nobody is there.
        least_warm: share of warm pixels of what stands somewhere, below which it is nobody.
        torso_per_contour: width of a person's torso, in widths of the contour tracker's box.
    """

    gate: float = 12.0
    own_gate: float = 25.0
    loyalty: float = 6.0
    warm_loyalty: float = 6.0
    heat_first: int = 0
    own_warm_gate: float = 25.0
    looks_weight: float = 20.0
    height_sd_m: float = 0.08
    most_height: float = 4.0
    floor_m: float = 0.12
    restlessness: float = 0.3
    slow_s: float = 4.0
    deep_m: float = 0.05
    warm_m: float = 0.05
    partly_m: float = 0.3
    peeks: int = 1
    peek_m: float = 0.08
    peek_s: float = 1.5
    peek_warm: float = 0.25
    shared_m: float = 0.03
    learned: float = 0.1
    blink_s: float = 0.35
    hidden_s: float = 0.7
    hidden_share: float = 0.4
    remembered_s: float = 20.0
    reach_m: float = 1.2
    fastest_m_s: float = 1.4
    least_own: float = 0.6
    strange: int = 5
    young_s: float = 3.0
    least_young: float = 0.85
    relearn: int = 15
    least_alike: float = 0.7
    tallest_off_m: float = 0.12
    seen_through: float = 0.7
    least_warm: float = 0.15
    torso_per_contour: float = 0.5
