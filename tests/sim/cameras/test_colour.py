import numpy as np
import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import ColourConfig
from peopleboy.sim.cameras.colour import colour_image, expose
from peopleboy.sim.cameras.imaging.camera_view import make_material_table
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.materials import Material, Pattern, PatternKind
from tests.helpers.images.camera_view import camera_view

CONFIG = ColourConfig(camera=Pinhole(width=60, height=40))
WHITE = (1.0, 1.0, 1.0)


def image_of(
    material: Material, light: float, normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
) -> np.ndarray:
    shape = (40, 60)
    normals = np.tile(np.array(normal, np.float32), (*shape, 1))
    view = View(
        np.zeros(shape, np.int32), np.full(shape, 2.0, np.float32), normals, np.zeros(shape, np.uint64)
    )
    table = make_material_table([material], stream(0, "surface.variation"))
    return colour_image(camera_view(view, table, light_level=light), CONFIG)


def test_brightness_is_proportional_to_light_and_reflectance() -> None:
    full = image_of(Material(temperature_c=20.0, rgb=(0.8, 0.4, 0.2)), 1.0)
    half = image_of(Material(temperature_c=20.0, rgb=(0.8, 0.4, 0.2)), 0.5)
    assert np.allclose(half, full / 2.0, atol=1e-6)
    assert full[0, 0, 0] / full[0, 0, 2] == pytest.approx(4.0, rel=1e-5)


def test_in_the_dark_only_what_glows_is_seen() -> None:
    assert image_of(Material(temperature_c=20.0, rgb=WHITE), 0.0).max() == 0.0
    assert image_of(Material(temperature_c=60.0, rgb=WHITE, glow=1.0), 0.0).min() == pytest.approx(1.0)


def test_a_surface_that_faces_the_light_is_brighter_than_one_that_turns_away() -> None:
    material = Material(temperature_c=20.0, rgb=WHITE)
    assert (
        image_of(material, 1.0, (0.0, 0.0, 1.0)).mean()
        > image_of(material, 1.0, (0.0, 0.0, -1.0)).mean()
        > 0.0
    )


@pytest.mark.parametrize("kind", [PatternKind.STRIPES, PatternKind.CHECKS, PatternKind.SPECKLE])
def test_patterns_show_both_colours(kind: PatternKind) -> None:
    material = Material(
        temperature_c=20.0,
        rgb=(0.9, 0.0, 0.0),
        second_rgb=(0.0, 0.0, 0.9),
        colour_pattern=Pattern(kind=kind, period_m=0.3),
    )
    camera_down = image_of(material, 1.0)
    # The part's z axis is the optical axis here, along which stripes do not vary.
    share = (camera_down[..., 2] > camera_down[..., 0]).mean()
    assert share in (0.0, 1.0) if kind is PatternKind.STRIPES else 0.2 < share < 0.8


def test_exposure_noise_has_the_stated_size_and_repeats_with_its_stream() -> None:
    grey = np.full((200, 200, 3), 0.5, np.float32)
    first, again = (expose(grey, CONFIG, stream(3, "colour.noise")) for _ in range(2))
    assert np.array_equal(first, again)
    linear = ((first / 255.0 + 0.055) / 1.055) ** 2.4
    sigma = np.hypot(CONFIG.read_noise, CONFIG.shot_noise * np.sqrt(0.5))
    assert linear.mean() == pytest.approx(0.5, rel=0.01)
    assert linear.std() == pytest.approx(sigma, rel=0.1)


def test_black_and_white_reach_both_ends_of_the_code() -> None:
    quiet = ColourConfig(read_noise=0.0, shot_noise=0.0)
    ends = np.array([[[0.0, 1.0, 2.0]]], np.float32)
    assert expose(ends, quiet, stream(0, "colour.noise")).tolist() == [[[0, 255, 255]]]
