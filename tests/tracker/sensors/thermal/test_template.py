"""Where somebody went, told by what he looked like."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.thermal.template import Grey, Template

HERE = np.array([100.0, 60.0, 27.0, 100.0])


def scene(seed: int = 0) -> Grey:
    """Draw blurred noise, which looks the same nowhere."""
    noise = np.random.default_rng(seed).normal(size=(240, 320)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 4.0)
    return np.clip(128.0 + 40.0 * smooth / smooth.std(), 0, 255).astype(np.uint8)


def moved(grey: Grey, scale: float, right: float, down: float) -> tuple[Grey, Floats]:
    """Enlarge an image about the middle of `HERE`, and shift it; give where `HERE` went, too."""
    middle = HERE[:2] + HERE[2:] / 2.0
    shift = np.array([right, down]) + (1.0 - scale) * middle
    matrix = np.array([[scale, 0.0, shift[0]], [0.0, scale, shift[1]]])
    image = cv2.warpAffine(grey, matrix, (320, 240), flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(image, np.uint8), np.concatenate([scale * HERE[:2] + shift, scale * HERE[2:]])


def around(box: Floats, right: float, down: float) -> Floats:
    """Give the box that a path might lead to, which is aside of the true one, and wider."""
    return np.array([box[0] + right - 0.1 * box[2], box[1] + down, 1.2 * box[2], box[3]])


@given(
    scale=st.floats(0.9, 1.1),
    right=st.floats(-20.0, 20.0),
    down=st.floats(-10.0, 10.0),
    off=st.tuples(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0)),
)
def test_who_moved_is_found_to_a_fraction_of_a_cell(
    scale: float, right: float, down: float, off: tuple[float, float]
) -> None:
    template = Template.of(scene(), HERE)
    later, truth = moved(scene(), scale, right, down)
    box = template.found(later, around(truth, *off), 0.6)
    assert box is not None
    np.testing.assert_allclose(box, truth, atol=0.8)  # a cell is 2.5 px


@pytest.mark.parametrize("off", [(30.0, 0.0), (0.0, -30.0)])
def test_who_is_far_from_where_he_should_be_is_not_found(off: tuple[float, float]) -> None:
    assert Template.of(scene(), HERE).found(scene(), around(HERE, *off), 0.6) is None


def test_another_one_is_not_taken_for_him() -> None:
    template = Template.of(scene(), HERE)
    assert all(template.found(scene(seed), HERE, 0.6) is None for seed in range(1, 20))


def test_gain_and_offset_do_not_matter() -> None:
    template, grey = Template.of(scene(), HERE), (0.4 * scene() + 30.0).round().astype(np.uint8)
    box = template.found(grey, HERE, 0.6)
    assert box is not None
    np.testing.assert_allclose(box, HERE, atol=0.1)


def test_what_shows_nothing_is_not_found() -> None:
    flat = np.full((240, 320), 90, np.uint8)
    assert Template.of(flat, HERE).found(flat, HERE, 0.6) is None
    assert Template.of(scene(), HERE).found(flat, HERE, 0.6) is None
