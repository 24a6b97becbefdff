"""Settings of the RGB-D tracker: as printed in its source, and improved."""

from dataclasses import dataclass, field
from typing import Final

from peopleboy.tracker.sensors.depth.human_windows import WindowRange
from peopleboy.tracker.sensors.depth.pre_detection import PRINTED_SIZE, HumanSize
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorFilterConfig:
    """Settings of the particle filter on the floor (SA 4.6).

    Attributes:
        particles: number of particles.
        forward_share: share that keeps walking; the others move at random.
        walk_m, walk_m_s: spread of position [m] and velocity [m/s] of walking particles in a frame of 1/15 s.
        random_m, random_m_s: the same for particles that move at random.
        kernel_m: [m] width of the kernel around the measured position (SA eq. 4.27).
        sharpness: deviation of one minus the similarity that halves the weight's logarithm; 0 uses the
            similarity itself as the weight, as printed.
        foreground_m: [m] from a particle's depth, within which colours are used; 0 for all in its box.
        has_hold: whether a filter only predicts while there are no readings at its particles.
        learning_rate: update rate of the histogram (SA eq. 4.29).
    """

    particles: int = 150
    forward_share: float = 0.7
    walk_m: float = 0.015
    walk_m_s: float = 0.15
    random_m: float = 0.06
    random_m_s: float = 0.5
    kernel_m: float = 0.25
    sharpness: float = 0.15
    foreground_m: float = 0.5
    has_hold: bool = True
    learning_rate: float = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class HypothesesConfig:
    """Settings of the management of hypotheses (SA 4.5).

    Attributes:
        gate_m, gate_per_m: [m] greatest distance of an association, and its growth with squared depth.
        gate_m_s: [m/s] growth of the gate, up to twice, while a person is not observed.
        births: verifications needed for confirmation.
        pre_share, verified_share, filter_share: weights of measurements in the merged position (SA eq. 4.22).
        unverified_s: [s] without a verification after which a hypothesis is deleted.
        missing_s: [s] for which a visible but unobserved person is output.
        outside_s: [s] the same for a person outside the image.
        hidden_s: [s] without a verification after which an occluded or outside person is deleted; output
            for `unverified_s` only.
        has_see_through: whether a hypothesis is deleted when the background is visible at its position.
        appearance_weight: cost of a different appearance in the association, in gates.
        uses_odometry: whether hypotheses are moved by the robot's motion.
        body_m: [m] from the visible surface to the middle of the body.
    """

    gate_m: float = 0.5
    gate_per_m: float = 0.003
    gate_m_s: float = 0.4
    births: int = 1
    pre_share: float = 0.3
    verified_share: float = 0.6
    filter_share: float = 0.5
    unverified_s: float = 2.0
    missing_s: float = 0.4
    outside_s: float = 1.0
    hidden_s: float = 6.0
    has_see_through: bool = True
    appearance_weight: float = 0.5
    uses_odometry: bool = True
    body_m: float = 0.115


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdConfig:
    """Settings of the whole tracker.

    Attributes:
        size: expected size of a human.
        above: settings of the view from above.
        filter: settings of the particle filters.
        hypotheses: settings of their management.
        has_verification: whether detections must also be classified as human.
        sees_depth: whether windows are classified by depth as well as by colour.
        least_far_score, least_near_score: least score of a human's window.
    """

    size: HumanSize = field(default_factory=HumanSize)
    above: UDepthConfig = field(default_factory=UDepthConfig)
    filter: FloorFilterConfig = field(default_factory=FloorFilterConfig)
    hypotheses: HypothesesConfig = field(default_factory=HypothesesConfig)
    has_verification: bool = True
    sees_depth: bool = True
    least_far_score: float = 0.9
    least_near_score: float = 0.5

    def least_score(self, kind: WindowRange) -> float:
        """Return the least score of a human's window of a range."""
        return self.least_far_score if kind is WindowRange.FAR else self.least_near_score


PRINTED: Final = RgbdConfig(
    size=PRINTED_SIZE,
    sees_depth=False,
    least_far_score=0.5,
    least_near_score=0.2,
    above=UDepthConfig(row_m=0.03, bridged_steps=0.0, has_walls=False),
    filter=FloorFilterConfig(sharpness=0.0, foreground_m=0.0),
    hypotheses=HypothesesConfig(
        births=2,
        gate_per_m=0.0,
        gate_m_s=0.0,
        missing_s=2.0,
        outside_s=2.0,
        hidden_s=2.0,
        has_see_through=False,
        appearance_weight=0.0,
        body_m=0.0,
    ),
)
"""As printed in the source.

The source does not print the depth in a row of the view from above. With 3 cm, its longest bridged gap, ten
rows, is as long as the sensor's step at its farthest depth of 10 m; with 1 cm, bodies and walls beyond 6 m
fall apart into pieces of one depth each. Nor does it print the least score of a window: that of colour
windows is used, chosen on seeds 100 and 101.
"""
