import numpy as np
import pytest

from bad_input import BadInput
from tracker.appearance.colour_view import ColourView
from tracker.appearance.config import ColourConfig
from tracker.appearance.lasting_look import FEATURES, LookView

SHAPE = (240, 320)
STATE = np.array([[160, 125, 13, 35, 0, 0, 0, 0, 0]], np.float32)


def pictures(shade: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    thermal = rng.integers(0, 256, SHAPE, dtype=np.uint8)
    colour = np.full((*SHAPE, 3), (150, 140, 120), np.uint8)
    colour[60:190, 140:190] = (220, 90, 60)
    colour[130:190, 140:190] = (60, 70, 160)
    return thermal, np.rint(colour * shade).astype(np.uint8)


def look(shade: float = 1.0) -> np.ndarray:
    thermal, colour = pictures(shade)
    return LookView.build(thermal, ColourView.build(colour, SHAPE, ColourConfig())).describe(STATE)[0]


@pytest.mark.parametrize("shade", [0.8, 0.5, 0.35])
def test_the_look_lasts_when_the_light_changes(shade):
    assert np.linalg.norm(look() - look(shade)) < 2.5
    thermal, colour = pictures(shade)
    other = LookView.build(thermal, ColourView.build(colour[::-1].copy(), SHAPE, ColourConfig()))
    assert np.linalg.norm(look() - other.describe(STATE)[0]) > 5


def test_in_the_dark_and_without_a_colour_camera_warmth_is_all_that_is_left():
    thermal, colour = pictures(0.02)
    for view in (ColourView.build(colour, SHAPE, ColourConfig()), None):
        described = LookView.build(thermal, view).describe(STATE)
        assert described.shape == (1, FEATURES)
        assert np.isnan(described[0, :9]).all()
        assert described[0, 9:] == pytest.approx(look()[9:])


def test_warmth_is_the_mean_grey_of_each_part():
    described = LookView.build(np.full(SHAPE, 153, np.uint8), None).describe(STATE)
    # The last three spreads are 0.15, 0.03 and 0.06.
    assert described[0, 9:] == pytest.approx([0.6 / 0.15, 0.6 / 0.03, 0.6 / 0.06], rel=1e-5)


@pytest.mark.parametrize("config", [ColourConfig(space="hsv"), ColourConfig(representation="histogram")])
def test_a_colour_view_without_rgb_moments_is_refused(config):
    thermal, colour = pictures()
    with pytest.raises(BadInput, match="moments in rgb"):
        LookView.build(thermal, ColourView.build(colour, SHAPE, config))
