"""Detectors from OpenCV: `peopleboy run crossing_2 --detector examples.detectors:Hog`.

Each returns boxes (N, 4) [px], left, top, width, height, and probabilities (N,). The boxes are fitted to
torsos, as the ground truth.
"""

import cv2
import numpy as np


class Hog:
    """OpenCV's people detector on the enlarged image."""

    camera = "colour"

    def __init__(self) -> None:
        self._hog = cv2.HOGDescriptor()
        self._hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())

    def detect(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Detect people."""
        large = cv2.resize(image, None, fx=2.0, fy=2.0)
        found, margin = self._hog.detectMultiScale(
            large, hitThreshold=-0.3, winStride=(8, 8), padding=(16, 16), scale=1.07
        )
        windows = np.reshape(found, (-1, 4)) / 2.0
        return as_torsos(windows, 0.76), 1.0 / (1.0 + np.exp(-2.0 * np.ravel(margin)))


class MovingBlobs:
    """Background subtraction in the thermal image, for a standing robot."""

    camera = "thermal"

    def __init__(self) -> None:
        self._background = cv2.createBackgroundSubtractorMOG2(history=150, detectShadows=False)

    def detect(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Detect upright foreground blobs."""
        moving = cv2.morphologyEx(self._background.apply(image), cv2.MORPH_CLOSE, np.ones((9, 5)))
        blobs = cv2.connectedComponentsWithStats(moving)[2][1:, :4].astype(np.float64)
        blobs = blobs[(blobs[:, 3] > 24) & (blobs[:, 3] > 1.1 * blobs[:, 2])]
        return as_torsos(blobs, 1.0), np.ones(len(blobs))


def as_torsos(boxes: np.ndarray, share: float) -> np.ndarray:
    """Adapt boxes to those of the ground truth: the person's share of the height, and at most torso width."""
    height = share * boxes[:, 3:]
    size = np.hstack([np.minimum(boxes[:, 2:3], 0.27 * height), height])
    return np.hstack([boxes[:, :2] + (boxes[:, 2:] - size) / 2.0, size])
