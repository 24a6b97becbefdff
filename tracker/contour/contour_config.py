"""Settings of the contour trackers; the variants differ in the values of these records.

Pixels refer to an image of 240 rows and are scaled by image height / 240.
"""

import math
from dataclasses import dataclass, field

from peopleboy.bad_input import BadInput
from peopleboy.tracker.contour.colour_config import (
    ColourDescriptorConfig,
    check_not_negative,
    check_positive,
    check_share,
    refuse_unless,
)

REFERENCE_HEIGHT_PX = 240
"""Image height to which the constants in the sources refer."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ContourConfig:
    """Where contours are sampled, and how grey differences are weighted.

    The thesis says that inner and outer pixels along the ellipses are compared, but not how far from the
    contour, at how many points, and where the sides end: `reach_px`, `points` and `side_end_deg` are
    readings.
    """

    points: int = 8  # pairs of inner and outer points per section
    side_end_deg: float = 180.0  # where the sides end: 180 is the bottom of the body
    reach_px: float = 2.0  # distance of the points from the contour, independent of its size
    body_reach: tuple[float, ...] = (0.0,)  # plus this share of the body's semi-width; the points alternate
    head_reach: tuple[float, ...] = (0.0,)  # plus this share of the head's semi-width
    inner_depth: float = 1.0  # distance of the inner points as a share of that of the outer ones
    far_head_reach: float = 0.0  # distance of a second outer point at the head; 0 for none
    saturation_grey: float = 0.0  # difference at which the response saturates, tanh; 0 keeps it linear
    is_cut_off: bool = False  # whether it is clipped instead: linear up to there, and constant beyond
    # Clutter (`likelihood.clutter_of`) at which the response saturates, if that is larger: differences as
    # large as everywhere in the image are little evidence.
    clutter_share: float = 0.0
    # Factor for a body colder than its surroundings: 1 against a person, 0 neutral, -1 for a person.
    cold_response: float = 1.0
    # alpha of equation 4.3: the head's left, top and right, the shoulders, the sides; scaled to add up to 1.
    section_weights: tuple[float, ...] = (0.18, 0.18, 0.18, 0.07, 0.07, 0.16, 0.16)
    feet_weight: float = 0.0  # weight of an eighth section, the line under the feet; the others add up to 1
    unseen_response: float = 0.0  # response of a point outside the image
    # Weight of such a point above the image; the remaining weight goes to the points inside. Not for points
    # below, as people would then grow until only their shoulders are visible.
    unseen_share: float = 1.0
    cut_share: float = 1.0  # the same for a camera that truncates heads, or an uncalibrated one
    hottest_grey: int = 256  # grey from which a surface is too hot for a person and counts as cold
    dark_share: float = 0.0  # share of black pixels if the scale ends there; 0: it always does
    hot_margin_px: int = 0  # so do the pixels around it, whose grey is mixed

    def __post_init__(self) -> None:
        check_positive(self, "points")
        check_not_negative(
            self,
            "saturation_grey",
            "reach_px",
            "inner_depth",
            "far_head_reach",
            "feet_weight",
            "clutter_share",
        )
        check_share(self, "unseen_share", "cut_share", "dark_share")
        weights = self.section_weights
        is_right = len(weights) == 7 and min(weights) >= 0 and sum(weights) > 0
        refuse_unless(is_right, self, "section_weights", "seven, none negative and not all 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsConfig:
    """Limits of a sample's proportions and position (thesis, table in section 4.4)."""

    ratio_wh: tuple[float, float] = (0.1, 0.9)
    ratio_dw: tuple[float, float] = (-1.5, 1.5)
    y: tuple[float, float] = (0.2, 0.8)  # [image heights]
    h: tuple[float, float] = (0.02, 0.5)  # [image heights]; the sources give no maximum
    horizon: float = 0.5  # [image heights] row of the horizon: the middle, for a level camera
    # [body semi-heights]: where people on the floor are.
    y_below_horizon: tuple[float, float] = (-math.inf, math.inf)
    # [image heights squared] by which these limits are widened: c0 + c1 h + c2 h^2, with h in image heights.
    floor_variance: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("ratio_wh", "ratio_dw", "y", "h"):
            low, high = getattr(self, name)
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise BadInput(f"LimitsConfig: {name} must be low < high, got {low}..{high}")


@dataclass(frozen=True, slots=True, kw_only=True)
class LikelihoodConfig:
    """How section differences become a weight and a probability."""

    model: str = "thesis"  # "thesis": equations 4.3 and 4.4; "paper": equations 3 and 4
    slope: float = 0.125  # kappa
    threshold: float = 22.0  # theta, in the unit of the section differences
    section_threshold: float = 10.0  # t_h of the paper: a section below it has no weight
    weakest_share: float = 0.0  # share of the weakest of the seven sections in the fitness

    def __post_init__(self) -> None:
        if self.model not in ("thesis", "paper"):
            raise BadInput(f"LikelihoodConfig: model must be thesis or paper, got {self.model!r}")
        check_positive(self, "slope")
        check_share(self, "weakest_share")


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionConfig:
    """Amplitudes of the random walk (B of equation 4.7), and the camera's ego-motion."""

    noise_x: float = 30.0  # [px/s]
    noise_y: float = 30.0
    noise_w: float = 22.0
    noise_h: float = 22.0
    noise_d: float = 60.0
    noise_by_height: float = (
        0.0  # semi-height [px] to which these refer, others in proportion; 0: the same for all
    )
    # Spread of vx, vy, vw, vh [px/s] of new samples; None: the amplitudes above.
    fresh_speed: tuple[float, float, float, float] | None = None
    place_memory: float = 1.0  # share of (vx, vy) that persists to the next step
    size_memory: float = 1.0  # the same for (vw, vh)
    uses_odometry: bool = False

    def __post_init__(self) -> None:
        check_not_negative(self, "noise_x", "noise_y", "noise_w", "noise_h", "noise_d", "noise_by_height")
        check_share(self, "place_memory", "size_memory")


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterConfig:
    """One particle filter: its size, the source of new samples, and the samples that form the estimate."""

    count: int = 1000  # N
    fresh_share: float = 0.2  # share drawn from the prior in every step
    resized_share: float = 0.0  # share resized in every step
    limits: LimitsConfig = field(default_factory=LimitsConfig)
    log_uniform_h: bool = False  # prior of h: uniform, or uniform in log h
    sharpness: float = 0.0  # weight = exp(sharpness * fitness); 0: the probability, or the paper's fitness
    estimate_share: float = 1.0  # share of the samples, the best ones, that form the estimate
    estimate_reach: float = math.inf  # only those within this many semi-axes of the best
    resamples_core: bool = False  # whether a person's next samples come from those alone
    floor: float = -math.inf  # least fitness for the weight: that of an occluded person anywhere

    def __post_init__(self) -> None:
        check_positive(self, "count", "estimate_share", "estimate_reach")
        check_share(self, "fresh_share", "resized_share", "estimate_share")
        check_not_negative(self, "sharpness")


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeConfig:
    """When a track is confirmed, and when it is deleted."""

    birth_confidence: float = 0.5
    birth_frames: int = 1  # consecutive frames needed above it
    death_confidence: float = 0.5
    doubt_frames: int = 1  # consecutive frames below it that make a person tentative again
    death_frames: int = 1  # consecutive frames below it after which the track is deleted
    uncertainty_px2: float = 400.0  # largest spread of a person's particles

    def __post_init__(self) -> None:
        check_share(self, "birth_confidence", "death_confidence")
        check_positive(self, "birth_frames", "doubt_frames", "death_frames", "uncertainty_px2")


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchConfig:
    """How new people are searched for, and which of them are confirmed sooner or later than by `LifeConfig`.

    The sources search each image once, and treat all people alike.
    """

    scans: int = 1  # times that the detector moves and weighs its samples in each image
    small_h: float = 0.0  # body semi-height [px] below which a person is small
    small_confidence: float = 0.5  # `birth_confidence` of small people
    # Large people without a neighbour are confirmed after `clear_frames` above this; 1: never sooner.
    clear_confidence: float = 1.0
    clear_frames: int = 1
    clear_margin: float = 0.0  # widths of known people that count as next to them, on each side

    def __post_init__(self) -> None:
        check_positive(self, "scans", "clear_frames")
        check_not_negative(self, "small_h", "clear_margin")
        check_share(self, "small_confidence", "clear_confidence")


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxConfig:
    """How a contour becomes a box (thesis: 2 w by 3.5 h; paper: 2 w by 3 h)."""

    width_per_w: float = 2.0
    height_per_h: float = 3.5
    hair_per_h: float = 0.0  # cold hair above the head's ellipse

    def __post_init__(self) -> None:
        check_positive(self, "width_per_w", "height_per_h")
        check_not_negative(self, "hair_per_h")


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothingConfig:
    """Time constants of the low-pass filter on estimates; 0 disables it."""

    place_s: float = 0.0  # x, y
    size_s: float = 0.0  # w, h, d

    def __post_init__(self) -> None:
        check_not_negative(self, "place_s", "size_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class AppearanceConfig:
    """Variation of a person's thermal pattern from frame to frame, and its weight."""

    grey_spread: tuple[float, float, float] = (0.085, 0.012, 0.06)  # of the mean of head, torso, legs, 0..1

    def __post_init__(self) -> None:
        refuse_unless(min(self.grey_spread) > 0, self, "grey_spread", "positive")


@dataclass(frozen=True, slots=True, kw_only=True)
class InteractionConfig:
    """How filters avoid each other's people, and how they share samples."""

    detector_penalty: float = 0.01  # psi_D, factor on a detector's sample that overlaps a person
    detector_overlap: float = 0.0  # share of the sample's region above which it counts as overlapping
    penalty: float = 2.0  # rho, towards other people
    occluded_penalty: float = 2.0  # rho_o, towards people in front
    max_persons: int = 100  # with this many people, the detector is switched off
    total_count: int = 0  # samples divided evenly among all people; 0 gives each filter its own N

    def __post_init__(self) -> None:
        check_share(self, "detector_penalty", "detector_overlap")
        check_not_negative(self, "penalty", "occluded_penalty", "total_count")
        check_positive(self, "max_persons")


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthOrderConfig:
    """Depth order of people, and its effect on the evidence."""

    # By lower feet ("foot"), by appearance as well ("appearance"), by a boosted classifier ("learned");
    # None: no depth order.
    order: str | None = None
    table: str = "contour"  # tracker for which the boosted classifier was trained: selects its table
    remembers_feet: bool = False  # the classifier uses feet as last fully visible, not the contour's end
    removes_front: bool = False  # ignore contour points on people in front
    growth: float = 1.0  # factor by which the people in front are enlarged for that

    def __post_init__(self) -> None:
        known = (None, "foot", "appearance", "learned")
        refuse_unless(self.order in known, self, "order", "foot, appearance or learned")
        check_positive(self, "growth")


@dataclass(frozen=True, slots=True, kw_only=True)
class HeightConfig:
    """How far a person's height may deviate from its value when the person was last fully visible.

    Spreads are those of the logarithm; 0: no limit.
    """

    overlapped_spread: float = 0.0  # of an overlapped or occluded person
    memory_s: float = 0.5  # time constant of that height

    def __post_init__(self) -> None:
        check_not_negative(self, "overlapped_spread")
        check_positive(self, "memory_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class StayBehindConfig:
    """Occluded people are at the position of their occluder (thesis, section 7.3).

    Without a depth order, no person is in front and none is occluded.
    """

    head_covered: float = 0.8  # covered share of the head's contour from which a person is occluded

    def __post_init__(self) -> None:
        check_share(self, "head_covered")


@dataclass(frozen=True, slots=True, kw_only=True)
class WalkOnConfig:
    """Occluded people continue with their last velocity."""

    remembers_lost: bool = False  # whether other lost people also keep walking, and are remembered
    shows_only_sure: bool = False  # occluded people are only output while their position is fairly certain


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackerConfig:
    """Settings of a contour tracker."""

    contour: ContourConfig = field(default_factory=ContourConfig)
    likelihood: LikelihoodConfig = field(default_factory=LikelihoodConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    detector: FilterConfig = field(default_factory=FilterConfig)
    person: FilterConfig = field(default_factory=FilterConfig)
    life: LifeConfig = field(default_factory=LifeConfig)
    search: SearchConfig = field(default_factory=SearchConfig)
    box: BoxConfig = field(default_factory=BoxConfig)
    smoothing: SmoothingConfig = field(default_factory=SmoothingConfig)
    interaction: InteractionConfig = field(default_factory=InteractionConfig)
    colour: ColourDescriptorConfig | None = None  # None: thermal alone
    appearance: AppearanceConfig | None = None  # None: colours without normalisation
    depth: DepthOrderConfig = field(default_factory=DepthOrderConfig)
    height: HeightConfig = field(default_factory=HeightConfig)
    occlusion: StayBehindConfig | WalkOnConfig = field(default_factory=StayBehindConfig)
