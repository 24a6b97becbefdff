from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.sim.cameras.camera_config import PanoramaConfig, ThermalConfig
from peopleboy.sim.cameras.panoramic import finer, roll_up, shift_blur, unroll
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.worlds.small_worlds import config, person

USUAL = PanoramaConfig()
QUIET = replace(USUAL, read_noise=0.0, shot_noise=0.0)
CAMERAS = {"panorama": USUAL, "quiet": QUIET, "round": replace(QUIET, raw=True)}


@pytest.fixture(scope="module")
def images() -> Iterator[dict[str, np.ndarray]]:
    robot = RobotConfig(at_m=(5.0, 0.0), cameras={"thermal": ThermalConfig(), **CAMERAS})
    with SimulatedWorld(
        config(person("behind", (2.5, 0.0)), person("left", (5.0, 2.0)), robot=robot)
    ) as world:
        yield dict(world.observe().images)


def test_a_sweep_smears_an_edge_over_the_seam_and_keeps_the_light() -> None:
    image = np.zeros((2, 40, 3), np.float32)
    image[:, 0] = 1.0
    blurred = shift_blur(image, 5.0)
    expected = [0.025, 0.175, 0.2, 0.2, 0.2, 0.175, 0.025]
    np.testing.assert_allclose(np.roll(blurred, 3, axis=1)[0, :7, 0], expected, atol=1e-6)
    np.testing.assert_allclose(blurred.sum(axis=1), image.sum(axis=1), rtol=1e-5)
    np.testing.assert_allclose(shift_blur(np.ones_like(image), 3.3), 1.0, rtol=1e-5)
    assert shift_blur(image, 0.01) is image


def test_what_depends_on_the_direction_alone_is_rolled_up_and_unrolled_to_itself() -> None:
    camera = Panorama()
    fine = finer(camera)
    columns = np.sin(fine.bearing(np.arange(fine.width)))
    linear = np.broadcast_to((0.5 + 0.4 * columns)[None, :, None], (fine.height, fine.width, 3))
    disc = roll_up(np.ascontiguousarray(linear, np.float32), camera)
    assert disc.shape == (240, 240, 3)
    assert disc[120, 230, 0] == pytest.approx(0.9, abs=0.01)  # the robot's left is at the right
    assert disc[120, 10, 0] == pytest.approx(0.1, abs=0.01)
    assert not disc[3, 3].any()
    again = unroll(np.rint(255.0 * disc).astype(np.uint8), camera)
    wave = 127.5 + 102.0 * np.sin(camera.bearing(np.arange(480)))
    np.testing.assert_allclose(again[:110, :, 1], np.broadcast_to(wave, (110, 480)), atol=3.0)


def test_the_panorama_from_the_round_image_is_the_other_one_but_coarser(
    images: dict[str, np.ndarray],
) -> None:
    assert images["round_raw"].shape == (240, 240, 3)
    off = np.abs(images["round"].astype(int) - images["quiet"])
    assert np.median(off) <= 1.0
    assert off[:60].mean() < 4.0
    assert "panorama_raw" not in images


def test_noise_is_that_of_its_settings_and_light_that_of_the_place(images: dict[str, np.ndarray]) -> None:
    off = images["panorama"].astype(float) - images["quiet"]
    assert abs(off.mean()) < 0.1
    assert 0.5 < off.std() < 3.0
    assert images["quiet"].min() < 80 < images["quiet"].max()


def test_the_same_instant_has_the_same_image_whatever_was_read_before() -> None:
    for raw in (False, True):
        camera = replace(USUAL, raw=raw)
        robot = RobotConfig(at_m=(5.0, 0.0), cameras={"thermal": ThermalConfig(), "panorama": camera})
        taken = []
        for reads in ((0, 1, 2), (2,)):
            with SimulatedWorld(config(person("behind", (2.5, 0.0)), robot=robot)) as world:
                for step in range(3):
                    image = world.observe().images
                    if step in reads:
                        last = image["panorama"].copy()
                    world.step(0.0, math.radians(20.0))
            taken.append(last)
        np.testing.assert_array_equal(*taken)
