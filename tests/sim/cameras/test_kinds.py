from __future__ import annotations

import math
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import COLOUR_BASELINE_M, CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.imaging.camera_view import CameraView
from peopleboy.sim.cameras.imaging.noise import gaussian, skip_gaussian
from peopleboy.sim.cameras.kinds import KINDS, CameraKind, affine_between, image_folders
from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import SMALL, config, person, robot


@dataclass(frozen=True, slots=True, kw_only=True)
class NearConfig(CameraConfig):
    """A camera that sees how near things are."""

    kind: ClassVar[str] = "near"


class NearSensor:
    """Gives 255 at the lens, and 0 from 10 m on."""

    def __init__(self, config: NearConfig, name: str, seed: int) -> None:
        del config, name, seed

    def take(self, glimpse: CameraView) -> tuple[np.ndarray, ...]:
        return (np.uint8(255.0 * np.clip(1.0 - glimpse.view.depth / 10.0, 0.0, 1.0)),)

    def skip(self) -> None:
        pass


def seen_by(cameras: Mapping[str, CameraConfig]) -> WorldConfig:
    """One person before a robot with these cameras."""
    return config(person("anna", (4.0, 0.0)), robot=RobotConfig(at_m=(1.0, 0.0), cameras=cameras))


def test_a_kind_is_added_by_one_entry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "near", CameraKind(config=NearConfig, sensor=NearSensor))
    cameras = {**robot().cameras, "scout": NearConfig(camera=SMALL)}
    with SimulatedWorld(
        config(person("anna", (4.0, 0.0)), robot=RobotConfig(at_m=(1.0, 0.0), cameras=cameras))
    ) as world:
        image, truth = world.observe().images["scout"], world.truth("scout")
    depth = truth.depth_m[truth.instance == 1]
    assert len(depth) > 100
    assert image[truth.instance == 1] == pytest.approx(255.0 * (1.0 - depth / 10.0), abs=1.0)


def test_the_usual_cameras_have_the_folders_that_they_should() -> None:
    folders = [folder for folder, _, _ in image_folders(RobotConfig().cameras)]
    assert folders == [
        "thermal",
        "thermal16",
        "thermal_scene",
        "colour",
    ]


@pytest.mark.parametrize("name", ["thermal16", "thermal_c", "Rear", "rear view", ""])
def test_names_that_clash_or_are_none_are_refused(name: str) -> None:
    with pytest.raises(BadInput, match="camera"):
        RobotConfig(cameras={"thermal": ThermalConfig(), name: ColourConfig()})


def test_a_robot_without_a_thermal_camera_is_refused() -> None:
    with pytest.raises(BadInput, match="kind 'thermal'"):
        RobotConfig(cameras={"thermal": ColourConfig()})


def test_cameras_cannot_be_changed_and_can_be_sent_to_other_processes() -> None:
    cameras = {"thermal": ThermalConfig()}
    one = RobotConfig(cameras=cameras)
    cameras["colour"] = ColourConfig()
    assert list(one.cameras) == ["thermal"]
    with pytest.raises(TypeError):
        one.cameras["colour"] = ColourConfig()  # type: ignore[index]
    assert pickle.loads(pickle.dumps(one)) == one
    assert hash(one) == hash(RobotConfig(cameras={"thermal": ThermalConfig()}))


def test_a_rate_that_does_not_divide_is_refused() -> None:
    cameras = {**robot().cameras, "slow": ThermalConfig(rate_hz=4)}
    with pytest.raises(BadInput, match=r"cameras\.slow\.rate_hz: 4 must divide the control rate, 15 Hz"):
        config(robot=RobotConfig(cameras=cameras))


def test_images_and_truths_of_an_instant_that_is_over_are_refused() -> None:
    with SimulatedWorld(config(person("anna", (4.0, 0.0)))) as world:
        before, truths = world.observe().images, world.truths()
        kept = before["thermal"]
        world.step(0.0, 0.0)
        assert before["thermal"] is kept
        with pytest.raises(BadInput, match=r"'colour': .* read it before the next step"):
            before["colour"]
        with pytest.raises(BadInput, match="'colour': the truth of an earlier instant"):
            truths["colour"]
        with pytest.raises(BadInput, match=r"unknown camera 'rear'; choose from thermal, colour"):
            world.truth("rear")


def test_a_skipped_image_leaves_the_generator_as_a_drawn_one_does() -> None:
    one, other = np.random.default_rng(3), np.random.default_rng(3)
    gaussian((5, 7, 3), one)
    skip_gaussian((5, 7, 3), other)
    assert one.bit_generator.state == other.bit_generator.state


def test_the_truth_of_a_camera_is_that_of_its_own_image() -> None:
    high = Pinhole(width=96, height=64, position_m=(0.14, 0.0, 2.0), pitch_rad=0.3)
    cameras = {**robot().cameras, "high": ThermalConfig(camera=high)}
    with SimulatedWorld(
        config(person("anna", (4.0, 0.0)), robot=RobotConfig(at_m=(1.0, 0.0), cameras=cameras))
    ) as world:
        truth, usual = world.truth("high"), world.truth()
    assert truth.instance.shape == (64, 96)
    assert truth.camera == high
    rows, columns = np.nonzero(truth.instance)
    span = (columns.min() - 0.5, rows.min() - 0.5, np.ptp(columns) + 1.0, np.ptp(rows) + 1.0)
    assert truth.people[0].visible_box == pytest.approx(span)
    assert truth.people[0].joints_m == pytest.approx(usual.people[0].joints_m)


ROBOT = RobotConfig()
THERMAL, COLOUR = ROBOT.cameras["thermal"].camera, ROBOT.cameras["colour"].camera


@given(depth_m=st.floats(0.5, 20.0), x=st.floats(-3.0, 3.0), y=st.floats(-3.0, 3.0))
def test_a_point_at_the_depth_falls_where_the_affine_says(depth_m: float, x: float, y: float) -> None:
    point = np.array([x, y, depth_m])
    u, v = THERMAL.project(point)
    colour_from_thermal = invert_pose(COLOUR.robot_from_camera) @ THERMAL.robot_from_camera
    expected = COLOUR.project(transform(colour_from_thermal, point))
    assert affine_between(THERMAL, COLOUR, depth_m) @ (u, v, 1.0) == pytest.approx(expected, abs=1e-6)


@given(depth_m=st.floats(0.5, 50.0))
def test_the_default_cameras_have_the_scale_of_equation_6_1_and_the_parallax_of_their_baseline(
    depth_m: float,
) -> None:
    affine = affine_between(THERMAL, COLOUR, depth_m)
    u, v = THERMAL.centre_px
    # The colour camera is on the left, so that it sees things farther right.
    parallax = COLOUR.focal_px * COLOUR_BASELINE_M / depth_m
    expected = [[1.2, 0.0, u - 1.2 * u + parallax], [0.0, 1.2, v - 1.2 * v]]
    assert affine == pytest.approx(np.array(expected), abs=1e-7)


def test_far_away_the_parallax_vanishes() -> None:
    assert affine_between(THERMAL, COLOUR, 1e7) @ (*THERMAL.centre_px, 1.0) == pytest.approx(
        COLOUR.centre_px, abs=1e-3
    )


def test_a_turned_camera_is_fitted_within_one_percent_of_the_image_on_average() -> None:
    turned = Pinhole(yaw_rad=math.radians(4.0))
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-2.0, 2.0, 21), np.linspace(-1.5, 1.5, 21)))
    points = np.stack([x, y, np.full_like(x, 4.0)], axis=1)
    pixels = np.column_stack([THERMAL.project(points), np.ones_like(x)])
    expected = turned.project(
        transform(invert_pose(turned.robot_from_camera) @ THERMAL.robot_from_camera, points)
    )
    away = np.linalg.norm(pixels @ affine_between(THERMAL, turned, 4.0).T - expected, axis=1)
    assert away.mean() < 0.01 * THERMAL.width


@pytest.mark.parametrize("depth_m", [0.0, -1.0, math.nan])
def test_a_depth_that_is_not_positive_is_refused(depth_m: float) -> None:
    with pytest.raises(BadInput, match="must be positive"):
        affine_between(THERMAL, COLOUR, depth_m)


def test_cameras_that_look_away_from_each_other_are_refused() -> None:
    with pytest.raises(BadInput, match="does not see"):
        affine_between(THERMAL, Pinhole(yaw_rad=math.pi), 4.0)
