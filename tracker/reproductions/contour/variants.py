"""Named settings of the contour trackers: those of the sources, and those of PeopleBoy."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from peopleboy.tracker.reproductions.contour.colour_config import (
    FAR_AFFINE,
    ROBOT_PARALLAX,
    ColourDescriptorConfig,
)
from peopleboy.tracker.reproductions.contour.contour_config import (
    AppearanceConfig,
    BoxConfig,
    ContourConfig,
    DepthOrderConfig,
    FilterConfig,
    HeightConfig,
    InteractionConfig,
    LifeConfig,
    LikelihoodConfig,
    LimitsConfig,
    MotionConfig,
    SearchConfig,
    SmoothingConfig,
    StayBehindConfig,
    TrackerConfig,
    WalkOnConfig,
)

_CAP_GREY = 40.0  # unit of the fitness, to which kappa and theta below refer
_ROOT_STEP = math.sqrt(1 / 15)  # of the thesis's time step [s]
_THESIS_SAMPLES = FilterConfig(limits=LimitsConfig(h=(0.02, 0.25)), log_uniform_h=True)

THESIS_SINGLE = TrackerConfig(
    contour=ContourConfig(
        body_reach=(0.3,),
        head_reach=(0.4,),
        inner_depth=0.6,
        side_end_deg=120.0,
        saturation_grey=_CAP_GREY,
        is_cut_off=True,
        hottest_grey=250,
        hot_margin_px=1,
    ),
    likelihood=LikelihoodConfig(slope=0.125 * _CAP_GREY, threshold=22.0 / _CAP_GREY),
    motion=MotionConfig(
        noise_x=30.0 / 2,
        noise_y=30.0 / 2,
        noise_w=22.0 * _ROOT_STEP,
        noise_h=22.0 * _ROOT_STEP,
        fresh_speed=(60.0, 8.0, 2.0, 2.0),
    ),
    detector=_THESIS_SAMPLES,
    person=_THESIS_SAMPLES,
)
"""Chapter 4 of the thesis: one person in the thermal image, with the constants of the thesis.

Where the thesis leaves a detail open, it is interpreted. The effect of each interpretation was measured on
training seeds, and is listed on the page of `peopleboy reproduce`.

Contrast: theta = 22 and kappa = 0.125 were fitted to the camera of the thesis. In PeopleBoy's images, people
are 60 to 200 grey levels brighter than the background, so one side of a head would already exceed theta.
Differences are therefore clipped at 40 grey levels. This is the largest contrast at which a head alone, with
a weight of 0.54, does not reach theta. Pixels at the end of the scale are hotter than any person, and count
as cold. The thesis has no such step, but its rooms had fewer lamps and radiators of the size of a person.

Contour: the distance of points from the contour is a share of the ellipse. It is larger outside than inside,
so that the estimated width is not biased. The sides end above the legs.

Motion: B has no unit of time. Its entries for the velocities of w and h are interpreted as amplitudes of
Brownian motion after one second, which grow with the square root of the time step. The entries for x and y
are half of the printed values in every step; with the square root, people are found later, and with the full
values, they are lost.

Prior: uniform in the logarithm of h, up to the largest body that fits into the image, and with the
speeds of people who walk past.
"""

THESIS = replace(
    THESIS_SINGLE,
    contour=replace(
        THESIS_SINGLE.contour, reach_px=4.0, body_reach=(0.1,), head_reach=(0.13,), side_end_deg=140.0
    ),
    person=replace(_THESIS_SAMPLES, fresh_share=0.0),
)
"""Chapter 5 of the thesis: several people in the thermal image, each with a filter.

New samples are drawn by the detector only. In a person's filter, those on another person would raise the
uncertainty above its limit. Points are farther from the contour of small people than for one person, and
the sides end lower.
Chosen by the area accuracy on `hall_visits` with seeds 100 and 101, and `corridor_patrol` with seed 100.
"""

THESIS_COLOUR = replace(
    THESIS,
    colour=ColourDescriptorConfig(representation="moments1", affine=FAR_AFFINE, parallax=ROBOT_PARALLAX),
)
"""As `THESIS`, with the colours of chapter 6.

Of the representations evaluated there, it uses the first moments. Higher moments are unsuitable, because the
skewness of a uniformly coloured region is unbounded, and rendered people are uniformly coloured. The cameras
of the simulated robot are 6 cm apart. No affine map compensates for this at all distances, so a parallax is
added to the map.
"""

THESIS_OCCLUSION = replace(
    THESIS_COLOUR,
    interaction=InteractionConfig(occluded_penalty=0.5),
    depth=DepthOrderConfig(order="learned", table="thesis"),
    occlusion=StayBehindConfig(head_covered=1.0),
)
"""As `THESIS_COLOUR`, with the occlusion handling of chapter 7.

A head is occluded if no point of it is visible. The depth order comes from a classifier (sections 7.1 and
7.2) that `peopleboy train occlusion --tracker thesis` trained on pairs of people from this tracker. During
the training, the order was that of the feet.
"""

_PAPER_SAMPLES = replace(_THESIS_SAMPLES, fresh_share=0.1, estimate_share=0.3)

PAPER = replace(
    THESIS,
    likelihood=replace(
        THESIS.likelihood, model="paper", threshold=14.0 / _CAP_GREY, section_threshold=10.0 / _CAP_GREY
    ),
    detector=_PAPER_SAMPLES,
    person=replace(_PAPER_SAMPLES, fresh_share=0.0),
    life=LifeConfig(birth_frames=3, uncertainty_px2=math.inf),
    box=BoxConfig(height_per_h=3.0),
)
"""The 2005 paper: equations 3 and 4, the best 30 % of the samples, three frames to detect; 10 % new samples
in the detector.

The paper does not state a threshold of the fitness. The value is 14 grey levels, below the 22 of the thesis,
because sections below 10 grey levels have no weight. Unlike the thesis, it has no limit of the uncertainty.
It was chosen on the same sequences as the settings of `THESIS`.
"""

PAPER_SINGLE = replace(
    PAPER,
    contour=replace(
        THESIS_SINGLE.contour,
        reach_px=4.0,
        body_reach=(0.0,),
        head_reach=(0.0,),
        inner_depth=1.0,
        saturation_grey=0.0,
        is_cut_off=False,
        hot_margin_px=3,
    ),
    likelihood=replace(PAPER.likelihood, slope=0.125, threshold=18.0, section_threshold=10.0),
    person=_PAPER_SAMPLES,
    life=LifeConfig(uncertainty_px2=math.inf),
)
"""The 2005 paper for one person, with one filter that always runs, as in its tables 1 to 3.

Differences are linear, as printed, between points 4 px on either side of the contour. The paper asks for
three frames to detect several persons only. With several filters, linear differences start several tracks on
one person in PeopleBoy's sharp images, so `PAPER` does not use them.
Chosen on `passers_by` with seeds 100 to 103.
"""

_CONTOUR_COLOUR = ColourDescriptorConfig(
    representation="moments1", sharpness=0.035, frames=30, affine=FAR_AFFINE, parallax=ROBOT_PARALLAX
)

_LIMITS = LimitsConfig(ratio_wh=(0.22, 0.62), ratio_dw=(-0.5, 0.5), y=(0.1, 0.8), h=(0.03, 0.5))

CONTOUR = TrackerConfig(
    contour=ContourConfig(
        points=5,
        reach_px=0.0,
        body_reach=(0.08, 0.3),
        head_reach=(0.15, 0.5),
        far_head_reach=1.2,
        saturation_grey=18.0,
        side_end_deg=140.0,
        cold_response=-0.5,
        feet_weight=0.15,
        unseen_response=0.1,
        cut_share=0.2,
        clutter_share=2.0,
        hottest_grey=250,
        dark_share=0.7,
        hot_margin_px=2,
    ),
    likelihood=LikelihoodConfig(slope=6.0, threshold=0.45, weakest_share=0.25),
    motion=MotionConfig(
        noise_x=30.0,
        noise_y=15.0,
        noise_w=20.0,
        noise_h=25.0,
        noise_d=60.0,
        noise_by_height=45.0,
        place_memory=0.9,
        size_memory=0.5,
        uses_odometry=True,
    ),
    detector=FilterConfig(
        fresh_share=0.5,
        # A level camera 1.2 m above the floor sees the middle of a standing person just below the horizon;
        # `mount` transforms that to other cameras.
        limits=replace(_LIMITS, h=(0.05, 0.5), y_below_horizon=(-0.1, 0.9)),
        log_uniform_h=True,
        sharpness=20.0,
        estimate_share=0.3,
        estimate_reach=0.7,
    ),
    person=FilterConfig(
        fresh_share=0.0,
        resized_share=0.2,
        limits=_LIMITS,
        sharpness=20.0,
        estimate_share=0.3,
        resamples_core=True,
        floor=0.2,
    ),
    life=LifeConfig(
        birth_confidence=0.75,
        birth_frames=3,
        death_confidence=0.4,
        doubt_frames=5,
        death_frames=12,
        uncertainty_px2=100.0,
    ),
    # Chosen on hall_visits, passers_by and corridor_patrol, seeds 100 to 102.
    search=SearchConfig(
        scans=2,
        small_h=18.0,
        small_confidence=0.85,
        clear_confidence=0.6,
        clear_frames=2,
        clear_margin=0.4,
    ),
    # Positions of torso and feet of the drawn and simulated people, relative to the best fitting ellipse.
    box=BoxConfig(width_per_w=1.88, height_per_h=3.9, hair_per_h=0.08),
    smoothing=SmoothingConfig(place_s=0.05, size_s=0.3),
    interaction=InteractionConfig(
        detector_penalty=1e-9, detector_overlap=0.3, penalty=8.0, occluded_penalty=0.0
    ),
    colour=_CONTOUR_COLOUR,
    appearance=AppearanceConfig(),
    depth=DepthOrderConfig(order="appearance", remembers_feet=True, removes_front=True, growth=1.2),
    height=HeightConfig(overlapped_spread=0.1),
    occlusion=WalkOnConfig(remembers_lost=True, shows_only_sure=True),
)
"""The best contour tracker."""

CONTOUR_LEARNED = replace(CONTOUR, depth=replace(CONTOUR.depth, order="learned"))
"""As `CONTOUR`, with a learned depth order."""

VARIANTS: Final[Mapping[str, TrackerConfig]] = {
    "contour": CONTOUR,
    "learned": CONTOUR_LEARNED,
    "thesis": THESIS_OCCLUSION,
    "thermal": THESIS,
    "colour": THESIS_COLOUR,
    "paper": PAPER,
    "thesis-single": THESIS_SINGLE,
    "paper-single": PAPER_SINGLE,
}
"""Settings of the contour trackers by name; the last two are those of `SingleFilter`."""
