"""The RGB-D tracker, and the same with one thing left out or done otherwise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from peopleboy.tracker.rgbd.detection.human_size import PRINTED_SIZE
from peopleboy.tracker.rgbd.rgbd_config import PRINTED, RgbdConfig
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.rgbd.verification.window_model import people_detector, shipped_windows

OURS: Final = RgbdConfig()
DEFAULT, LITERAL = "default", "as printed"
NO_CONNECTOR, NO_ODOMETRY = "no connector", "no odometry"
NO_WALLS: Final = "walls left in"
NO_DEPTH: Final = "no depth in the filters"
OPENCV: Final = "OpenCV's far detector"
COLOUR_ONLY: Final = replace(
    OURS,
    sees_depth=False,
    least_far_score=0.5,
    least_near_score=0.2,
    hypotheses=replace(OURS.hypotheses, births=2),
)
"""Judges windows by colour alone, which needs a second look."""

CHOICES: Final[Mapping[str, RgbdConfig]] = {
    DEFAULT: OURS,
    LITERAL: PRINTED,
    "printed size": replace(OURS, size=PRINTED_SIZE),
    NO_CONNECTOR: replace(OURS, above=replace(OURS.above, has_connector=False)),
    NO_WALLS: replace(OURS, above=replace(OURS.above, has_walls=False)),
    "windows of colour alone": COLOUR_ONLY,
    "no verification": replace(OURS, has_verification=False),
    OPENCV: COLOUR_ONLY,
    "no sharpening": replace(OURS, filter=replace(OURS.filter, sharpness=0.0)),
    "no hold": replace(OURS, filter=replace(OURS.filter, has_hold=False)),
    "no see-through": replace(OURS, hypotheses=replace(OURS.hypotheses, has_see_through=False)),
    NO_DEPTH: replace(OURS, filter=replace(OURS.filter, kernel_m=1000.0)),
    NO_ODOMETRY: replace(OURS, hypotheses=replace(OURS.hypotheses, uses_odometry=False)),
}
"""By the name that tables have for them."""


def make_choice(name: str, rng: np.random.Generator) -> RgbdTracker:
    """Make one of `CHOICES`."""
    config = CHOICES[name]
    model = people_detector() if name == OPENCV else shipped_windows(sees_depth=config.sees_depth)
    return RgbdTracker(config, model, rng)
