"""Panoramas against ordinary cameras that stand on the mirror's ring and look along one column each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.sim.cameras.camera_config import ColourConfig, PanoramaConfig, ThermalConfig
from peopleboy.sim.geometry.panorama import MIRRORS, Panorama
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.panoramic_renderer import first_and_last
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.worlds.small_worlds import box_thing, config, hall, person

COLUMNS = (*range(0, 480, 7), 239, 240, 479)
PEOPLE = (
    person("ahead", (7.0, 0.2)),
    person("hidden", (9.0, 0.9)),
    person("left", (4.3, 2.0)),
    person("behind", (1.5, 0.0)),
    person("near", (3.9, -0.9)),
)


def column_camera(camera: Panorama, u: int) -> Pinhole:
    """Look as column u does: the panorama's rows are the upper half of this one's."""
    mirror, bearing = camera.mirror, float(camera.bearing(u))
    radius = mirror.ring_radius_m
    return Pinhole(
        width=1,
        height=2 * camera.height,
        vertical_fov_rad=2.0 * mirror.lens_half_angle_rad,
        position_m=(radius * math.cos(bearing), radius * math.sin(bearing), mirror.ring_height_m),
        pitch_rad=mirror.axis_rad,
        yaw_rad=bearing,
    )


CAMERAS = {name: PanoramaConfig(camera=Panorama(mirror=mirror)) for name, mirror in MIRRORS.items()}
SLITS = {
    f"{name}_{u}": replace(
        ColourConfig(), camera=column_camera(one.camera, u), exposure_s=0.0, read_noise=0.0, shot_noise=0.0
    )
    for name, one in CAMERAS.items()
    for u in COLUMNS
}
QUIET = {
    f"quiet_{name}": replace(one, exposure_s=0.0, read_noise=0.0, shot_noise=0.0)
    for name, one in CAMERAS.items()
}


@pytest.fixture(scope="module")
def world() -> Iterator[SimulatedWorld]:
    box = box_thing("box", (0.4, 0.5, 0.6), (5.6, -1.5, 0.3))
    cameras = {"thermal": ThermalConfig(), "colour": ColourConfig(), **CAMERAS, **QUIET, **SLITS}
    robot = RobotConfig(at_m=(4.0, 0.0), cameras=cameras)
    with SimulatedWorld(config(*PEOPLE, place=hall(box), robot=robot)) as world:
        for _ in range(8):
            world.step(0.1, 0.4)
        yield world


@pytest.mark.parametrize("name", CAMERAS)
def test_each_column_is_what_a_camera_that_looks_that_way_sees(world: SimulatedWorld, name: str) -> None:
    camera, seen = CAMERAS[name].camera, world.truth(name)
    rows = np.arange(camera.height)
    outwards = np.cos(camera.depression(rows)) / np.cos(camera.mirror.axis_rad - camera.depression(rows))
    for u in COLUMNS:
        slit = world.truth(f"{name}_{u}")
        above = np.s_[: camera.height, 0]
        np.testing.assert_array_equal(seen.instance[:, u], slit.instance[above])
        np.testing.assert_array_equal(seen.body_part[:, u], slit.body_part[above])
        distance = camera.mirror.ring_radius_m + slit.depth_m[above] * outwards
        np.testing.assert_allclose(seen.depth_m[:, u], distance, rtol=2e-6)


@pytest.mark.parametrize("name", CAMERAS)
def test_each_column_has_the_colours_that_camera_sees(world: SimulatedWorld, name: str) -> None:
    images = world.observe().images
    for u in COLUMNS:
        slit = images[f"{name}_{u}"][:120, 0].astype(int)
        off = np.abs(images[f"quiet_{name}"][:, u].astype(int) - slit).max(axis=1)
        # A pixel on the very edge of a pattern's field may round to the other field.
        assert np.count_nonzero(off > 1) <= 1


def test_boxes_and_areas_count_on_over_the_seam(world: SimulatedWorld) -> None:
    truth = world.truth("default")
    for who in truth.people:
        mask = truth.instance == who.id
        assert who.visible_px == np.count_nonzero(mask)
        left, top, width, height = who.visible_box
        rows = np.flatnonzero(mask.any(axis=1))
        assert (top, height) == (rows[0] - 0.5, rows[-1] - rows[0] + 1)
        columns = np.arange(round(left + 0.5), round(left + 0.5 + width)) % 480
        assert -0.5 <= left < 479.5
        assert mask[:, columns].sum() == mask.sum()
        assert mask[:, columns[0]].any()
        assert mask[:, columns[-1]].any()
        whole_left, _, whole_width, _ = who.whole_box
        assert (left - whole_left) % 480 + width <= whole_width


@pytest.fixture
def turned() -> Iterator[SimulatedWorld]:
    cameras = {"thermal": ThermalConfig(), "panorama": PanoramaConfig()}
    people = (person("ahead", (9.0, 0.0)), person("behind", (4.0, 0.05)), person("hidden", (2.6, 0.1)))
    with SimulatedWorld(config(*people, robot=RobotConfig(at_m=(6.4, 0.0), cameras=cameras))) as world:
        yield world


def test_who_stands_behind_the_robot_spans_the_seam_and_hides_others(turned: SimulatedWorld) -> None:
    _, behind, hidden = turned.truth("panorama").people
    for box in (behind.box, behind.whole_box, behind.visible_box):
        assert 460.0 < box[0] < 479.5 < box[0] + box[2] < 500.0
    assert behind.hidden_by.keys() <= {"border"}
    assert hidden.hidden_by["behind"] > 0.5
    assert hidden.visible_fraction + sum(hidden.hidden_by.values()) == pytest.approx(1.0)
    assert behind.joints_px[:, 0].min() < 20.0
    assert behind.joints_px[:, 0].max() > 460.0


def test_turning_on_the_axis_rolls_the_panorama(turned: SimulatedWorld) -> None:
    before = turned.truth("panorama")
    heading = before.robot.heading
    for _ in range(12):
        turned.step(0.0, 0.5)
    after = turned.truth("panorama")
    columns = round((after.robot.heading - heading) / math.tau * 480)
    same = np.roll(before.instance > 0, columns, axis=1) == (after.instance > 0)
    assert columns > 10
    assert same.mean() > 0.985


def test_columns_that_go_on_over_the_seam_are_counted_on() -> None:
    columns = np.zeros(12, np.bool_)
    columns[[10, 0]] = True
    assert first_and_last(columns) == (10, 12)
    columns[:] = False
    columns[[3, 5]] = True
    assert first_and_last(columns) == (3, 5)
    assert first_and_last(np.ones(12, np.bool_)) == (0, 11)
