"""Laser scans against cameras of one pixel that look along each beam."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import ColourConfig, LaserConfig, ThermalConfig
from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.geometry.scan_plane import ScanPlane
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import box_thing, config, hall, person

LASER = LaserConfig(camera=ScanPlane(fov_rad=math.radians(240.0), step_rad=math.radians(2.0)))
PLANE = LASER.camera
EXACT = replace(LASER, noise_m=0.0, farthest_m=60.0)
PEOPLE = (person("ahead", (7.0, 0.2)), person("hidden", (9.0, 0.3)), person("left", (4.3, 2.0)))
USUAL = {"thermal": ThermalConfig(), "colour": ColourConfig()}


def world_with(laser: LaserConfig | None = LASER, **settings: object) -> WorldConfig:
    bearings = PLANE.calibration.bearings.tolist()
    slit = replace(ColourConfig(), exposure_s=0.0, read_noise=0.0, shot_noise=0.0)
    slits = {
        f"beam_{k}": replace(
            slit, camera=Pinhole(width=1, height=1, position_m=PLANE.position_m, yaw_rad=bearing)
        )
        for k, bearing in enumerate(bearings)
    }
    cameras = USUAL | ({} if laser is None else slits | {"laser": laser})
    place = hall(box_thing("crate", (0.5, 0.4, 1.0), (5.0, -1.0, 0.5)))
    robot = RobotConfig(at_m=(2.0, 0.0), heading_rad=0.3, cameras=cameras)
    return replace(config(*PEOPLE, place=place, **settings), robot=robot)


def test_each_beam_reads_what_a_camera_of_one_pixel_sees_in_its_direction() -> None:
    with SimulatedWorld(world_with(EXACT)) as world:
        scan, truth = world.observe().images["laser"], world.truth("laser")
        slits = [world.truth(f"beam_{k}") for k in range(PLANE.width)]
    depth = np.array([slit.depth_m[0, 0] for slit in slits])
    assert np.allclose(truth.depth_m[0], depth, atol=2e-4)
    assert np.abs(scan[0] / 1000.0 - depth)[scan[0] > 0].max() <= 6e-4
    assert truth.instance[0].tolist() == [int(slit.instance[0, 0]) for slit in slits]
    assert {1, 3} <= set(truth.instance[0].tolist())


def test_outlines_and_visible_fractions_are_counts_of_beams() -> None:
    with SimulatedWorld(world_with(EXACT)) as world:
        truth = world.truth("laser")
    for one in truth.people:
        assert one.visible_px == np.count_nonzero(truth.instance == one.id)
        assert one.visible_fraction == pytest.approx(one.visible_px / one.whole_px)
        assert one.whole_box is not None
        assert one.whole_box[2] >= one.whole_px


def test_points_of_a_scan_lie_on_the_walls_of_the_world() -> None:
    with SimulatedWorld(world_with(EXACT)) as world:
        ranges, pose = world.observe().images["laser"][0], world.robot.world_from_robot()
        names = world.truth("laser").owners
    flat = PLANE.calibration.points(ranges / 1000.0)
    points = transform(pose, np.column_stack([flat, np.full(len(flat), PLANE.position_m[2])]))
    assert names is not None
    low_x, low_y, high_x, high_y = hall().bounds
    inside = (points[:, 0] > low_x - 0.01) & (points[:, 0] < high_x + 0.01)
    assert (inside & (points[:, 1] > low_y - 0.01) & (points[:, 1] < high_y + 0.01)).all()


def test_calibration_and_geometry_project_alike_and_rays_invert_it() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform([0.5, -3.0, 0.0], [6.0, 3.0, 2.0], (50, 3))
    by_tracker = PLANE.calibration.project(points)
    by_camera = PLANE.project(transform(invert_pose(PLANE.robot_from_camera), points))
    assert np.allclose(by_tracker, by_camera)
    away = points - PLANE.calibration.position_m
    assert np.allclose(
        PLANE.calibration.rays(by_tracker), away / np.linalg.norm(away, axis=1)[:, None], atol=1e-9
    )


def test_noise_has_its_deviation_and_what_lies_beyond_the_range_has_no_reading() -> None:
    laser = replace(LASER, farthest_m=4.0, noise_m=0.02)
    with SimulatedWorld(world_with(laser)) as world:
        exact, off = world.truth("laser").depth_m[0], []
        for _ in range(60):
            scan = world.observe().images["laser"][0]
            assert (scan[exact > 4.2] == 0).all()
            off.append((scan / 1000.0 - exact)[(exact > 0.5) & (exact < 3.5)])  # not on the robot itself
    assert np.std(off) == pytest.approx(0.02, rel=0.1)
    assert np.mean(off) == pytest.approx(0.0, abs=0.002)


def test_a_range_finder_changes_no_other_image_and_its_scans_do_not_depend_on_reading() -> None:
    with SimulatedWorld(world_with(None)) as bare, SimulatedWorld(world_with()) as world:
        for _ in range(3):
            bare.step(0.1, 0.1)
            world.step(0.1, 0.1)
            without, images = bare.observe().images, world.observe().images
            assert all(np.array_equal(without[name], images[name]) for name in USUAL)
        last = np.array(images["laser"])
    with SimulatedWorld(world_with()) as again:
        for _ in range(3):
            again.step(0.1, 0.1)
            seen = again.observe()
            if again.time_s > 0.1:
                scan = seen.images["laser"]
    assert np.array_equal(scan, last)


@pytest.mark.parametrize("physics", ["kinematic", "bullet"])
def test_both_physics_engines_give_scans(physics: str) -> None:
    with SimulatedWorld(world_with(EXACT, physics=physics)) as world:
        assert np.count_nonzero(world.observe().images["laser"]) > 0.9 * PLANE.width


@pytest.mark.parametrize(("fov", "step"), [(180.0, 0.7), (181.0, 1.0), (180.25, 0.5)])
def test_a_step_that_does_not_fit_is_refused(fov: float, step: float) -> None:
    with pytest.raises(BadInput, match="whole numbers of steps"):
        ScanPlane(fov_rad=math.radians(fov), step_rad=math.radians(step))
