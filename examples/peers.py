"""Trackers from other packages: `peopleboy run crossing_2 --tracker examples.peers:BackgroundSort`.

They associate the detections of `examples.detectors` in the thermal image. They need the packages `trackers`
and `supervision`, and no GPU.
"""

import numpy as np
import supervision as sv
from trackers import ByteTrackTracker, SORTTracker

from examples.detectors import Hog, MovingBlobs
from peopleboy import Frame, Status, Track


class Associated:
    """Base class: detections of single frames, associated by a tracker that uses only their boxes."""

    cameras = ("thermal",)
    detector: Hog | MovingBlobs
    tracker: SORTTracker | ByteTrackTracker

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Detect people, and associate the detections with tracks."""
        boxes, confidence = self.detector.detect(frame.grey("thermal"))
        corners = np.hstack([boxes[:, :2], boxes[:, :2] + boxes[:, 2:]])
        found = self.tracker.update(sv.Detections(xyxy=corners, confidence=confidence))
        rows = zip(np.ravel(found.tracker_id), found.xyxy, found.confidence, strict=True)
        return tuple(
            Track(
                id=int(number) + 1,
                boxes={"thermal": (float(x0), float(y0), float(x1 - x0), float(y1 - y0))},
                confidence=float(sure),
                status=Status.UNKNOWN,
                age_s=0.0,
            )
            for number, (x0, y0, x1, y1), sure in rows
            if number >= 0  # negative ids are not confirmed
        )


class BackgroundSort(Associated):
    """Background subtraction with SORT, for a standing robot."""

    def __init__(self, _rng: np.random.Generator) -> None:
        self.detector = MovingBlobs()
        self.tracker = SORTTracker(frame_rate=15.0, lost_track_buffer=60)


class HogByteTrack(Associated):
    """OpenCV's people detector on the enlarged thermal image, with ByteTrack."""

    def __init__(self, _rng: np.random.Generator) -> None:
        self.detector = Hog()
        self.tracker = ByteTrackTracker(
            frame_rate=15.0,
            lost_track_buffer=60,
            track_activation_threshold=0.4,
            high_conf_det_threshold=0.4,
        )
