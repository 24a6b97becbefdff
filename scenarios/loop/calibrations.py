"""What trackers are told of the robot's cameras: where each sits, and which way its pixels look."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, singledispatch

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.frame import Calibration, PinholeCalibration


def calibrations_of(cameras: Mapping[str, CameraConfig]) -> Mapping[str, Calibration]:
    """Give the calibration of each camera by its name; geometries without one are left out."""
    found = {name: calibration_of(config.camera) for name, config in cameras.items()}
    return {name: calibration for name, calibration in found.items() if calibration is not None}


@singledispatch
def calibration_of(geometry: object) -> Calibration | None:  # noqa: ARG001
    """Tell a tracker of a camera's geometry; a new kind of geometry registers here."""
    return None


@calibration_of.register
@lru_cache(maxsize=16)
def _(geometry: Pinhole) -> Calibration:
    return PinholeCalibration(geometry.intrinsics, geometry.robot_from_camera)
