"""Where the thermal image shows a tracked person, also for trackers that know people on the floor alone."""

from __future__ import annotations

from peopleboy.tracker.frame import THERMAL, Calibration
from peopleboy.tracker.thermal.whereabouts import standing_box
from peopleboy.tracker.track import Box, Track


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
    return None if track.place is None else standing_box(track.place, calibration)
