"""A tracker without memory: `peopleboy run single_follow --tracker examples.warm_patch:WarmPatch`.

The tallest upright warm patch of the thermal image is the only person, always with the same id. In a
comparison, it shows what a task needs of perception:

    peopleboy compare --controllers follow_person@truth,follow_person@examples.warm_patch:WarmPatch
"""

import cv2
import numpy as np

from examples.detectors import as_torsos
from peopleboy import Frame, Status, Track

WARM = 40  # grey of the thermal image: 25.9 degC, warmer than most walls
UPRIGHT = 1.3  # least ratio of height to width
LEAST_HEIGHT = 0.15  # [image heights]


class WarmPatch:
    """The tallest upright warm patch of each image, as a track."""

    cameras = ("thermal",)

    def __init__(self, _rng: np.random.Generator) -> None:
        pass

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Return a track with the box of the patch; none without one."""
        warm = (frame.grey("thermal") > WARM).astype(np.uint8)
        patches = cv2.connectedComponentsWithStats(warm)[2][1:, :4].astype(np.float64)
        tall = np.maximum(UPRIGHT * patches[:, 2], LEAST_HEIGHT * len(warm))
        upright = patches[patches[:, 3] > tall]
        if not len(upright):
            return ()
        left, top, width, height = as_torsos(upright[[np.argmax(upright[:, 3])]], 1.0)[0].tolist()
        return (
            Track(
                id=1,
                boxes={"thermal": (left, top, width, height)},
                confidence=1.0,
                status=Status.UNKNOWN,
                age_s=0.0,
            ),
        )
