import numpy as np
import pytest

from peopleboy.sim.observation import OnDemand
from peopleboy.tracker.frame import COLOUR, DEPTH, DEPTH_COLOUR, THERMAL, Frame, Odometry
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
        Frame(images={THERMAL: image}, time_s=0.0).grey(THERMAL)


def test_a_colour_image_without_three_channels_is_refused():
    with refused("colour image", "(240, 320) uint8"):
        Frame(images={THERMAL: GREY, COLOUR: GREY}, time_s=0.0).rgb(COLOUR)


@pytest.mark.parametrize(
    ("image", "got"),
    [
        (GREY, "(240, 320) uint8"),
        (np.zeros((240, 320, 1), dtype=np.uint16), "(240, 320, 1) uint16"),
        (np.zeros((240, 320), dtype=np.float32), "(240, 320) float32"),
        (np.zeros((0, 320), dtype=np.uint16), "(0, 320) uint16"),
        ([[1000]], "list"),
    ],
)
def test_a_depth_image_of_another_shape_or_type_is_refused_by_name(image, got):
    with refused("depth image", "(H, W) uint16", got):
        Frame(images={DEPTH: image}, time_s=0.0).depth(DEPTH)


def test_depth_is_read_and_is_no_grey_image():
    depth = np.full((4, 5), 2500, np.uint16)
    frame = Frame(images={DEPTH: depth, DEPTH_COLOUR: np.zeros((4, 5, 3), np.uint8)}, time_s=0.0)
    assert np.shares_memory(frame.depth(DEPTH), depth)
    assert frame.rgb(DEPTH_COLOUR).shape == (4, 5, 3)
    with refused("depth image", "(H, W) uint8", "uint16"):
        frame.grey(DEPTH)


def test_an_image_that_there_is_none_of_is_refused_with_those_that_there_are():
    with refused("'panorama'", "thermal, colour"):
        Frame(images={THERMAL: GREY, COLOUR: GREY}, time_s=0.0).grey("panorama")


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_time_that_is_not_finite_is_refused(value):
    with refused("time_s", "finite", value):
        Frame(images={THERMAL: GREY}, time_s=value)


@pytest.mark.parametrize("name", ["turn_rad", "advance_m", "aside_m"])
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_odometry_that_is_not_finite_is_refused(name, value):
    with refused(name, "finite", value):
        Odometry(**{name: value})


def test_images_cannot_be_written_to_are_no_copies_and_are_made_when_asked_for():
    image = np.zeros((4, 5), np.uint8)
    frame = Frame(images={THERMAL: image}, time_s=0.0)
    for seen in (frame.images[THERMAL], frame.grey(THERMAL), dict(frame.images)[THERMAL]):
        with pytest.raises(ValueError, match="read-only"):
            seen[:] = 1
        assert np.shares_memory(seen, image)
    image[:] = 7  # the owner still can
    assert frame.grey(THERMAL).max() == 7
    asked = []
    lazy = Frame(images=OnDemand((THERMAL, COLOUR), lambda name: asked.append(name) or image), time_s=0.0)
    assert (list(lazy.images), COLOUR in lazy.images, asked) == ([THERMAL, COLOUR], True, [])
    assert lazy.grey(THERMAL).shape == (4, 5)
    assert asked == [THERMAL]


def test_an_image_that_is_not_there_is_told_with_those_that_are():
    frame = Frame(images={"thermal": np.zeros((4, 4), np.uint8)}, time_s=0.0)
    assert frame.images.get("rear") is None
    with pytest.raises(KeyError, match="no image of camera 'rear'; it has thermal"):
        frame.images["rear"]
