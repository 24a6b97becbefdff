"""Motion of the level frame between two frames: by odometry, or else as the images show it."""

import math
from typing import Any, Final, NamedTuple, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import THERMAL, Floats, Frame, Odometry
from peopleboy.tracker.tracking.viewpoint import Viewpoint

Grey = NDArray[np.uint8]

_STILL_PX: Final = 0.5
"""Shift in the middle of the image up to which a camera counts as standing."""
_UNSURE: Final = 0.3
"""Standard deviation of a rotation that images show, relative to the rotation, as the field of view of the
camera is not known. Chosen on `camel_11`; with 0.6 nothing changes."""


class FrameMotion(NamedTuple):
    """Rigid motion of points of the level frame: a step, then a rotation.

    Attributes:
        turn: (3, 3) rotation.
        step_m: (3,) [m] subtracted from points.
        unsure_rad: [rad] standard deviation of the rotation to the side, and up or down.
    """

    turn: Floats
    step_m: Floats
    unsure_rad: float = 0.0

    @classmethod
    def of(cls, moved: Odometry) -> Self:
        """Return the motion of a robot."""
        cosine, sine = math.cos(moved.turn_rad), math.sin(moved.turn_rad)
        turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
        return cls(turn, np.array([-moved.aside_m, 0.0, moved.advance_m]))


STANDING: Final = FrameMotion.of(Odometry())


class CameraMotion:
    """Estimates how the level frame moved since the last frame.

    Without odometry, an uncalibrated thermal camera is assumed to rotate, as its images show.
    """

    def __init__(self) -> None:
        self._last: Grey | None = None

    def update(self, frame: Frame) -> FrameMotion:
        """Return the motion since the last frame."""
        if frame.odometry is not None:
            return FrameMotion.of(frame.odometry)
        if THERMAL not in frame.images or THERMAL in frame.calibrations:
            return STANDING
        last, self._last = self._last, frame.grey(THERMAL).copy()
        if last is None or last.shape != self._last.shape:
            return STANDING
        return rotation_between(seen_homography(last, self._last), (last.shape[0], last.shape[1]))


def rotation_between(moved: Floats, shape: tuple[int, int]) -> FrameMotion:
    """Return the rotation of an uncalibrated camera from the motion (3, 3) of pixels in its images."""
    view = Viewpoint.of(None, shape)
    middle = np.array([*view.centre_px, 1.0])
    right_px, down_px, _ = (moved @ middle - middle).tolist()
    shift_px = math.hypot(right_px, down_px)
    if shift_px < _STILL_PX:
        return STANDING
    focal_px = view.focal_px[0]
    roll_rad = math.atan2(moved[1, 0], moved[0, 0])
    turn, _ = cv2.Rodrigues(np.array([-down_px / focal_px, right_px / focal_px, roll_rad]))
    return FrameMotion(np.asarray(turn, np.float64), np.zeros(3), _UNSURE * shift_px / focal_px)


_MOST_CORNERS: Final = 150
_FEWEST_CORNERS: Final = 8
_WEAKEST: Final = 0.01  # quality of the weakest corner, relative to the best
_APART_PX: Final = 8
_WINDOW_PX: Final = (15, 15)
_HALVINGS: Final = 3  # follows up to about 50 px
_OFF_PX: Final = 1.0
_LEAST_AGREEING: Final = 0.5  # share of the corners
_STAYS_PX: Final = 0.25
_MOST_STAYING: Final = 0.2  # share of the corners, as of figures that are burnt in


def seen_homography(before: Grey, now: Grey) -> Floats:
    """Estimate the shift, rotation and scale (3, 3) of pixels (u, v, 1) between two images of a scene.

    Corners are followed from one to the other (Lucas and Kanade 1981). Most of them must agree, and few may
    stay where they were: people who walk in front of a standing camera may have most of the corners, but not
    all. Otherwise the camera counts as standing.
    """
    before, now = np.ascontiguousarray(before), np.ascontiguousarray(now)
    corners: Any = cv2.goodFeaturesToTrack(before, _MOST_CORNERS, _WEAKEST, _APART_PX)
    if corners is None:  # in an image without any
        return np.eye(3)
    there, is_found, _ = cv2.calcOpticalFlowPyrLK(
        before, now, corners, np.empty_like(corners), winSize=_WINDOW_PX, maxLevel=_HALVINGS
    )
    followed = is_found.ravel() > 0
    way = (there - corners)[followed].reshape(-1, 2)
    if len(way) < _FEWEST_CORNERS or (np.hypot(*way.T) < _STAYS_PX).mean() > _MOST_STAYING:
        return np.eye(3)
    moved, agrees = cv2.estimateAffinePartial2D(
        corners[followed], there[followed], method=cv2.RANSAC, ransacReprojThreshold=_OFF_PX
    )
    if moved is None or agrees.mean() < _LEAST_AGREEING:
        return np.eye(3)
    return np.vstack([moved, [0.0, 0.0, 1.0]])
