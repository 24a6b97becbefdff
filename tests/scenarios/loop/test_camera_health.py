from dataclasses import replace

import numpy as np
import pytest

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.loop.camera_health import CameraHealth
from peopleboy.sim.cameras.camera_config import ColourConfig, DepthConfig, ThermalConfig
from peopleboy.sim.observation import Observation

CAMERAS = {"thermal": ThermalConfig(), "colour": ColourConfig()}
COLD = np.zeros((60, 80), np.uint8)
SEEDS = iter(range(10000))
TIMES = iter(range(10000))


def observed(sonar_m=1.0, **images):
    return Observation(
        time_s=next(TIMES) / 15.0,
        sonar_m=np.full(16, sonar_m),
        odometry=Pose2(),
        wheel_speeds_m_s=(0.0, 0.0),
        images=images,
    )


def warm(left, width=8, height=36):
    """A thermal image of a person, with noise."""
    image = COLD.copy()
    noise = np.random.default_rng(next(SEEDS))
    image[12 : 12 + height, left : left + width] = noise.integers(
        90, 110, image[12 : 12 + height, left : left + width].shape
    )
    return image


def lit():
    return np.random.default_rng(next(SEEDS)).integers(0, 255, (60, 80, 3), np.uint8)


def flicker(base=0):
    return (base + np.random.default_rng(next(SEEDS)).integers(0, 2, (60, 80))).astype(np.uint8)


@pytest.fixture
def health():
    return CameraHealth(CAMERAS, ("thermal", "colour"))


def test_a_person_who_leaves_sideways_or_behind_an_edge_leaves_a_cold_view_and_no_failure(health):
    for image in (warm(30), warm(70), COLD, warm(30), warm(30, width=3), COLD, COLD):
        assert health.check(observed(thermal=image, colour=lit())) == {}


@pytest.mark.parametrize(
    ("image", "word"),
    [(COLD, "black"), (flicker(), "black"), (flicker(254), "saturated"), (COLD + 99, "constant")],
)
def test_a_person_in_the_middle_cannot_vanish_and_the_camera_works_again_with_the_next_picture(
    health, image, word
):
    health.check(observed(thermal=warm(30), colour=lit()))
    for _ in range(3):
        found = health.check(observed(thermal=image, colour=lit()))
        assert list(found) == ["thermal"]
        assert word in found["thermal"]
    assert health.check(observed(thermal=warm(40), colour=lit())) == {}


def test_a_camera_that_stops_flickering_has_a_cold_view(health):
    health.check(observed(thermal=warm(30), colour=lit()))
    assert health.check(observed(thermal=flicker(), colour=lit()))
    assert health.check(observed(thermal=COLD, colour=lit())) == {}


def test_a_cold_view_fails_with_a_black_colour_image_and_works_with_the_next_one(health):
    health.check(observed(thermal=COLD, colour=lit()))
    black = np.zeros((60, 80, 3), np.uint8)
    assert set(health.check(observed(thermal=COLD, colour=black))) == {"thermal", "colour"}
    assert health.check(observed(thermal=COLD, colour=lit())) == {}


def test_a_lamp_above_the_person_does_not_hide_that_the_person_cannot_vanish(health):
    image = warm(30)
    image[:2, 20:23] = image[58:, 50:54] = 255
    health.check(observed(thermal=image, colour=lit()))
    assert health.check(observed(thermal=COLD, colour=lit())) == {"thermal": "the image is black"}


def test_a_robot_that_was_carried_may_have_a_cold_view(health):
    health.check(observed(thermal=warm(30), colour=lit()))
    assert health.check(observed(thermal=COLD, colour=lit(), sonar_m=2.0)) == {}
    assert health.check(observed(thermal=COLD, colour=lit(), sonar_m=2.0)) == {}


def test_a_cold_view_is_sound_when_the_cameras_that_failed_with_it_work_again(health):
    health.check(observed(thermal=warm(30), colour=lit()))
    for _ in range(2):
        found = health.check(observed(thermal=COLD, colour=np.zeros((60, 80, 3), np.uint8)))
        assert set(found) == {"thermal", "colour"}
    assert health.check(observed(thermal=COLD, colour=lit())) == {}


def test_a_frozen_or_missing_image_is_a_failure_of_that_camera_alone(health):
    first = warm(30)
    health.check(observed(thermal=first, colour=lit()))
    assert health.check(observed(thermal=first.copy(), colour=lit())) == {"thermal": "the image repeats"}
    assert health.check(observed(thermal=warm(31), colour=lit())) == {}
    assert health.check(observed(colour=lit())) == {"thermal": "no image"}
    assert health.check(observed(thermal=warm(31), colour=lit())) == {}


def test_a_few_noisy_pixels_may_be_equal_by_chance_but_not_for_long():
    health = CameraHealth(CAMERAS, ("thermal",))
    lamp = COLD.copy()
    lamp[:4, :5] = np.arange(20).reshape(4, 5)  # 18 of its pixels lie between the darkest and the brightest
    found = [(bool(health.check(observed(thermal=lamp))), health.only_repeats) for _ in range(5)]
    assert found == [(False, False)] * 3 + [(True, True)] * 2
    assert not health.check(observed(thermal=lamp + 1))
    assert not health.only_repeats
    assert not health.check(observed(thermal=lamp))


@pytest.mark.parametrize(
    ("name", "camera", "image"),
    [
        ("thermal", ThermalConfig(netd_k=0.0), warm(30)),
        ("colour", ColourConfig(read_noise=0.0, shot_noise=0.0), lit()),
        ("depth", DepthConfig(scale=0.0), 1000 + np.arange(4800, dtype=np.uint16).reshape(60, 80)),
    ],
)
def test_a_camera_without_noise_may_repeat_its_image(name, camera, image):
    health = CameraHealth({name: camera}, (name,))
    for _ in range(3):
        assert health.check(observed(**{name: image})) == {}
        assert not health.only_repeats


def test_all_images_must_repeat():
    health, person, wall = CameraHealth(CAMERAS, ("thermal", "colour")), warm(30), lit()
    for colour, repeats in ((wall, False), (lit(), False), (wall, False), (wall, True)):
        health.check(observed(thermal=person, colour=colour))
        assert health.only_repeats == repeats


def test_a_frozen_camera_may_have_a_cold_view_when_it_works_again(health):
    person = warm(30)
    health.check(observed(thermal=person, colour=lit()))
    for _ in range(5):
        assert health.check(observed(thermal=person, colour=lit()))
    assert health.check(observed(thermal=COLD, colour=lit())) == {}


def test_a_shutter_may_repeat_the_image():
    camera = ThermalConfig(shutter_every_s=30.0, shutter_lasts_s=0.4)
    health, image = CameraHealth({"thermal": camera}, ("thermal",)), warm(30)
    start = observed(thermal=image)
    health.check(start)
    for later_s, fails in ((0.4, False), (0.7, True)):
        assert bool(health.check(replace(start, time_s=start.time_s + later_s))) == fails
