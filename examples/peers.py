"""Trackers from other packages: `peopleboy run crossing_2 --tracker examples.peers:BackgroundSort`.

They need the packages `trackers` and `supervision`, and no GPU.
"""

import cv2
import numpy as np
import supervision as sv
from trackers import ByteTrackTracker, SORTTracker

from peopleboy import Frame, Status, Track


class Associated:
    """Base class: detections of single frames, associated by a tracker that uses only their boxes."""

    cameras = ("thermal",)
    tracker: SORTTracker | ByteTrackTracker

    def detect(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Return boxes (N, 4) [px], left, top, width, height, and confidences (N,)."""
        raise NotImplementedError

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Detect people, and associate the detections with tracks."""
        boxes, confidence = self.detect(frame)
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
        self.tracker = SORTTracker(frame_rate=15.0, lost_track_buffer=60)
        self._background = cv2.createBackgroundSubtractorMOG2(history=150, detectShadows=False)

    def detect(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Detect upright foreground blobs."""
        moving = cv2.morphologyEx(
            self._background.apply(frame.grey("thermal")), cv2.MORPH_CLOSE, np.ones((9, 5))
        )
        blobs = cv2.connectedComponentsWithStats(moving)[2][1:, :4].astype(np.float64)
        blobs = blobs[(blobs[:, 3] > 24) & (blobs[:, 3] > 1.1 * blobs[:, 2])]
        return as_torsos(blobs, 1.0), np.ones(len(blobs))


class HogByteTrack(Associated):
    """OpenCV's people detector on the enlarged thermal image, with ByteTrack."""

    def __init__(self, _rng: np.random.Generator) -> None:
        self.tracker = ByteTrackTracker(
            frame_rate=15.0,
            lost_track_buffer=60,
            track_activation_threshold=0.4,
            high_conf_det_threshold=0.4,
        )
        self._hog = cv2.HOGDescriptor()
        self._hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())

    def detect(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Detect people."""
        large = cv2.resize(frame.grey("thermal"), None, fx=2.0, fy=2.0)
        found, margin = self._hog.detectMultiScale(
            large, hitThreshold=-0.3, winStride=(8, 8), padding=(16, 16), scale=1.07
        )
        windows = np.reshape(found, (-1, 4)) / 2.0
        return as_torsos(windows, 0.76), 1.0 / (1.0 + np.exp(-2.0 * np.ravel(margin)))


def as_torsos(boxes: np.ndarray, share: float) -> np.ndarray:
    """Adapt boxes to those of the ground truth: the person's share of the height, and at most torso width."""
    height = share * boxes[:, 3:]
    size = np.hstack([np.minimum(boxes[:, 2:3], 0.27 * height), height])
    return np.hstack([boxes[:, :2] + (boxes[:, 2:] - size) / 2.0, size])
