"""What the fused tracker believes beyond its tracks, by the kinds that its parts have."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.handover.both_explanations import BothExplanations
from peopleboy.tracker.rgbd.rgbd_explanation import RgbdExplanation


@dataclass(frozen=True, slots=True, eq=False)
class FusedExplanation:
    """What each part believes.

    Attributes:
        both: of the thermal image and, where there is one, the panorama, by the numbers of the tracks.
        depth: of the depth image; None before the first.
    """

    both: BothExplanations
    depth: RgbdExplanation | None
