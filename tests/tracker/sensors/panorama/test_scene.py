import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.panorama.panorama_patches import BODY_M, PanoramaScene, person_box
from tests.helpers.images.cardboard import CAMERA, HALL, HEIGHT, WIDTH, Cardboard, mask_of, scene_of

BEARINGS, DISTANCES = st.floats(-math.pi, math.pi), st.floats(1.2, 7.0)


def full_scene():
    everything = np.ones((HEIGHT, WIDTH), np.float32)
    return PanoramaScene.of(HALL, everything, everything, CAMERA)


@given(BEARINGS, DISTANCES)
def test_a_box_is_that_of_an_upright_rectangle_and_goes_on_over_the_seam(bearing, distance):
    left, top, width, height = person_box(bearing, distance, CAMERA)
    assert -0.5 <= left < WIDTH - 0.5
    half = math.atan2(BODY_M[0] / 2, distance)
    assert width == pytest.approx(2 * half / math.tau * WIDTH)
    middle = CAMERA.bearing(np.array([left + width / 2]))[0]
    assert math.remainder(middle - bearing, math.tau) == pytest.approx(0.0, abs=1e-9)
    place = distance * np.array([math.cos(bearing), math.sin(bearing)])
    ends = CAMERA.project(np.array([[*place, BODY_M[1]], [*place, 0.0]]))[:, 1]
    assert (top, top + height) == pytest.approx(tuple(ends))


def test_who_stands_behind_the_robot_has_one_box_that_begins_inside():
    left, _, width, _ = person_box(math.pi, 2.0, CAMERA)
    assert left < WIDTH - 0.5 < left + width
    assert left + width / 2 == pytest.approx(WIDTH - 0.5)


@settings(max_examples=30)
@given(BEARINGS, DISTANCES)
def test_cover_takes_only_pixels_of_people_that_are_in_reach(bearing, distance):
    scene = full_scene()
    scene.cover(bearing, distance)
    rows, columns = np.nonzero(scene.covered)
    assert len(rows)
    assert set(np.unique(scene.covered)) <= {0.0, 1.0}
    off = np.angle(np.exp(1j * (CAMERA.bearing(columns.astype(float)) - bearing)))
    pixel = math.tau / WIDTH
    assert np.abs(off).max() <= math.atan2(0.42, distance) + 2 * pixel
    lowest = CAMERA.project(np.array([[distance, 0.0, -0.2]]))[0, 1]
    assert rows.max() <= lowest + 1.0
    nobody = PanoramaScene.of(HALL, np.zeros_like(scene.covered), np.zeros_like(scene.covered), CAMERA)
    nobody.cover(bearing, distance)
    assert not nobody.covered.any()


@settings(max_examples=30)
@given(BEARINGS, DISTANCES)
def test_covering_a_person_takes_all_of_it_and_leaves_whom_it_does_not_touch(bearing, distance):
    person, other = Cardboard(distance, bearing), Cardboard(3.0, bearing + 1.5)
    scene = scene_of([person, other])
    scene.cover(bearing, distance)
    own, theirs = mask_of(person)[0], mask_of(other)[0]
    assert scene.covered[own].mean() > 0.98
    assert not scene.covered[theirs].any()
    assert not scene.covered[~own].any()


@given(st.integers(0, WIDTH - 1))
@settings(max_examples=20)
def test_in_a_turned_image_the_same_pixels_are_covered_turned(columns):
    people = [Cardboard(2.0, 0.2), Cardboard(3.5, 0.35)]
    here, there = scene_of(people), scene_of(people, columns)
    here.cover(0.2, 2.0)
    there.cover(0.2 - columns * math.tau / WIDTH, 2.0)
    assert np.array_equal(there.covered, np.roll(here.covered, columns, axis=1))


def test_nobody_is_hidden_as_long_as_nobody_was_found():
    scene = full_scene()
    for distance in (1.2, 2.0, 5.0):
        assert scene.hidden_share(2.0, distance) == pytest.approx(0.0, abs=1e-3)


def test_who_stands_right_behind_somebody_is_hidden_and_half_behind_by_half():
    scene = scene_of([Cardboard(2.0, math.pi)])
    scene.cover(math.pi, 2.0)
    assert scene.hidden_share(-math.pi, 5.0) > 0.8
    edge = math.atan2(0.22, 2.0)
    assert scene.hidden_share(math.pi - edge, 5.0) == pytest.approx(
        scene.hidden_share(math.pi, 5.0) / 2, abs=0.1
    )
    assert scene.hidden_share(math.pi - 2.5 * edge, 5.0) == pytest.approx(0.0, abs=0.02)
    # On the other side of the robot nobody was found.
    assert scene.hidden_share(0.0, 1.5) == pytest.approx(0.0, abs=1e-6)


def test_who_is_wholly_below_the_image_is_hidden_by_nobody():
    scene = full_scene()
    scene.covered[:] = 1.0
    scene.cover(0.0, 2.0)
    assert scene.hidden_share(0.0, 0.02) in (0.0, pytest.approx(1.0))


@pytest.mark.parametrize("distance", [0.5, 1.3, 4.0, 30.0])
@pytest.mark.parametrize("height", [-0.2, 0.0, 1.72, 2.0])
def test_the_row_of_a_height_at_a_distance_is_where_it_is_projected_to(distance, height):
    point = np.array([[distance * math.cos(0.7), distance * math.sin(0.7), height]])
    assert CAMERA.row(distance, height) == pytest.approx(float(CAMERA.project(point)[0, 1]), nan_ok=True)
