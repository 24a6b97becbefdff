"""What a tracker told in all frames of a run, as it is scored."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Track, confirmed


def told_boxes(frames: Iterable[Iterable[Track]]) -> TrackBoxes:
    """Take the boxes in the thermal image of all who are told, frame by frame, the first one being 1."""
    rows = [
        (number, track.id, box, track.confidence)
        for number, tracks in enumerate(frames, start=1)
        for track, box in confirmed(tracks, THERMAL)
    ]
    return TrackBoxes(
        frame=np.array([row[0] for row in rows], int),
        id=np.array([row[1] for row in rows], int),
        box=np.array([row[2] for row in rows], float).reshape(-1, 4),
        confidence=np.array([row[3] for row in rows], float),
    )
