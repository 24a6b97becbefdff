"""From what a scenario file says about the robot to its settings: start and cameras."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.schema.robot import CameraSpec, RobotSpec
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import KINDS
from peopleboy.sim.cameras.presets import DEPTH_PRESETS, THERMAL_PRESETS
from peopleboy.sim.geometry.panorama import MIRRORS, Mirror
from peopleboy.sim.robot.robot_config import RobotConfig

_IN_DEGREES = {"vertical_fov_deg": "vertical_fov_rad", "pitch_deg": "pitch_rad", "yaw_deg": "yaw_rad"}
_RENAMED = {"width_px": "width", "height_px": "height", "mount_m": "position_m"}
_PRESETS: Mapping[str, CameraConfig] = {**DEPTH_PRESETS, **THERMAL_PRESETS}
_KEYS = {field: key for key, field in (_IN_DEGREES | _RENAMED).items()}


def equip_robot(spec: RobotSpec) -> RobotConfig:
    """The robot's settings: the usual ones, but for what the file changes.

    Raises:
        BadInput: cameras clash, or one has no such key.
    """
    usual = RobotConfig()
    own = {name: _camera(name, camera) for name, camera in spec.cameras.items()}
    return replace(
        usual,
        at_m=spec.at_m,
        heading_rad=math.radians(spec.heading_deg),
        cameras={**usual.cameras, **own},
    )


def _camera(name: str, spec: CameraSpec) -> CameraConfig:
    """A camera as usual for its kind, but for what the file says."""
    given: dict[str, Any] = spec.model_dump(exclude_none=True)
    kind, mirror = given.pop("kind"), given.pop("mirror", None)
    preset = given.pop("preset", None)
    usual = KINDS[kind].config() if preset is None else _PRESETS[preset]
    geometry = {_RENAMED[key]: given.pop(key) for key in _RENAMED if key in given}
    geometry |= {_IN_DEGREES[key]: math.radians(given.pop(key)) for key in _IN_DEGREES if key in given}
    if mirror is not None:
        with found_in(name, "mirror"):
            geometry["mirror"] = _mirror(mirror)
    for unknown in geometry.keys() - {field.name for field in fields(usual.camera)}:
        raise BadInput(f"{name}.{_KEYS[unknown]}: a camera of the kind {kind!r} has none; leave it out")
    with found_in(name):
        return replace(usual, camera=replace(usual.camera, **geometry), **given)


def _mirror(said: str | dict[str, float]) -> Mirror:
    """A mirror by its name, or the usual one but for some values."""
    if isinstance(said, str):
        return MIRRORS[said]
    radians = {f"{key[:-4]}_rad": math.radians(said[key]) for key in said if key.endswith("_deg")}
    return replace(Mirror(), **radians, **{key: said[key] for key in said if key.endswith("_m")})
