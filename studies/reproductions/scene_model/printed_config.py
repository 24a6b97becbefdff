"""Settings of the printed scene model, and its four variants; most numbers are not printed but chosen."""

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Final


class PrintedBackground(StrEnum):
    """How the background is learned (SA 3.7)."""

    MEAN = "mean"
    MPIX = "mpix"
    TRACK = "track"
    ADAPT = "adapt"


@dataclass(frozen=True, slots=True, kw_only=True)
class EllipseConfig:
    """Settings of the particle filter of one moving object (SA 3.5).

    Attributes:
        particles: number of them.
        first_order: share N_m that keeps moving; the others move at random (SA eq. 3.7-3.10).
        radius_m, radius_sd_m: of a new ellipse [m], and its noise A_1, A_2.
        least_m, most_m: [m] limits of radii.
        place_sd_m, heading_sd, speed_sd_m: noise A_3 to A_7, A_9 of a frame of 1/15 s.
        turn_sd: noise A_8 of v_rot [rad].
        shifts: steps of mean shift.
        near_m, alike_m: widths H_d [m] and H_v [m per frame] (SA eq. 3.25, 3.26).
        thin_m, wide_m: widths H_r of the smallest and the largest radius (SA eq. 3.24).
        lost: frames without a cluster after which it is deleted.
    """

    particles: int = 60
    first_order: float = 0.5
    radius_m: float = 0.3
    radius_sd_m: float = 0.02
    least_m: float = 0.2
    most_m: float = 0.45
    place_sd_m: float = 0.06
    heading_sd: float = 0.6
    speed_sd_m: float = 0.02
    turn_sd: float = 0.25
    shifts: int = 3
    near_m: float = 0.25
    alike_m: float = 0.05
    thin_m: float = 0.15
    wide_m: float = 0.5
    lost: int = 15


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedConfig:
    """Settings of the whole model.

    Attributes:
        background: which of the four.
        same_m: theta_d [m], tolerance between two equal readings; 10 cm is printed.
        moving_m: theta_v [m per frame], least motion of a moving point.
        nearest_m, near_m: [m] up to which the median has 7 x 7 and 5 x 5 pixels, beyond it 3 x 3.
        flow_px, flow_levels: [px] side of the optical flow's window, and levels of its pyramid.
        dark: share of the mean amplitude below which a reading is dropped; 0 keeps all.
        neighbours, edge_m, edge_share: a reading is kept if this many of 8 neighbours are within this [m], or
            this share of its depth.
        level_m: [m] greatest distance of two points of a cluster in space and velocity.
        velocity_weight: [m per m a frame] weight of a velocity in this distance.
        block_px: [px] side of the blocks of the image in which points are clustered.
        least_points: of a cluster.
        detect_points, detect_m, detect_cosine: of a new object: nearby points with similar motion; 20 is
            printed.
        ellipse: settings of the filters.
        thing_px, thing_m, thing_s: of movable objects: smallest size [px], and tolerances in depth [m] and
            time [s] between neighbouring points.
    """

    background: PrintedBackground = PrintedBackground.ADAPT
    same_m: float = 0.1
    moving_m: float = 0.03
    nearest_m: float = 1.5
    near_m: float = 2.5
    flow_px: int = 9
    flow_levels: int = 3
    dark: float = 0.01
    neighbours: int = 4
    edge_m: float = 0.05
    edge_share: float = 0.03
    level_m: float = 0.2
    velocity_weight: float = 4.0
    block_px: int = 16
    least_points: int = 3
    detect_points: int = 20
    detect_m: float = 0.3
    detect_cosine: float = 0.7
    ellipse: EllipseConfig = field(default_factory=EllipseConfig)
    thing_px: int = 40
    thing_m: float = 0.1
    thing_s: float = 1.0


VARIANTS: Final = {one.value: replace(PrintedConfig(), background=one) for one in PrintedBackground}
"""The source's four models, by name."""
