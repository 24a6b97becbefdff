"""What the thesis leaves open, and what is read into it: each reading undone by itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from peopleboy.studies.reproductions.measuring.tracker_settings import Changes, Value

_ROOT_STEP: Final = math.sqrt(1 / 15)  # of the thesis's time step [s]


def _of_both(name: str, value: Value) -> Changes:
    """Change both filters: the one that looks for people, and theirs."""
    return tuple((f"{one}.{name}", value) for one in ("detector", "person"))


def _reach(share: float) -> Changes:
    return (("contour.body_reach", (share,)), ("contour.head_reach", (share,)))


def _walk(noise: float) -> Changes:
    return (("motion.noise_x", noise), ("motion.noise_y", noise))


def _swell(noise: float) -> Changes:
    return (("motion.noise_w", noise), ("motion.noise_h", noise))


AS_READ: Final = "as read"
UNDONE: Final[Mapping[str, Changes]] = {
    AS_READ: (),
    "contrast in full": (
        ("contour.saturation_grey", 0.0),
        ("likelihood.slope", 0.125),
        ("likelihood.threshold", 22.0),
    ),
    "contrast bent smoothly": (("contour.is_cut_off", False),),
    "hot things as they are": (("contour.hottest_grey", 256),),
    "points 2 px from the contour": _reach(0.0),
    "points inside as far as outside": (("contour.inner_depth", 1.0),),
    "sides down to the bottom": (("contour.side_end_deg", 180.0),),
    "noise of x and y as printed, in every step": _walk(30.0),
    "noise of x and y by the root of the step": _walk(30.0 * _ROOT_STEP),
    "noise of x and y by the step": _walk(30.0 / 15),
    "noise of w and h as printed, in every step": _swell(22.0),
    "noise of d as printed, in every step": (("motion.noise_d", 60.0 * 15),),
    "new samples uniform in h": _of_both("log_uniform_h", value=False),
    "new samples up to half of the image": _of_both("limits.h", (0.02, 0.5)),
    "new samples with speeds as in B": (("motion.fresh_speed", None),),
}
"""One line each: the literal tracker for one person, but for one reading, with all else as it is."""

_GROWING: Final = _of_both("sharpness", 20.0)
_KEPT: Final = (
    *_of_both("limits.ratio_wh", (0.22, 0.62)),
    *_of_both("limits.ratio_dw", (-0.5, 0.5)),
    *_of_both("limits.y", (0.1, 0.8)),
    ("detector.limits.h", (0.05, 0.5)),
    ("detector.limits.y_below_horizon", (-0.1, 0.9)),
    ("person.limits.h", (0.03, 0.5)),
)
"""Limits of the default: proportions and sizes that people have, and feet on a level floor for who is new."""
_BEST: Final = (
    *_of_both("estimate_share", 0.3),
    ("detector.estimate_reach", 0.7),
    ("person.resamples_core", True),
)
_NEW: Final = (("detector.fresh_share", 0.5), ("person.fresh_share", 0.0), ("person.resized_share", 0.2))

NOT_PRINTED: Final[Mapping[str, Changes]] = {
    "not printed: 5000 samples": _of_both("count", 5000),
    "not printed: uncertainty left out": (("life.uncertainty_px2", 1e9),),
    "not printed: weights that grow with the fit": _GROWING,
    "not printed: limits as people keep them": _KEPT,
    "not printed: both of these": _KEPT + _GROWING,
    "not printed: these, and the best 30 % tell": _KEPT + _GROWING + _BEST,
    "not printed: these, and new samples as the default's": _KEPT + _GROWING + _BEST + _NEW,
}
"""What the thesis says otherwise, to see what its figures would take here."""

READINGS: Final = {**UNDONE, **NOT_PRINTED}
