"""What the contour tracker believes beyond its tracks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.particles import Particles

DETECTOR_KEY = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContourExplanation:
    """The inner life of the contour tracker at one instant, for those who draw it or ask why.

    Attributes:
        config: the tracker's settings, by which contours are measured and drawn.
        ellipses: the estimated contour by track id.
        spread_px2: spread of the particles about the estimate, over x and y [px^2], by track id (thesis,
            equation 4.6).
        particles: the samples by track id; key 0 is the detector's cloud. Empty where they were not kept.
    """

    config: TrackerConfig
    ellipses: Mapping[int, Ellipse]
    spread_px2: Mapping[int, float]
    particles: Mapping[int, Particles] = field(default_factory=dict)
