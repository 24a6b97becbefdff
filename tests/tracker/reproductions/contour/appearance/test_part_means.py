"""All at once, without arrays in between, is the same as step by step."""

import numpy as np
import pytest

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import (
    HIDDEN_PART,
    AppearanceView,
    visible,
)
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView
from peopleboy.tracker.reproductions.contour.appearance.regions import PARTS, part_rectangles
from peopleboy.tracker.reproductions.contour.colour_config import (
    FAR_AFFINE,
    ROBOT_PARALLAX,
    ColourDescriptorConfig,
)
from peopleboy.tracker.reproductions.contour.contour_config import AppearanceConfig

SHAPE = (240, 320)
SPREAD = np.array([90, 60, 10, 25, 8, 1, 1, 1, 1])


def samples(count: int = 400) -> np.ndarray:
    """People all over the image and beyond, some of them of no size, some not even numbers."""
    rng = np.random.default_rng(0)
    state = np.array([160, 120, 12, 35, 0, 0, 0, 0, 0]) + SPREAD * rng.standard_normal((count, 9))
    state[::50, 3], state[1::50, 2], state[2::50, 0], state[3::50, 1] = 0, -5, 1e30, np.nan
    return state.astype(np.float32)


def views(representation: str) -> tuple[ColourView, AppearanceView]:
    rng = np.random.default_rng(1)
    thermal, colour = rng.integers(0, 256, SHAPE, np.uint8), rng.integers(0, 256, (480, 640, 3), np.uint8)
    config = ColourDescriptorConfig(affine=FAR_AFFINE, parallax=ROBOT_PARALLAX, representation=representation)
    view = ColourView.build(colour, SHAPE, config)
    return view, AppearanceView.build(thermal, view, AppearanceConfig())


@pytest.mark.parametrize("representation", ["moments1", "moments2"])
def test_looks_are_the_first_moments_of_both_images_to_the_last_bit(representation: str) -> None:
    state = samples()
    colour, appearance = views(representation)
    each = np.empty((len(state), PARTS, 4), np.float32)
    each[:, :, :3] = colour.describe(state).reshape(len(state), PARTS, 3, -1)[..., 0]
    each[:, :, 3] = appearance.thermal.describe(state)
    assert 0.1 < np.isnan(each).mean() < 0.9
    assert np.array_equal(
        appearance.describe(state), (each * appearance.scale).reshape(len(state), -1), equal_nan=True
    )


def test_in_the_dark_there_are_no_colours() -> None:
    state = samples()
    colour = ColourView.build(np.zeros((*SHAPE, 3), np.uint8), SHAPE, ColourDescriptorConfig())
    appearance = AppearanceView.build(np.full(SHAPE, 99, np.uint8), colour, AppearanceConfig())
    described = appearance.describe(state).reshape(-1, 4)
    assert np.isnan(described[:, :3]).all()
    assert np.isfinite(described[:, 3]).any()


def test_parts_behind_others_are_blank() -> None:
    state = samples()
    hiding = np.array([[120, 60, 40, 150], [200, 0, 15, 90]], np.float32)
    parts = part_rectangles(state)
    left, top, right, bottom = (parts[:, :, k, None] for k in range(4))
    across = np.minimum(right, hiding[:, 0] + hiding[:, 2]) - np.maximum(left, hiding[:, 0])
    down = np.minimum(bottom, hiding[:, 1] + hiding[:, 3]) - np.maximum(top, hiding[:, 1])
    shared = np.maximum(across, 0) * np.maximum(down, 0)
    is_hidden = (shared > HIDDEN_PART * np.maximum((right - left) * (bottom - top), 1e-6)).any(axis=2)
    blank = np.isnan(visible(np.zeros((len(state), 12), np.float32), state, hiding)).reshape(-1, PARTS, 4)
    assert 0.02 < is_hidden.mean() < 0.9
    assert np.array_equal(blank, np.repeat(is_hidden[:, :, None], 4, axis=2))
