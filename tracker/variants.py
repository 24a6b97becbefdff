"""The named settings of the tracker: the sources' own, and ours."""

from __future__ import annotations

import math
from dataclasses import replace

from tracker.appearance.config import FAR_AFFINE, ROBOT_PARALLAX, ColourConfig
from tracker.config import (
    BoxConfig,
    ContourConfig,
    FilterConfig,
    InteractionConfig,
    LifeConfig,
    LikelihoodConfig,
    LimitsConfig,
    LooksConfig,
    MotionConfig,
    OcclusionConfig,
    SmoothingConfig,
    TrackerConfig,
)

THESIS = TrackerConfig()
"""Chapters 4 and 5 as they are written, with the readings named in tracker/config.py: thermal alone."""

THESIS_COLOUR = replace(THESIS, colour=ColourConfig())
"""With the colours of chapter 6."""

THESIS_OCCLUSION = replace(
    THESIS_COLOUR,
    interaction=InteractionConfig(occluded_penalty=0.5),
    occlusion=OcclusionConfig(is_handled=True),
)
"""With the occlusion handling of chapter 7: the whole thesis."""

PAPER = TrackerConfig(
    likelihood=LikelihoodConfig(model="paper"),
    detector=FilterConfig(fresh_share=0.1, estimate_share=0.3),
    person=FilterConfig(fresh_share=0.1, estimate_share=0.3),
    life=LifeConfig(birth_frames=3),
    box=BoxConfig(height_per_h=3.0),
)
"""The evaluation paper: equations 3 and 4, the best 30 %, 10 % anew, three frames to detect."""

_LIMITS = LimitsConfig(ratio_wh=(0.22, 0.62), ratio_dw=(-0.5, 0.5), y=(0.1, 0.8), h=(0.05, 0.5))

PEOPLEBOY = TrackerConfig(
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
        hottest_grey=250,
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
        # A level camera 1.2 m above the floor sees the middle of whoever stands there just below the horizon.
        limits=replace(_LIMITS, y_below_horizon=(-0.1, 0.9)),
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
        floor=0.2,
    ),
    life=LifeConfig(
        birth_confidence=0.6,
        birth_frames=3,
        death_confidence=0.3,
        doubt_frames=5,
        death_frames=12,
        uncertainty_px2=100.0,
    ),
    # Torso and feet of the drawn and simulated people lie so, relative to the ellipse that fits them best.
    box=BoxConfig(width_per_w=1.88, height_per_h=3.7),
    smoothing=SmoothingConfig(place_s=0.05, size_s=0.1),
    interaction=InteractionConfig(
        detector_penalty=1e-9, detector_overlap=0.3, penalty=8.0, occluded_penalty=0.0
    ),
    colour=ColourConfig(
        representation="moments1", sharpness=0.05, frames=30, affine=FAR_AFFINE, parallax=ROBOT_PARALLAX
    ),
    looks=LooksConfig(),
    occlusion=OcclusionConfig(
        is_handled=True,
        order="looks",
        removes_front=True,
        growth=1.2,
        keeps_velocity=True,
        hidden_memory=0.985,
        hidden_noise=0.5,
        remembers_lost=True,
        shown_s=1.0,
    ),
)
"""What works on the robot: the default."""

FOOTAGE = replace(
    PEOPLEBOY,
    contour=replace(
        PEOPLEBOY.contour, saturation_grey=25.0, cold_response=1.0, feet_weight=0.1, hottest_grey=256
    ),
    motion=replace(PEOPLEBOY.motion, noise_x=20.0, noise_y=6.0, noise_w=3.0, noise_h=3.0, place_memory=0.8),
    person=replace(PEOPLEBOY.person, sharpness=5.0, resized_share=0.0, estimate_share=1.0, floor=-math.inf),
    life=replace(PEOPLEBOY.life, birth_frames=4, death_confidence=0.02, doubt_frames=20, death_frames=20),
    box=BoxConfig(),
    interaction=InteractionConfig(max_persons=1),
    colour=None,
    looks=None,
    occlusion=OcclusionConfig(),
)
"""For recorded footage of a standing camera, one person at a time.

People keep their size, and are not given up in a crowd.
"""
