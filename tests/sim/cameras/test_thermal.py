import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.imaging.camera_view import make_material_table
from peopleboy.sim.cameras.imaging.electronics import encode_8bit
from peopleboy.sim.cameras.thermal import (
    band_radiance,
    detect,
    encode_16bit,
    make_detector,
    surface_image,
)
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.materials import Material
from tests.helpers.images.camera_view import camera_view

CONFIG = ThermalConfig(camera=Pinhole(width=40, height=30))


def view_of(part: np.ndarray) -> View:
    shape = part.shape
    depth = np.where(part >= 0, 3.0, np.inf).astype(np.float32)
    return View(part.astype(np.int32), depth, np.zeros((*shape, 3), np.float32), np.zeros(shape, np.uint64))


def image_of(
    part: np.ndarray, materials: list[Material], surroundings_c: float, turned_rad: float = 0.0
) -> np.ndarray:
    table = make_material_table(materials, stream(0, "surface.variation"))
    turn_rad_s = turned_rad / CONFIG.exposure_s
    seen = camera_view(view_of(part), table, surroundings_c=surroundings_c, turn_rad_s=turn_rad_s)
    return surface_image(seen, CONFIG)


@given(
    temperature=st.floats(-10.0, 80.0),
    emissivity=st.floats(0.05, 1.0),
    turned=st.floats(-0.2, 0.2),
)
@settings(deadline=None, max_examples=50)
def test_a_world_of_one_temperature_gives_one_value(
    temperature: float, emissivity: float, turned: float
) -> None:
    part = np.zeros((30, 40), np.int32)
    part[:10] = -1
    part[:, 20:] = 1
    materials = [
        Material(temperature_c=temperature, emissivity=emissivity),
        Material(temperature_c=temperature),
    ]
    image = image_of(part, materials, temperature, turned)
    assert np.ptp(image) < 2e-3
    assert image.mean() == pytest.approx(temperature, abs=2e-3)


@pytest.mark.parametrize("temperature", [-5.0, 18.0, 24.0, 30.3, 36.0, 60.0, 120.0])
def test_a_black_body_reads_its_temperature_within_50_mk(temperature: float) -> None:
    part = np.zeros((30, 40), np.int32)
    image = image_of(part, [Material(temperature_c=temperature, emissivity=1.0)], 21.0)
    assert np.abs(image - temperature).max() < 0.05


def test_low_emissivity_draws_a_warm_surface_towards_its_surroundings() -> None:
    part = np.zeros((30, 40), np.int32)
    grey = image_of(part, [Material(temperature_c=40.0, emissivity=0.6)], 20.0).mean()
    radiance = 0.6 * band_radiance(np.array([40.0])) + 0.4 * band_radiance(np.array([20.0]))
    assert band_radiance(np.array([grey], np.float64)) == pytest.approx(radiance, rel=1e-4)
    assert 20.0 < grey < 40.0


def test_band_radiance_of_300_k_agrees_with_the_tables() -> None:
    # 8..14 um holds 37.6 % of sigma T^4 / pi at 300 K (Planck fractions F(4200) - F(2400) um K).
    total = 5.670374e-8 * 300.0**4 / np.pi
    assert band_radiance(np.array([26.85]))[0] / total == pytest.approx(0.376, abs=0.002)


def test_variation_stays_within_its_amplitude() -> None:
    part = np.zeros((30, 40), np.int32)
    image = image_of(part, [Material(temperature_c=30.0, emissivity=1.0, variation_k=0.5)], 21.0)
    assert 0.1 < np.ptp(image) < 1.0 + 1e-3
    assert np.abs(image - 30.0).max() < 0.5 + 1e-3


def test_8_bit_code_is_the_rounded_clipped_line_of_the_source() -> None:
    temperature = np.linspace(20.0, 40.0, 999, dtype=np.float32)
    expected = np.clip(np.round((temperature.astype(np.float64) - 24.0) / 12.0 * 255.0), 0, 255)
    assert np.abs(encode_8bit(temperature) - expected).max() <= 1
    assert (encode_8bit(temperature) == expected).mean() > 0.99
    assert encode_8bit(np.array([23.0, 24.0, 30.0, 36.0, 99.0], np.float32)).tolist() == [0, 0, 128, 255, 255]


def test_16_bit_code_counts_hundredths_of_a_kelvin() -> None:
    assert encode_16bit(np.array([-273.15, 0.0, 24.0], np.float32)).tolist() == [0, 27315, 29715]


def test_detector_noise_has_the_stated_size_and_repeats_with_its_stream() -> None:
    config = ThermalConfig(dead_pixels=0.01)
    detector = make_detector(config, stream(1, "thermal.detector"))
    scene = np.full((240, 320), 30.0, np.float32)
    first = detect(scene, detector, config, stream(1, "thermal.noise"))
    again = detect(scene, detector, config, stream(1, "thermal.noise"))
    other = detect(scene, detector, config, stream(2, "thermal.noise"))
    assert np.array_equal(first, again)
    alive = ~detector.dead
    assert (first - other)[alive].std() == pytest.approx(config.netd_k * np.sqrt(2.0), rel=0.02)
    assert detector.offset_k.std() == pytest.approx(config.fixed_pattern_k, rel=0.02)
    assert np.all(first[detector.dead] == config.lowest_c)
    assert detector.dead.mean() == pytest.approx(0.01, rel=0.2)


def test_rotation_blurs_a_vertical_edge_and_leaves_a_horizontal_one() -> None:
    upright = np.zeros((30, 40), np.int32)
    upright[:, 20:] = 1
    level = np.zeros((30, 40), np.int32)
    level[15:] = 1
    materials = [Material(temperature_c=20.0, emissivity=1.0), Material(temperature_c=34.0, emissivity=1.0)]
    turned = 0.2
    blurred = image_of(upright, materials, 21.0, turned)
    swept = CONFIG.camera.focal_px * turned
    between = (blurred[15] > 20.5) & (blurred[15] < 33.5)
    assert swept * 0.7 < between.sum() < swept * 1.3 + 4
    assert np.allclose(image_of(level, materials, 21.0, turned), image_of(level, materials, 21.0), atol=1e-3)
