"""What trackers are told of the robot's cameras: where each sits, and which way its pixels look."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.geometry.pinhole import Camera
from peopleboy.tracker.calibration import Calibration, PinholeCalibration


def calibrations_of(cameras: Mapping[str, CameraConfig]) -> Mapping[str, Calibration]:
    """Give the calibration of each camera by its name."""
    return {name: _calibration(config.camera) for name, config in cameras.items()}


@lru_cache(maxsize=16)
def _calibration(camera: Camera) -> Calibration:
    return PinholeCalibration(camera.intrinsics, camera.robot_from_camera)
