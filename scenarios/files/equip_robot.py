"""From what a scenario file says about the robot to its settings: start and cameras."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from peopleboy.scenarios.files.schema.robot import CameraSpec, RobotSpec, ThermalSpec
from peopleboy.sim.geometry.pinhole import Camera
from peopleboy.sim.robot.robot_config import RobotConfig

_IN_DEGREES = {"vertical_fov_deg": "vertical_fov_rad", "pitch_deg": "pitch_rad", "yaw_deg": "yaw_rad"}
_RENAMED = {"width_px": "width", "height_px": "height", "mount_m": "position_m"}


def equip_robot(spec: RobotSpec) -> RobotConfig:
    """The robot's settings: the usual ones, but for what the file changes."""
    usual = RobotConfig()
    thermal, colour = usual.thermal, usual.colour
    return replace(
        usual,
        at_m=spec.at_m,
        heading_rad=math.radians(spec.heading_deg),
        thermal=replace(thermal, camera=_camera(thermal.camera, spec.thermal), **_imaging(spec.thermal)),
        colour=replace(colour, camera=_camera(colour.camera, spec.colour), **_imaging(spec.colour)),
    )


def _camera(usual: Camera, spec: CameraSpec) -> Camera:
    given = spec.model_dump(exclude_none=True)
    changes: dict[str, Any] = {_RENAMED[key]: given[key] for key in _RENAMED if key in given}
    changes |= {_IN_DEGREES[key]: math.radians(given[key]) for key in _IN_DEGREES if key in given}
    return replace(usual, **changes)


def _imaging(spec: CameraSpec | ThermalSpec) -> dict[str, Any]:
    """What is not geometry."""
    given = spec.model_dump(exclude_none=True)
    return {key: value for key, value in given.items() if key not in _RENAMED and key not in _IN_DEGREES}
