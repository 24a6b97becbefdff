from __future__ import annotations

import math
from dataclasses import replace
from typing import get_args

from peopleboy.scenarios.files.equip_robot import equip_robot
from peopleboy.scenarios.files.schema.robot import CameraSpec, PlainCameraSpec, RobotSpec
from peopleboy.sim.cameras.camera_config import ColourConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import KINDS
from peopleboy.sim.cameras.presets import THERMAL_PRESETS
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.robot.robot_config import RobotConfig


def test_every_kind_has_its_keys_in_scenario_files() -> None:
    own = (spec for spec in get_args(CameraSpec) if spec is not PlainCameraSpec)
    assert {get_args(spec.model_fields["kind"].annotation)[0] for spec in own} == set(KINDS)
    assert all(kind.config.kind == name for name, kind in KINDS.items())


def test_what_is_left_out_is_usual_and_further_cameras_come_behind() -> None:
    spec = RobotSpec.model_validate(
        {
            "at_m": [1.0, 2.0],
            "cameras": {
                "rear": {"kind": "thermal", "yaw_deg": 180.0, "mount_m": [-0.3, 0.0, 1.3], "rate_hz": 5},
                "colour": {"kind": "colour", "width_px": 160, "exposure_s": 0.0},
            },
        }
    )
    cameras = equip_robot(spec).cameras
    assert list(cameras) == ["thermal", "colour", "rear"]
    assert cameras["thermal"] == RobotConfig().cameras["thermal"]
    assert cameras["colour"].camera.width == 160
    assert cameras["colour"].camera.vertical_fov_rad == ColourConfig().camera.vertical_fov_rad
    rear = Pinhole(yaw_rad=math.pi, position_m=(-0.3, 0.0, 1.3))
    assert cameras["rear"] == ThermalConfig(camera=rear, rate_hz=5)


def test_a_preset_stands_in_for_the_keys_that_are_left_out() -> None:
    thermal = {"kind": "thermal", "preset": "uncooled", "sharpening": 0.0, "blur_px": 1.0}
    spec = RobotSpec.model_validate({"at_m": [1.0, 2.0], "cameras": {"thermal": thermal}})
    assert equip_robot(spec).cameras["thermal"] == replace(
        THERMAL_PRESETS["uncooled"], sharpening=0.0, blur_px=1.0
    )
