"""What trackers know of the robot's cameras: where each sits, and which way its pixels look."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, singledispatch

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.frame import Calibration, PinholeCalibration
from peopleboy.tracker.panorama_calibration import PanoramaCalibration


def calibrations_of(cameras: Mapping[str, CameraConfig]) -> Mapping[str, Calibration]:
    """Return the calibration of each camera by its name; geometries without one are left out."""
    found = {name: calibration_of(config.camera) for name, config in cameras.items()}
    return {name: calibration for name, calibration in found.items() if calibration is not None}


@singledispatch
def calibration_of(geometry: object) -> Calibration | None:  # noqa: ARG001
    """Return a tracker of a camera's geometry; a new kind of geometry registers here."""
    return None


@calibration_of.register
@lru_cache(maxsize=16)
def _(geometry: Pinhole) -> Calibration:
    return PinholeCalibration(geometry.intrinsics, geometry.robot_from_camera)


@calibration_of.register
@lru_cache(maxsize=16)
def _(geometry: Panorama) -> Calibration:
    mirror = geometry.mirror
    return PanoramaCalibration(
        width=geometry.width,
        height=geometry.height,
        focal_px=geometry.focal_px,
        axis_rad=mirror.axis_rad,
        ring_radius_m=mirror.ring_radius_m,
        ring_height_m=mirror.ring_height_m,
    )
