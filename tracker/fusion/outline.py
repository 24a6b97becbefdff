"""The box of a person in the thermal image, from the sensors that see it best."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.fusion.person import Person
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Box

_LEAST_DEPTH_M: Final = 0.3


def outline(person: Person, frame: Frame, pose: RobotPose) -> Box | None:
    """Give left, top, width, height [px] in the thermal image, which may lie outside.

    Depth knows best where head and feet are, heat where the middle is, and how wide the torso appears just
    now. Whom only one of them sees has that one's box, in the person's own measures.

    Returns:
        None where neither can tell.
    """
    warm = person.warm
    standing = _standing(person, frame, pose)
    if warm is None or warm.box is None or not warm.is_clear:
        return standing
    left, top, width, height = warm.box
    if standing is None:
        return warm.box
    if person.deep is None:
        standing = (left, top, standing[2] * height / standing[3], height)
    return left + (width - standing[2]) / 2.0, standing[1], standing[2], standing[3]


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
