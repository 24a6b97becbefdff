"""Tracks as lines of JSON on standard output, for other programs to read while tracking."""

import json
import os
import sys
from collections.abc import Sequence
from typing import Any

from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track, confirmed


class TrackLines:
    """Prints the tracks of each image as one line.

    Args:
        camera: name of the camera in whose image boxes are.
    """

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._is_closed = False

    def show(self, number: int, frame: Frame, tracks: Sequence[Track]) -> bool:
        """Print a line, and return whether the reader has closed standard output."""
        if self._is_closed:
            return True
        line = {
            "frame": number,
            "time_s": round(frame.time_s, 6),
            "tracks": [_track(track, box) for track, box in confirmed(tracks, self._camera)],
        }
        try:
            print(json.dumps(line), flush=True)
        except BrokenPipeError:
            self._is_closed = True
            # Python flushes standard output at exit, which would fail again.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return self._is_closed


def _track(track: Track, box: Sequence[float]) -> dict[str, Any]:
    return {
        "id": track.id,
        "box_px": [round(edge, 2) for edge in box],
        "position_m": None if track.place is None else [round(m, 3) for m in track.place.position_m],
        "status": str(track.status),
        "confidence": round(track.confidence, 3),
    }
