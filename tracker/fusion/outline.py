"""The box of a person in the thermal image, from the sensors that see it best."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from peopleboy.tracker.frame import THERMAL, Frame, PinholeCalibration
from peopleboy.tracker.fusion.person import Person
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Box

_NEAREST_M: Final = 0.3

# Width of the torso as a share of the height, of the contour's width, and of the width by depth; by least
# squares on seed 100 of seven scenarios.
_TORSO: Final = (0.045, 0.32, 0.47)
_TORSO_BY_HEAT: Final = (0.065, 0.715)


def outline(person: Person, frame: Frame, pose: RobotPose) -> Box | None:
    """Give left, top, width, height [px] in the thermal image, which may lie outside.

    Depth knows best where head and feet are, heat where the middle is. Whom only one of them sees has the
    ends of that one.

    Returns:
        None for who is not ahead, and not in the thermal image either.
    """
    contour = _contour(person)
    standing = standing_box(person, THERMAL, frame, pose)
    if contour is None or standing is None:
        return contour or standing
    left, top, width, height = contour
    if person.deep is not None:
        _, top, torso, tall = standing
    else:
        torso, tall = standing[2] * height / standing[3], height
    return left + (width - torso) / 2.0, top, torso, tall


def with_width(person: Person, frame: Frame, pose: RobotPose, share: float) -> Person:
    """Learn how wide the torso appears, which changes as the person turns; not of who is hidden in part."""
    contour, standing = _contour(person), standing_box(person, THERMAL, frame, pose)
    if contour is None:
        return person
    _, _, width, height = contour
    deep = person.deep
    if deep is not None and deep.is_clear and deep.span_m is not None and standing is not None:
        tall, by_heat, by_depth = _TORSO
        wide = person.tall_m * (tall + by_heat * width / standing[3]) + by_depth * deep.span_m
    else:
        tall, by_heat = _TORSO_BY_HEAT
        wide = person.tall_m * (tall + by_heat * width / height)
    return replace(person, wide_m=person.wide_m + share * (wide - person.wide_m))


def standing_box(person: Person, camera: str, frame: Frame, pose: RobotPose) -> Box | None:
    """Project a person, upright at its place, in its own measures.

    Returns:
        left, top, width, height [px]; None for who is not before a camera, or one whose image is not flat.
    """
    calibration = frame.calibrations.get(camera)
    x, y = pose.locate(person.motion.place_m).tolist()
    is_flat = isinstance(calibration, PinholeCalibration)
    if calibration is None or not is_flat or x - calibration.position_m[0] < _NEAREST_M:
        return None
    (u, top), (_, bottom) = calibration.project(np.array([[x, y, person.tall_m], [x, y, 0.0]])).tolist()
    width = (bottom - top) * person.wide_m / person.tall_m
    return u - width / 2.0, top, width, bottom - top


def _contour(person: Person) -> Box | None:
    """Give the thermal tracker's box of who is seen whole."""
    return person.warm.box if person.warm is not None and person.warm.is_clear else None
