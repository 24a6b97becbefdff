"""What a track's box says of the contour that it was made of."""

from __future__ import annotations

from peopleboy.tracker.reproductions.contour.contour_config import BoxConfig
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from peopleboy.tracker.track import Track


def middle(track: Track) -> float:
    """Column [px] of the body's centre."""
    return track.boxes["thermal"][0] + track.boxes["thermal"][2] / 2.0


def semi_height(track: Track, box: BoxConfig = CONTOUR.box) -> float:
    """Semi-height [px] of the body."""
    return track.boxes["thermal"][3] / box.height_per_h


def head_top(track: Track, box: BoxConfig = CONTOUR.box) -> float:
    """Row [px] of the top of the head's ellipse."""
    return track.boxes["thermal"][1] + box.hair_per_h * semi_height(track, box)
