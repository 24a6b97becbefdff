"""Where the thermal image shows a tracked person, also for trackers that know people on the floor alone."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from peopleboy.tracker.frame import THERMAL, Calibration
from peopleboy.tracker.thermal.whereabouts import PERSON_M
from peopleboy.tracker.track import Box, FloorPlace, Track

WIDTH_M: Final = 0.5  # of who has no box
WIDEST_RAD: Final = math.radians(75.0)  # who is farther to the side, or behind, is put here
NEAREST_M: Final = 0.3


def thermal_box(track: Track, calibration: Calibration) -> Box | None:
    """Give a track's own box, or that of somebody who stands at its place; None for one without a place.

    Args:
        track: whose.
        calibration: of the thermal camera.

    Returns:
        left, top, width, height [px], which may lie outside the image: to that side the person is then.
    """
    if THERMAL in track.boxes:
        return track.boxes[THERMAL]
    return None if track.place is None else _standing(track.place, calibration)


def _standing(place: FloorPlace, calibration: Calibration) -> Box:
    camera_x, camera_y, _ = calibration.position_m
    forward, aside = place.position_m[0] - camera_x, place.position_m[1] - camera_y
    away = max(math.hypot(forward, aside), NEAREST_M)
    bearing = max(-WIDEST_RAD, min(math.atan2(aside, forward), WIDEST_RAD))
    x, y = camera_x + away * math.cos(bearing), camera_y + away * math.sin(bearing)
    (u, top), (_, bottom) = calibration.project(np.array([[x, y, PERSON_M], [x, y, 0.0]])).tolist()
    width = (bottom - top) * WIDTH_M / PERSON_M
    return u - width / 2.0, top, width, bottom - top
