"""What the panoramic tracker believes beyond its track."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.panoramic.paper.background import Background, Mask
from peopleboy.tracker.panoramic.paper.depth_cues import MeasuredFigure
from peopleboy.tracker.panoramic.paper.position_filter import Estimate


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramicExplanation:
    """The inner life of the panoramic tracker at its newest image, for those who draw it or ask why.

    Attributes:
        background: what it takes for the empty scene.
        silhouette: (H, W) what differs from that.
        figure: histograms, angle and cues of the person; None while nobody is seen.
        distance_m: what the network makes of the cues [m]; None while nobody is seen.
        estimate: what the filter makes of it, in room coordinates; None while nobody is tracked.
    """

    background: Background
    silhouette: Mask
    figure: MeasuredFigure | None = None
    distance_m: float | None = None
    estimate: Estimate | None = None
