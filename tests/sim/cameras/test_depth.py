from __future__ import annotations

import hashlib
import math
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import ColourConfig, DepthConfig, ThermalConfig
from peopleboy.sim.cameras.depth import (
    DISPARITY_SD_PX,
    DISPARITY_STEP_PX,
    hole_share,
    points_of,
    rays_of,
    show_depth,
    structured_light,
    time_of_flight,
)
from peopleboy.sim.cameras.imaging.camera_view import make_material_table
from peopleboy.sim.cameras.imaging.noise import smooth_gaussian
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.view import View
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.images.camera_view import camera_view
from tests.helpers.worlds.small_worlds import config, person

USUAL = DepthConfig()
EXACT = replace(USUAL, scale=0.0)
SMALL = Pinhole(width=120, height=90)
ALL = {
    "depth": USUAL,
    "exact": EXACT,
    "quiet": replace(USUAL, scale=0.0, read_noise=0.0, shot_noise=0.0),
    "tof": DepthConfig(sensor="tof", camera=SMALL),
    "grey": DepthConfig(camera=SMALL, colour=False),
}


def view_of(depth: np.ndarray, part: np.ndarray | None = None) -> View:
    """What a camera sees of surfaces at these depths [m]; of one part if nothing else is said."""
    own = np.where(np.isfinite(depth), 0, -1).astype(np.int32) if part is None else part.astype(np.int32)
    return View(own, depth.astype(np.float32), np.zeros((*depth.shape, 3), np.float32), np.zeros_like(own))


def seen(robot: RobotConfig, steps: int = 0) -> dict[str, np.ndarray]:
    with SimulatedWorld(config(person("anna", (4.0, 0.4), (5.0, -2.0)), robot=robot, seed=3)) as world:
        for _ in range(steps):
            world.step(0.2, 0.1)
        return dict(world.observe().images)


def robot_with(**cameras: object) -> RobotConfig:
    return RobotConfig(at_m=(1.0, 0.0), cameras={"thermal": ThermalConfig(camera=SMALL), **cameras})


@pytest.fixture(scope="module")
def images() -> dict[str, np.ndarray]:
    return seen(robot_with(**ALL))


@pytest.fixture(scope="module")
def world() -> Iterator[SimulatedWorld]:
    with SimulatedWorld(
        config(person("anna", (4.0, 0.4), (5.0, -2.0)), robot=robot_with(**ALL), seed=3)
    ) as world:
        yield world


def test_noise_and_steps_are_those_of_a_kinect() -> None:
    # Khoshelham & Oude Elberink 2012, of a sensor with 580 px; its angle is 45 degrees, and the usual one 43.
    assert pytest.approx(1.43e-3, rel=0.06) == DISPARITY_SD_PX / USUAL.disparity_px_m
    assert pytest.approx(2.87e-3, rel=0.06) == DISPARITY_STEP_PX / USUAL.disparity_px_m
    native = replace(USUAL, camera=replace(USUAL.camera, vertical_fov_rad=2.0 * math.atan(240.0 / 580.0)))
    assert native.disparity_px_m == pytest.approx(43.5)
    assert USUAL.resized(320, 240).disparity_px_m == pytest.approx(USUAL.disparity_px_m)


@pytest.mark.parametrize("scale", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("depth_m", [1.0, 3.0, 7.0])
def test_noise_is_of_disparity_and_so_grows_with_the_square_of_depth(scale: float, depth_m: float) -> None:
    rng = np.random.default_rng(1)
    true = depth_m * rng.uniform(0.98, 1.02, (480, 640))  # steps fall everywhere
    read = structured_light(view_of(true), replace(USUAL, scale=scale, farthest_m=20.0), rng) / 1000.0
    off = (read - true)[read > 0.0] / true[read > 0.0] ** 2
    sd_px = math.hypot(scale * DISPARITY_SD_PX, DISPARITY_STEP_PX / math.sqrt(12.0))
    assert off.std() == pytest.approx(sd_px / USUAL.disparity_px_m, rel=0.04)
    assert abs(off.mean()) < 0.05 * off.std() + 0.0005 / depth_m**2


def test_readings_lie_on_steps_of_an_eighth_of_a_pixel() -> None:
    flat = view_of(np.full((480, 640), 6.0))
    read = structured_light(flat, USUAL, np.random.default_rng(2))
    values = np.unique(read[read > 0]) / 1000.0
    steps = USUAL.disparity_px_m / values / DISPARITY_STEP_PX
    assert np.abs(steps - np.rint(steps)).max() < 0.006  # as millimetres are rounded
    assert np.diff(values).mean() == pytest.approx(DISPARITY_STEP_PX / USUAL.disparity_px_m * 36.0, rel=0.05)


def test_half_of_the_noise_is_alike_over_patches() -> None:
    rng = np.random.default_rng(4)
    patches = np.stack([smooth_gaussian((64, 80), 8, rng) for _ in range(800)])
    np.testing.assert_allclose(patches.var(axis=0), 1.0, atol=0.25)
    assert patches.var() == pytest.approx(1.0, abs=0.02)
    assert (patches[:, :, 20] * patches[:, :, 21]).mean() > 0.9
    assert abs((patches[:, :, 20] * patches[:, :, 40]).mean()) < 0.03
    config = replace(USUAL, scale=20.0, nearest_m=0.1, farthest_m=60.0)  # beside which steps are small
    read = structured_light(view_of(np.full((480, 640), 2.0)), config, rng).astype(float)
    disparity = np.where(read > 0.0, 1000.0 * USUAL.disparity_px_m / np.maximum(read, 1.0), np.nan)
    off = disparity - np.nanmean(disparity)
    beside = np.nanmean(off[:, :-1] * off[:, 1:]) / np.nanvar(off)
    assert beside == pytest.approx(0.5 * np.mean(patches[:, :, :-1] * patches[:, :, 1:]), abs=0.03)


def test_holes_grow_with_the_depth() -> None:
    config, rng, shares = replace(USUAL, farthest_m=30.0), np.random.default_rng(5), []
    for depth_m in (1.0, 4.0, 7.0, 10.0, 14.0):
        flat = view_of(np.full((480, 640), depth_m))
        shares.append(np.mean([(structured_light(flat, config, rng) == 0).mean() for _ in range(6)]))
    assert shares == pytest.approx(hole_share(np.array([1.0, 4.0, 7.0, 10.0, 14.0])), rel=0.12)
    assert shares[-1] == pytest.approx(0.12, rel=0.1)
    assert hole_share(np.array(0.0)) == pytest.approx(0.005)


def test_what_is_near_throws_its_shadow_to_its_right_as_wide_as_disparities_differ() -> None:
    depth, part = np.full((400, 640), 6.0), np.zeros((400, 640))
    depth[:, 300:340], part[:, 300:340] = 2.0, 1.0
    read = structured_light(view_of(depth, part), USUAL, np.random.default_rng(6))
    dark = (read == 0).mean(axis=0)
    width = 1.05 * USUAL.camera.focal_px * 0.075 * (1 / 2.0 - 1 / 6.0) - 0.5
    first, last = 340, 339 + math.floor(width)
    assert dark[first : last + 1].min() > 0.99
    assert max(dark[last + 2 : last + 40].max(), dark[:340].max()) < 0.25
    wall = structured_light(view_of(np.full((400, 640), 6.0)), USUAL, np.random.default_rng(6))
    assert (wall == 0).mean(axis=0).max() < 0.25


def test_edges_are_frayed_by_a_pixel_or_two_and_surfaces_are_not() -> None:
    depth, part = np.full((480, 640), 3.0), np.zeros((480, 640))
    depth[:, 320:], part[:, 320:] = 2.0, 1.0  # to the left of what is near there is no shadow
    read = structured_light(view_of(depth, part), replace(USUAL, scale=0.01), np.random.default_rng(7))
    near = (read > 0) & (read < 2500)
    share = near.sum(axis=0) / (read > 0).sum(axis=0)
    assert share[319] == pytest.approx(0.2023, abs=0.06)  # beyond half a pixel, of a Gaussian of 0.6 px
    assert share[320] == pytest.approx(1.0 - 0.2023, abs=0.06)
    assert share[:317].max() == 0.0
    assert share[323:].min() == 1.0
    sloping = 2.0 + np.arange(480)[:, None] * np.full(640, 0.02)
    slope = structured_light(view_of(sloping), replace(USUAL, scale=0.01), np.random.default_rng(8)) / 1000.0
    off = np.abs(slope - sloping)[slope > 0]
    assert (off < 0.51 * DISPARITY_STEP_PX / USUAL.disparity_px_m * sloping[slope > 0] ** 2 + 0.006).all()


def test_time_of_flight_has_noise_by_depth_and_darkness_and_reads_between_surfaces_at_edges() -> None:
    camera = replace(USUAL.camera, width=160, height=120)
    config = DepthConfig(sensor="tof", camera=camera)
    materials = make_material_table(
        [Material(temperature_c=20.0, rgb=(grey, grey, grey)) for grey in (0.5, 0.2)],
        np.random.default_rng(0),
    )

    def read(depth: np.ndarray, part: np.ndarray) -> np.ndarray:
        fine = camera_view(view_of(depth, part), materials)
        return time_of_flight(fine, config, np.random.default_rng(9)) / 1000.0

    shape = rays_of(camera).height, rays_of(camera).width
    for depth_m, part, sd_m in ((2.0, 0, 0.005), (6.0, 0, 0.045), (2.0, 1, 0.0125)):
        flat = read(np.full(shape, depth_m), np.full(shape, part))
        assert flat.mean() == pytest.approx(depth_m, abs=0.001)
        assert flat.std() == pytest.approx(sd_m, rel=0.04)
    depth = np.full(shape, 4.0)
    depth[:, 161:] = 2.0
    edge = read(depth, np.zeros(shape))
    between = (2 / 4.0 + 2 / 2.0) / (2 / 16.0 + 2 / 4.0)  # weights fall with the square
    assert edge[:, 80].mean() == pytest.approx(between, abs=0.02)
    assert edge[:, 79].mean() == pytest.approx(4.0, abs=0.01)
    assert edge[:, 81].mean() == pytest.approx(2.0, abs=0.01)
    assert (edge > 0.0).all()


def test_without_noise_it_is_the_true_depth_in_its_range(world: SimulatedWorld) -> None:
    true, image = world.truth("exact").depth_m, world.observe().images["exact"]
    inside = (true >= 0.5) & (true <= 10.0)
    assert 0.1 < inside.mean() < 1.0
    assert np.array_equal(image[inside], np.rint(1000.0 * true[inside]))
    assert not image[~inside].any()
    assert (image.shape, image.dtype) == ((480, 640), np.uint16)


def test_colour_is_that_of_the_same_pixels_and_of_a_colour_camera_in_that_place(
    world: SimulatedWorld,
) -> None:
    truth, images = world.truth("quiet"), world.observe().images
    colour = ColourConfig(camera=USUAL.camera, read_noise=0.0, shot_noise=0.0)
    same = seen(robot_with(other=colour))["other"]
    assert np.array_equal(images["quiet_colour"], same)
    person_depth = images["quiet"][truth.instance == 1]
    assert len(person_depth) > 3000
    assert np.ptp(person_depth) < 900  # no pixel of the wall within the outline
    edges = np.abs(np.diff(images["quiet"].astype(int), axis=1)) > 500
    steps = np.abs(np.diff(images["quiet_colour"].astype(int), axis=1)).max(axis=2)
    assert np.median(steps[edges]) > 20.0
    assert np.median(steps[~edges]) <= 1.0


def test_streams_are_its_own(images: dict[str, np.ndarray]) -> None:
    alone = seen(robot_with(depth=USUAL))
    assert np.array_equal(alone["depth"], images["depth"])
    assert np.array_equal(alone["depth_colour"], images["depth_colour"])
    assert np.array_equal(seen(robot_with())["thermal"], images["thermal"])
    renamed = seen(robot_with(other=USUAL))
    assert not np.array_equal(renamed["other"], images["depth"])
    assert not np.array_equal(renamed["other_colour"], images["depth_colour"])
    assert "grey_colour" not in images


@pytest.mark.parametrize("settings", [{}, {"sensor": "tof"}, {"scale": 0.0}, {"colour": False}])
def test_images_that_nobody_asks_for_are_not_drawn_and_change_no_later_one(
    settings: dict[str, object],
) -> None:
    robot = robot_with(depth=DepthConfig(camera=replace(SMALL, width=121, height=91), **settings))
    with (
        SimulatedWorld(config(person("anna", (4.0, 0.4)), robot=robot)) as one,
        SimulatedWorld(one.config) as other,
    ):
        for world, asks in ((one, True), (other, False)):
            images = world.observe().images
            assert all(camera.width != 121 for _, camera in world._seen)
            if asks:
                dict(images)
                assert sum(camera.width == 121 for _, camera in world._seen) == 1
            world.step(0.0, 0.0)
        last, again = (dict(world.observe().images) for world in (one, other))
    assert last.keys() == again.keys()
    for name, image in last.items():
        assert np.array_equal(image, again[name]), name


_HASH = """
import numpy as np
from tests.sim.cameras.test_depth import ALL, digest, robot_with, seen
print(digest(seen(robot_with(**ALL))))
"""


def digest(images: dict[str, np.ndarray]) -> str:
    whole = hashlib.sha256()
    for name, image in images.items():
        whole.update(name.encode() + image.tobytes())
    return whole.hexdigest()


@pytest.mark.thorough
def test_a_fresh_process_gives_the_same_bytes(images: dict[str, np.ndarray]) -> None:
    done = subprocess.run([sys.executable, "-c", _HASH], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == digest(images)


def test_people_are_shown_what_is_near_brightly_and_holes_black() -> None:
    depth = np.array([[0, 1000, 2000, 4000, 8000, 12000, 20000]], np.uint16)
    brightness = show_depth(depth)[0].astype(int).sum(axis=1)
    assert brightness[0] == 0
    assert (np.diff(brightness[1:6]) < 0).all()
    assert brightness[6] == brightness[5] > 100


def test_points_project_to_their_pixels() -> None:
    depth = np.zeros((480, 640), np.uint16)
    depth[100:300, 50:500] = 2500
    points, pixels = points_of(depth, USUAL.camera, 7)
    assert len(points) == (depth[3::7, 3::7] > 0).sum()
    assert points[:, 2] == pytest.approx(2.5)
    np.testing.assert_allclose(USUAL.camera.project(points.astype(float)), pixels[:, ::-1], atol=1e-3)


@pytest.mark.parametrize(
    ("key", "settings"),
    [
        ("sensor", {"sensor": "laser"}),
        ("scale", {"scale": -0.1}),
        ("scale", {"scale": math.nan}),
        ("farthest_m", {"nearest_m": 3.0, "farthest_m": 3.0}),
        ("farthest_m", {"nearest_m": -1.0}),
        ("farthest_m", {"farthest_m": 66.0}),
    ],
)
def test_what_no_sensor_does_is_refused(key: str, settings: dict[str, object]) -> None:
    with pytest.raises(BadInput) as caught:
        DepthConfig(**settings)
    assert caught.value.key == (key,)


def test_more_noise_is_more_of_depth_and_colour() -> None:
    louder = USUAL.noisier(2.0)
    assert (louder.scale, louder.read_noise) == (2.0, 2.0 * USUAL.read_noise)
    assert EXACT.noisier(5.0).scale == 0.0
