import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import Frame

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
    with pytest.raises(BadInput) as error:
        Frame(thermal=image, time_s=0.0)
    assert str(error.value) == f"thermal image must be (H, W) uint8, got {got}"


def test_a_colour_image_without_three_channels_is_refused():
    with pytest.raises(BadInput, match="colour image must be"):
        Frame(thermal=GREY, time_s=0.0, colour=GREY)


@pytest.mark.parametrize("name", ["time_s", "turn_rad", "advance_m"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_numbers_that_are_not_finite_are_refused(name, value):
    with pytest.raises(BadInput, match=f"{name} must be a finite number"):
        Frame(**{"thermal": GREY, "time_s": 0.0, name: value})
