"""The box of a person in the thermal image, from the sensors that see it best."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.fusion.person import Person
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Box

_LEAST_DEPTH_M: Final = 0.3


def outline(person: Person, frame: Frame, pose: RobotPose, torso_per_contour: float) -> Box | None:
    """Give left, top, width, height [px] in the thermal image, which may lie outside.

    Depth knows best where head and feet are, heat where the middle is, and how wide the torso appears just
    now. Whom only one of them sees has that one's box, in the person's own measures.

    Returns:
        None where neither can tell.
    """
    warm = person.warm
    contour = None if warm is None or warm.box is None else widened(warm.box, torso_per_contour)
    is_clear = warm is not None and warm.is_clear
    standing = _standing(person, frame, pose)
    if standing is None or (is_clear and person.deep is None):
        return contour or standing
    if contour is None or not is_clear:
        return standing
    return contour[0], standing[1], contour[2], standing[3]


def widened(box: Box, factor: float) -> Box:
    """Give a box of another width about the same middle."""
    left, top, width, height = box
    return left + width * (1.0 - factor) / 2.0, top, width * factor, height


def _standing(person: Person, frame: Frame, pose: RobotPose) -> Box | None:
    """Project a person, upright at its place, in its own measures; None for who is not ahead."""
    calibration = frame.calibrations.get(THERMAL)
    if calibration is None:
        return None
    x, y = pose.locate(person.motion.place_m).tolist()
    if x - calibration.position_m[0] < _LEAST_DEPTH_M:
        return None
    (u, top), (_, bottom) = calibration.project(np.array([[x, y, person.tall_m], [x, y, 0.0]])).tolist()
    width = (bottom - top) * person.wide_m / person.tall_m
    return u - width / 2.0, top, width, bottom - top
