"""Where on the floor people stand whose boxes in the thermal image are known.

Seen from a camera h above the floor, the feet of a person of stature S at distance r are h / r below the
horizon, as a slope, and the head is (S - h) / r above it. Both tell 1 / r: feet by a row that is hard to see,
the head by a stature that is not known. All errors grow with the apparent height (h + S - h) / r, so that the
best mix of the two is the same at every distance (weighted least squares, errors below), and the error of the
distance is a share of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np

from peopleboy.tracker.calibration import Calibration
from peopleboy.tracker.thermal.tracked_person import PERSON_M
from peopleboy.tracker.track import Box, FloorPlace, Status

Ray = Sequence[float]  # x, y, z of a direction in the robot's frame

# All values below were chosen on seeds 10 to 12 of the suite `occlusion`.
STATURE_SD_M: Final = 0.09
FOOT_BELOW: Final = 0.02  # how far a box ends below the feet, in box heights
FOOT_SD: Final = 0.057  # error of the row of the feet, in box heights
HEAD_SD: Final = 0.02  # error of the row of the head
CORRELATION: Final = 0.5  # of the two: a box that is too high at one end is at the other
FARTHEST_M: Final = 30.0

ERRORS: Final = {
    Status.TRACKED: (0.1, 0.0105),
    Status.PARTLY_OCCLUDED: (0.13, 0.021),
    Status.TOTALLY_OCCLUDED: (0.15, 0.026),
    Status.TENTATIVE: (0.15, 0.026),
}
"""Standard deviations of the distance, as a share of it, and of the bearing, in apparent heights."""


def places_on_floor(
    boxes: Sequence[Box], statuses: Sequence[Status], calibration: Calibration
) -> list[FloorPlace]:
    """Tell where K people stand, from head and feet of their boxes [px].

    Args:
        boxes: left, top, width, height of each.
        statuses: how well each is seen, which decides how sure its place is.
        calibration: of the camera that the boxes are seen by.
    """
    ends = [(left + width / 2.0, row) for left, top, width, height in boxes for row in _ends(top, height)]
    rays = calibration.rays(np.array(ends).reshape(-1, 2)).tolist()
    return [
        _place(head, foot, *ERRORS[status], calibration.position_m)
        for head, foot, status in zip(rays[::2], rays[1::2], statuses, strict=True)
    ]


def _ends(top: float, height: float) -> tuple[float, float]:
    """Give the rows of head and feet."""
    return top, top + (1.0 - FOOT_BELOW) * height


def _place(
    head: Ray, foot: Ray, along_share: float, across_share: float, camera_m: tuple[float, float, float]
) -> FloorPlace:
    """Tell where somebody stands whose head and feet are seen along two rays."""
    x, y, up = camera_m
    ahead, aside, _ = foot
    away = math.hypot(ahead, aside)
    cosine, sine = ahead / away, aside / away
    head_slope, foot_slope = head[2] / math.hypot(head[0], head[1]), foot[2] / away
    foot_weight, head_weight = _weights(up)
    nearness = head_weight * head_slope - foot_weight * foot_slope
    distance = 1.0 / max(nearness, 1.0 / FARTHEST_M)
    along = (along_share * distance) ** 2
    across = (across_share * (head_slope - foot_slope) * distance) ** 2
    return FloorPlace(
        position_m=(x + distance * cosine, y + distance * sine),
        covariance_m2=(
            along * cosine**2 + across * sine**2,
            (along - across) * sine * cosine,
            along * sine**2 + across * cosine**2,
        ),
    )


@lru_cache(maxsize=16)
def _weights(camera_height_m: float) -> tuple[float, float]:
    """Give the factors of the slopes down to the feet and up to the head whose sum is 1 / distance [1/m]."""
    covariance = np.array(
        [
            [FOOT_SD**2, CORRELATION * FOOT_SD * HEAD_SD],
            [CORRELATION * FOOT_SD * HEAD_SD, HEAD_SD**2 + (STATURE_SD_M / PERSON_M) ** 2],
        ]
    )
    slopes = np.array([camera_height_m, PERSON_M - camera_height_m])  # at a distance of 1 m
    certain = np.linalg.solve(covariance, slopes)
    foot, head = (certain / (certain @ slopes)).tolist()
    return foot, head
