"""What the tracker by detection believes beyond its tracks."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.frame import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DetectionExplanation:
    """What was proposed in the last frame.

    Attributes:
        boxes: (M, 4) [px] in the thermal image.
        scores: (M,) log odds that they are people.
    """

    boxes: Floats
    scores: Floats
