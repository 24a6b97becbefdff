"""Settings of the contour trackers; the variants differ in the values of these records.

Pixels refer to an image of 240 rows and are scaled by image height / 240.
"""

import math
from dataclasses import dataclass, field

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.colour_config import (
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
    """How contours are sampled, and how grey differences are weighted.

    The thesis compares inner and outer pixels along the ellipses, but does not state their distance from the
    contour, their number, or where the sides end. `reach_px`, `points` and `side_end_deg` are therefore
    interpretations.
    """

    points: int = 8  # number of pairs of inner and outer points per section
    side_end_deg: float = 180.0  # end of the sides; 180 is the bottom of the body
    reach_px: float = 2.0  # constant distance of the points from the contour
    # additional distance, as a share of the semi-width of the body; successive points alternate between the
    # values
    body_reach: tuple[float, ...] = (0.0,)
    head_reach: tuple[float, ...] = (0.0,)  # additional distance, as a share of the semi-width of the head
    inner_depth: float = 1.0  # distance of the inner points, as a share of that of the outer points
    far_head_reach: float = 0.0  # distance of a second outer point at the head; 0 for none
    # grey difference at which the response saturates (tanh); 0 for a linear response
    saturation_grey: float = 0.0
    is_cut_off: bool = False  # whether the response is clipped at this difference, instead of tanh
    # clutter (`likelihood.clutter_of`) at which the response saturates, if this is larger; differences that
    # occur everywhere in the image are weak evidence
    clutter_share: float = 0.0
    # factor for a body that is colder than its surroundings: 1 is evidence against a person, 0 is neutral,
    # and -1 is evidence for a person
    cold_response: float = 1.0
    # alpha of equation 4.3 for the left, top and right of the head, the shoulders and the sides; scaled to
    # a sum of 1
    section_weights: tuple[float, ...] = (0.18, 0.18, 0.18, 0.07, 0.07, 0.16, 0.16)
    # weight of an eighth section, the line under the feet; the other weights add up to 1
    feet_weight: float = 0.0
    unseen_response: float = 0.0  # response of a point outside the image
    # weight of a point above the image; the remaining weight goes to the points inside. Points below the
    # image are excluded, since people would otherwise grow until only their shoulders are visible
    unseen_share: float = 1.0
    cut_share: float = 1.0  # the same for an uncalibrated camera, or for one that cuts off heads
    hottest_grey: int = 256  # grey value from which a surface is too hot for a person, and counts as cold
    dark_share: float = 0.0  # minimum share of black pixels for which `hottest_grey` applies; 0 for always
    # margin around hot pixels that also counts as cold, since its grey values are mixed
    hot_margin_px: int = 0

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
    """Limits of the proportions and position of a sample (thesis, table in section 4.4)."""

    ratio_wh: tuple[float, float] = (0.1, 0.9)  # semi-width of the body, divided by its semi-height
    # horizontal offset of the head, divided by the semi-width of the body
    ratio_dw: tuple[float, float] = (-1.5, 1.5)
    y: tuple[float, float] = (0.2, 0.8)  # [image heights] row of the centre of the body
    # [image heights] semi-height of the body; the sources give no maximum
    h: tuple[float, float] = (0.02, 0.5)
    horizon: float = 0.5  # [image heights] row of the horizon; for a level camera, the middle of the image
    # [body semi-heights] row of the centre below the horizon, for people on the floor
    y_below_horizon: tuple[float, float] = (-math.inf, math.inf)
    # [image heights squared] variance by which these limits are widened: c0 + c1 h + c2 h^2, with h in
    # image heights
    floor_variance: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("ratio_wh", "ratio_dw", "y", "h"):
            low, high = getattr(self, name)
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise BadInput(f"LimitsConfig: {name} must be low < high, got {low}..{high}")


@dataclass(frozen=True, slots=True, kw_only=True)
class LikelihoodConfig:
    """How section differences are converted to a weight and a probability."""

    model: str = "thesis"  # "thesis" for equations 4.3 and 4.4, "paper" for equations 3 and 4
    slope: float = 0.125  # kappa, the slope of the logistic function from fitness to probability
    threshold: float = 22.0  # theta, the fitness with probability 0.5, in the unit of section differences
    section_threshold: float = 10.0  # t_h of the paper; sections below it have no weight
    weakest_share: float = 0.0  # weight of the weakest of the seven sections in the fitness

    def __post_init__(self) -> None:
        if self.model not in ("thesis", "paper"):
            raise BadInput(f"LikelihoodConfig: model must be thesis or paper, got {self.model!r}")
        check_positive(self, "slope")
        check_share(self, "weakest_share")


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionConfig:
    """Amplitudes of the random walk (B of equation 4.7), and ego-motion of the camera."""

    noise_x: float = 30.0  # [px/s] amplitude for x
    noise_y: float = 30.0  # [px/s] amplitude for y
    noise_w: float = 22.0  # [px/s] amplitude for w
    noise_h: float = 22.0  # [px/s] amplitude for h
    noise_d: float = 60.0  # [px/s] amplitude for d
    # [px] semi-height to which these amplitudes refer; they are scaled in proportion to it. 0 for constant
    # amplitudes
    noise_by_height: float = 0.0
    # [px/s] spread of vx, vy, vw and vh in new samples; None for the amplitudes above
    fresh_speed: tuple[float, float, float, float] | None = None
    place_memory: float = 1.0  # share of the velocity (vx, vy) that persists to the next step
    size_memory: float = 1.0  # share of the velocity (vw, vh) that persists to the next step
    uses_odometry: bool = False  # whether odometry predicts the motion of the camera

    def __post_init__(self) -> None:
        check_not_negative(self, "noise_x", "noise_y", "noise_w", "noise_h", "noise_d", "noise_by_height")
        check_share(self, "place_memory", "size_memory")


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterConfig:
    """Size of a particle filter, the source of new samples, and the samples that form the estimate."""

    count: int = 1000  # number of samples N
    fresh_share: float = 0.2  # share of samples drawn from the prior in every step
    resized_share: float = 0.0  # share of samples resized in every step
    limits: LimitsConfig = field(default_factory=LimitsConfig)  # limits of the samples
    log_uniform_h: bool = False  # whether the prior of h is uniform in log h, instead of in h
    # weight = exp(sharpness * fitness); 0 for the probability, or the fitness of the paper
    sharpness: float = 0.0
    estimate_share: float = 1.0  # share of the samples that form the estimate; the best samples are used
    estimate_reach: float = math.inf  # maximum distance of these samples from the best sample, in semi-axes
    resamples_core: bool = False  # whether a person's next samples are drawn from these samples only
    floor: float = -math.inf  # minimum fitness for the weight, which is that of an occluded person anywhere

    def __post_init__(self) -> None:
        check_positive(self, "count", "estimate_share", "estimate_reach")
        check_share(self, "fresh_share", "resized_share", "estimate_share")
        check_not_negative(self, "sharpness")


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeConfig:
    """When a track is confirmed, and when it is deleted."""

    birth_confidence: float = 0.5  # confidence above which a track is confirmed
    birth_frames: int = 1  # number of consecutive frames above `birth_confidence` that confirm a track
    death_confidence: float = 0.5  # confidence below which a track is lost
    # number of consecutive frames below `death_confidence` after which a track is tentative again
    doubt_frames: int = 1
    # number of consecutive frames below `death_confidence` after which a track is deleted
    death_frames: int = 1
    uncertainty_px2: float = 400.0  # [px^2] maximum spread of a person's samples

    def __post_init__(self) -> None:
        check_share(self, "birth_confidence", "death_confidence")
        check_positive(self, "birth_frames", "doubt_frames", "death_frames", "uncertainty_px2")


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchConfig:
    """How new people are searched for, and exceptions from the rules of `LifeConfig` for confirmation.

    The sources search each image once, and use the same rules for all people.
    """

    scans: int = 1  # number of times that the detector moves and weights its samples in each image
    small_h: float = 0.0  # [px] semi-height of the body below which a person is small
    small_confidence: float = 0.5  # `birth_confidence` of small people
    # confidence above which a large person without a neighbour is confirmed after `clear_frames`; 1
    # disables this rule
    clear_confidence: float = 1.0
    clear_frames: int = 1  # number of consecutive frames for this rule
    # distance to each side of a known person that counts as next to the person, in widths of the person
    clear_margin: float = 0.0

    def __post_init__(self) -> None:
        check_positive(self, "scans", "clear_frames")
        check_not_negative(self, "small_h", "clear_margin")
        check_share(self, "small_confidence", "clear_confidence")


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxConfig:
    """Conversion of a contour to a box (2 w by 3.5 h in the thesis, 2 w by 3 h in the paper)."""

    width_per_w: float = 2.0  # width of the box, divided by w
    height_per_h: float = 3.5  # height of the box, divided by h
    hair_per_h: float = 0.0  # height of cold hair above the ellipse of the head, divided by h

    def __post_init__(self) -> None:
        check_positive(self, "width_per_w", "height_per_h")
        check_not_negative(self, "hair_per_h")


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothingConfig:
    """Time constants of the low-pass filter on estimates; 0 disables it."""

    place_s: float = 0.0  # [s] time constant of x and y
    size_s: float = 0.0  # [s] time constant of w, h and d

    def __post_init__(self) -> None:
        check_not_negative(self, "place_s", "size_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class AppearanceConfig:
    """Variation of a person's thermal pattern from frame to frame, and its weight."""

    # spread of the mean grey value of head, torso and legs (0..1)
    grey_spread: tuple[float, float, float] = (0.085, 0.012, 0.06)

    def __post_init__(self) -> None:
        refuse_unless(min(self.grey_spread) > 0, self, "grey_spread", "positive")


@dataclass(frozen=True, slots=True, kw_only=True)
class InteractionConfig:
    """How filters avoid people who are tracked by other filters, and how they share samples."""

    # psi_D, the factor on the weight of a detector's sample that overlaps a person
    detector_penalty: float = 0.01
    detector_overlap: float = 0.0  # share of the sample's region above which it overlaps a person
    penalty: float = 2.0  # rho, for overlaps with other people
    occluded_penalty: float = 2.0  # rho_o, for overlaps with people in front
    total_count: int = 0  # number of samples shared evenly by all people; 0 gives each filter its own N

    def __post_init__(self) -> None:
        check_share(self, "detector_penalty", "detector_overlap")
        check_not_negative(self, "penalty", "occluded_penalty", "total_count")


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthOrderConfig:
    """Depth order of people, and its effect on the evidence."""

    # depth order by lower feet ("foot"), by feet and appearance ("appearance"), or by a boosted classifier
    # ("learned"); None for no depth order
    order: str | None = None
    table: str = "contour"  # tracker for which the boosted classifier was trained
    # whether the classifier uses the feet as last fully visible, instead of the end of the contour
    remembers_feet: bool = False
    removes_front: bool = False  # whether contour points on people in front are ignored
    growth: float = 1.0  # factor by which people in front are enlarged for `removes_front`

    def __post_init__(self) -> None:
        known = (None, "foot", "appearance", "learned")
        refuse_unless(self.order in known, self, "order", "foot, appearance or learned")
        check_positive(self, "growth")


@dataclass(frozen=True, slots=True, kw_only=True)
class HeightConfig:
    """How much a person's height may deviate from the height when the person was last fully visible.

    Spreads are those of the logarithm of the height; 0 disables the limit.
    """

    overlapped_spread: float = 0.0  # spread for an overlapped or occluded person
    memory_s: float = 0.5  # [s] time constant of the remembered height

    def __post_init__(self) -> None:
        check_not_negative(self, "overlapped_spread")
        check_positive(self, "memory_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class StayBehindConfig:
    """Occluded people have the position of their occluder (thesis, section 7.3).

    Without a depth order, no person is in front, and no person is occluded.
    """

    head_covered: float = 0.8  # covered share of the contour of the head at which a person is occluded

    def __post_init__(self) -> None:
        check_share(self, "head_covered")


@dataclass(frozen=True, slots=True, kw_only=True)
class WalkOnConfig:
    """Occluded people continue with their last velocity."""

    remembers_lost: bool = False  # whether other lost people also continue to walk, and are remembered
    # whether occluded people are output only while their position is fairly certain
    shows_only_sure: bool = False


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
