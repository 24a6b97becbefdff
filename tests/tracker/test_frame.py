import numpy as np
import pytest

from peopleboy.tracker.frame import Frame
from tests.helpers.calls.refused import refused

GREY = np.zeros((240, 320), dtype=np.uint8)


@pytest.mark.parametrize(
    ("image", "got"),
    [
        (np.zeros((240, 320, 3), dtype=np.uint8), "(240, 320, 3) uint8"),
        (np.zeros((240, 320), dtype=np.float32), "(240, 320) float32"),
        (np.zeros((0, 320), dtype=np.uint8), "(0, 320) uint8"),
        (None, "NoneType"),
    ],
)
def test_a_thermal_image_of_another_shape_or_type_is_refused_by_name(image, got):
    with refused("thermal image", "(H, W) uint8", got):
        Frame(thermal=image, time_s=0.0)


def test_a_colour_image_without_three_channels_is_refused():
    with refused("colour image", "(240, 320) uint8"):
        Frame(thermal=GREY, time_s=0.0, colour=GREY)


@pytest.mark.parametrize("name", ["time_s", "turn_rad", "advance_m"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_numbers_that_are_not_finite_are_refused(name, value):
    with refused(name, "finite", value):
        Frame(**{"thermal": GREY, "time_s": 0.0, name: value})
