from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.scenario_file import json_schema
from peopleboy.scenarios.files.validation import validated
from peopleboy.settings import settings_of
from peopleboy.sim.cameras.camera_config import CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import KINDS, THERMAL_PRESETS
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.robot.robot_config import RobotConfig


def robot(**cameras: Any) -> RobotSpec:
    return validated(RobotSpec, {"at_m": [1.0, 2.0], "cameras": cameras})


def test_every_kind_is_called_as_its_settings_say() -> None:
    assert all(kind.config.kind == name for name, kind in KINDS.items())


@pytest.mark.parametrize("name", KINDS)
def test_the_keys_of_a_camera_are_the_settings_of_its_kind(name: str) -> None:
    keys = json_schema()["$defs"][f"{name.capitalize()}Camera"]["properties"]
    settings = [*settings_of(KINDS[name].config), *settings_of(type(KINDS[name].config().camera))]
    assert keys.keys() - {"kind", "preset"} == {one.key for one in settings if one.meaning}
    assert ("preset" in keys) == bool(KINDS[name].presets)
    assert all(one.meaning or one.field == "camera" for one in settings)


def test_a_key_tells_the_default_that_its_setting_has() -> None:
    keys = json_schema()["$defs"]["ThermalCamera"]["properties"]
    assert (keys["netd_k"]["default"], keys["vertical_fov_deg"]["default"]) == (0.08, 44.0)
    assert json_schema()["$defs"]["DepthCamera"]["properties"]["width_px"]["default"] == 640


def test_what_is_left_out_is_usual_and_further_cameras_come_behind() -> None:
    cameras = (
        robot(
            rear={"kind": "thermal", "yaw_deg": 180.0, "mount_m": [-0.3, 0.0, 1.3], "rate_hz": 5},
            colour={"kind": "colour", "width_px": 160, "exposure_s": 0.0},
        )
        .config()
        .cameras
    )
    assert list(cameras) == ["thermal", "colour", "rear"]
    assert cameras["thermal"] == RobotConfig().cameras["thermal"]
    assert cameras["colour"].camera.width == 160
    assert isinstance(cameras["colour"], ColourConfig)
    assert cameras["colour"].camera.vertical_fov_rad == ColourConfig().camera.vertical_fov_rad
    rear = Pinhole(yaw_rad=math.pi, position_m=(-0.3, 0.0, 1.3))
    assert cameras["rear"] == ThermalConfig(camera=rear, rate_hz=5)


def test_a_preset_stands_in_for_the_keys_that_are_left_out() -> None:
    given = {"kind": "thermal", "preset": "uncooled", "sharpening": 0.0, "blur_px": 1.0}
    expected: CameraConfig = replace(THERMAL_PRESETS["uncooled"], sharpening=0.0, blur_px=1.0)
    assert robot(thermal=given).config().cameras["thermal"] == expected
