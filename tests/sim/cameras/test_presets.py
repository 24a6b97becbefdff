from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.cameras.depth import (
    AMPLITUDE_AT_1_M,
    AMPLITUDE_SD,
    TOF_SD_M,
    add_offsets,
    amplitude_of,
    draw_offsets,
    rays_of,
    show_amplitude,
    structured_light,
)
from peopleboy.sim.cameras.imaging.camera_view import make_material_table
from peopleboy.sim.cameras.kinds import DEPTH_PRESETS, image_names
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.rendering.view import View
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.images.camera_view import camera_view


def flat(depth_m: float, shape: tuple[int, int]) -> View:
    return View(
        np.zeros(shape, np.int32),
        np.full(shape, depth_m, np.float32),
        np.zeros((*shape, 3), np.float32),
        np.zeros(shape, np.uint64),
    )


def amplitude(depth_m: float, grey: float) -> np.ndarray:
    config = DEPTH_PRESETS["tof"]
    fine = rays_of(config.camera)
    materials = make_material_table(
        [Material(temperature_c=20.0, rgb=(grey, grey, grey))], np.random.default_rng(0)
    )
    view = flat(depth_m, (fine.height, fine.width))
    return amplitude_of(camera_view(view, materials), config, np.random.default_rng(1))


def test_amplitude_is_grey_over_the_square_of_the_depth_with_the_noise_of_the_depth() -> None:
    for depth_m, grey in ((1.0, 1.0), (2.0, 0.5), (5.0, 0.5), (4.0, 0.2)):
        image = amplitude(depth_m, grey)
        expected = AMPLITUDE_AT_1_M * grey / depth_m**2
        assert image.dtype == np.uint16
        assert image.mean() == pytest.approx(expected, abs=0.2)
        assert image.std() == pytest.approx(math.hypot(AMPLITUDE_SD, math.sqrt(1 / 12)), rel=0.03)
        noise_m = TOF_SD_M * (depth_m / 2.0) ** 2 * max(0.5 / grey, 0.5)
        radian_m = 299_792_458.0 / (4.0 * math.pi * 15e6)
        assert radian_m * AMPLITUDE_SD / expected == pytest.approx(noise_m, rel=1e-6)
    dark, bright = (show_amplitude(np.array([[level]], np.uint16))[0, 0] for level in (10, 1000))
    assert 0 < dark < bright < 255


def test_a_rough_kinect_has_four_times_the_noise() -> None:
    sd = []
    for name in ("kinect", "kinect_rough"):
        config = DEPTH_PRESETS[name]
        assert (config.camera.width, config.camera.height) == (320, 240)
        read = structured_light(flat(8.0, (240, 320)), config, np.random.default_rng(3))
        sd.append(float(np.std(read[read > 0] / 1000.0)))
    noise, step = (1.0 / DEPTH_PRESETS["kinect"].disparity_px_m * 8.0**2 * px for px in (0.062, 0.125))
    for scale, found in zip((1.0, 4.0), sd, strict=True):
        assert found == pytest.approx(math.hypot(scale * noise, step / math.sqrt(12.0)), rel=0.08)


def test_an_offset_is_the_same_in_all_images_even_and_only_where_there_is_depth() -> None:
    config = replace(DEPTH_PRESETS["kinect"], offset_m=0.01)
    offsets = draw_offsets(config, np.random.default_rng(5))
    assert (offsets.min(), offsets.max()) == (-10, 10)
    assert offsets.std() == pytest.approx(20.0 / math.sqrt(12.0), rel=0.03)
    depth = np.full((240, 320), 3000, np.uint16)
    depth[0] = 0
    read = add_offsets(depth, offsets)
    assert not read[0].any()
    assert np.array_equal(read[1:].astype(int) - 3000, offsets[1:])


def test_the_offset_of_a_camera_stays_and_that_of_another_seed_differs() -> None:
    exact = DepthConfig(camera=DEPTH_PRESETS["kinect"].camera, scale=0.0)
    cameras = {"exact": exact, "off": replace(exact, offset_m=0.005), **RobotConfig().cameras}
    place, found = build_place(straight_corridor(6.0, 4.0)), []
    for seed in (1, 2):
        config = WorldConfig(place=place, robot=RobotConfig(cameras=cameras), seed=seed)
        with SimulatedWorld(config) as world:
            for _ in range(2):
                images = world.observe().images
                found.append(images["off"].astype(int) - images["exact"])
                world.step(0.0, 0.0)
    assert np.array_equal(found[0], found[1])
    assert np.abs(found[0]).max() == 5
    assert not np.array_equal(found[0], found[2])


def test_the_time_of_flight_camera_gives_amplitude_instead_of_colour() -> None:
    config = DEPTH_PRESETS["tof"]
    assert image_names("tof", config) == ("tof", "tof_amplitude")
    robot = RobotConfig(cameras={**RobotConfig().cameras, "tof": config})
    with SimulatedWorld(WorldConfig(place=build_place(straight_corridor(6.0, 4.0)), robot=robot)) as world:
        images = world.observe().images
        assert images["tof"].shape == images["tof_amplitude"].shape == (144, 176)
        assert (images["tof"] > 0).all()
        assert images["tof_amplitude"].dtype == np.uint16
    with pytest.raises(BadInput, match="amplitude"):
        DepthConfig(amplitude=True)
