"""From the image of one camera to that of another one beside it, on the same robot."""

from __future__ import annotations

import numpy as np

from peopleboy.tracker.by_detection.viewpoint import Viewpoint
from peopleboy.tracker.frame import Floats, PinholeCalibration


def carried_over(
    boxes: Floats, view: Viewpoint, here: PinholeCalibration, there: PinholeCalibration
) -> Floats:
    """Tell where people who have boxes (M, 4) [px] in one image are in the other, if all are equally tall.

    Args:
        boxes: in the image of the first camera.
        view: of that camera.
        here: its calibration.
        there: that of the other camera.

    Returns:
        (M, 4) [px], 0 of whom the other camera cannot see.
    """
    feet = view.feet(boxes)
    left, top, width, height = boxes.T
    ends = [np.stack([left + width / 2.0, row], axis=1) for row in (top, top + height)]
    # Points of the person are as far ahead as the feet.
    points = [here.rays(end) for end in ends]
    level = [ray / np.maximum(ray[:, :1], 1e-3) * feet[:, 2:] + np.array(here.position_m) for ray in points]
    above, below = (there.project(end) for end in level)
    tall = below[:, 1] - above[:, 1]
    wide = tall * width / height
    boxed = np.stack([(above[:, 0] + below[:, 0] - wide) / 2.0, above[:, 1], wide, tall], axis=1)
    return np.asarray(np.nan_to_num(boxed))
