"""What the RGB-D tracker believes beyond its tracks."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.rgbd.detection.pre_detection import Layout
from peopleboy.tracker.rgbd.people.detection import Detection
from peopleboy.tracker.rgbd.people.hypothesis import Hypothesis


@dataclass(frozen=True, slots=True, eq=False)
class RgbdExplanation:
    """The newest frame as the tracker sees it.

    Attributes:
        layout: the depth image sorted out.
        detections: what has the size of a human, and whether it looks like one.
        hypotheses: all of them, those that nobody is believed to be at, too.
    """

    layout: Layout
    detections: tuple[Detection, ...]
    hypotheses: tuple[Hypothesis, ...]
