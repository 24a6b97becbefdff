import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.panorama.figure_patch import (
    ACROSS,
    BOTTOM_M,
    HALF_WIDTH_M,
    KNOWN,
    LAYERS,
    PEOPLE,
    TOP_M,
    UP,
    FigureMap,
)
from peopleboy.tracker.sensors.panorama.panorama_view import all_round
from tests.helpers.images.cardboard import CAMERA, HEIGHT, WIDTH, Cardboard, figures_of, mask_of

BEARINGS, DISTANCES = st.floats(-math.pi, math.pi), st.floats(0.8, 8.0)


def blots(seed):
    """People, what is new, and what is covered: rectangles and noise, some across the seam."""
    rng = np.random.default_rng(seed)
    maps = rng.uniform(0.0, 0.2, (3, HEIGHT, WIDTH))
    for one in maps:
        for _ in range(6):
            u, v, wide, high = rng.integers((0, 0, 5, 10), (WIDTH, 90, 60, 70))
            one[v : v + high, (u + np.arange(wide)) % WIDTH] = rng.uniform(0.5, 1.0)
    maps[2] = maps[2] > 0.5
    return maps.astype(np.float32)


def patch_by_counting(maps, bearing, distance, fine=24):
    """Means over the cells by many points in each, read off the pixels that they lie in."""
    people, new, covered = maps.astype(float)
    layers = np.stack([people * (1 - covered), new * (1 - covered), 1 - covered])
    edges = np.linspace(TOP_M, BOTTOM_M, UP + 1)
    ends = CAMERA.project(np.stack([np.full(UP + 1, distance), 0 * edges, edges], axis=1))[:, 1] + 0.5
    half = math.atan2(HALF_WIDTH_M, distance)
    within = (np.arange(fine) + 0.5) / fine
    rows = (ends[:-1, None] + np.diff(ends)[:, None] * within).ravel()
    ways = bearing + half - 2 * half * (np.arange(ACROSS * fine) + 0.5) / (ACROSS * fine)
    columns = np.floor((0.5 - ways / math.tau) * WIDTH).astype(int) % WIDTH
    inside = (rows >= 0) & (rows < HEIGHT)
    found = np.zeros((LAYERS, len(rows), len(columns)))
    found[:, inside] = layers[:, np.floor(rows[inside]).astype(int)][:, :, columns]
    return found.reshape(LAYERS, UP, fine, ACROSS, fine).mean(axis=(2, 4))


@settings(max_examples=25)
@given(st.integers(0, 5), BEARINGS, DISTANCES)
def test_a_cell_is_the_mean_of_the_pixels_below_it(seed, bearing, distance):
    maps = blots(seed)
    reported = FigureMap.build(*maps, CAMERA).patches(np.array([bearing]), np.array([distance]))
    counted = patch_by_counting(maps, bearing, distance)
    np.testing.assert_allclose(reported.reshape(LAYERS, UP, ACROSS), counted, atol=0.08)
    assert np.abs(reported.ravel() - counted.ravel()).mean() < 0.01


@settings(max_examples=40)
@given(st.integers(0, 5), BEARINGS, DISTANCES, st.integers(0, WIDTH - 1))
def test_an_image_rolled_and_a_bearing_turned_give_the_same_patch(seed, bearing, distance, columns):
    maps = blots(seed)
    rolled = np.ascontiguousarray(np.roll(maps, columns, axis=2))
    away = np.array([distance])
    here = FigureMap.build(*maps, CAMERA).patches(np.array([bearing]), away)
    there = FigureMap.build(*rolled, CAMERA).patches(np.array([bearing - columns * math.tau / WIDTH]), away)
    np.testing.assert_allclose(there, here, atol=0.03)


@given(BEARINGS, DISTANCES, st.integers(-3, 3))
def test_whole_turns_make_no_difference(bearing, distance, turns):
    figures = FigureMap.build(*blots(1), CAMERA)
    one, other = figures.patches(np.array([bearing, bearing + turns * math.tau]), np.full(2, distance))
    np.testing.assert_allclose(one, other, atol=1e-2)


@pytest.mark.parametrize("bearing", [0.0, 1.0, math.pi, -2.0])
@pytest.mark.parametrize("distance", [1.2, 2.0, 4.0, 7.0])
def test_a_person_looks_the_same_at_every_distance(distance, bearing):
    mask, _ = mask_of(Cardboard(distance, bearing))
    reported = figures_of(mask.astype(np.float32)).patches(np.array([bearing]), np.array([distance]))
    people = reported.reshape(LAYERS, UP, ACROSS)[PEOPLE]
    heights = TOP_M + (BOTTOM_M - TOP_M) * (np.arange(UP) + 0.5) / UP
    aside = HALF_WIDTH_M * np.abs(1 - 2 * (np.arange(ACROSS) + 0.5) / ACROSS)
    body, floor = np.ix_(heights > 0.1, aside < 0.12), heights < -0.12
    in_image = reported.reshape(LAYERS, UP, ACROSS)[KNOWN].min(axis=1) > 0.99
    assert people[body][in_image[heights > 0.1]].min() > 0.9
    assert people[floor].max() < 0.1
    assert people[:, aside > 0.36].max() < 0.1


def test_of_what_is_covered_nothing_counts():
    people, covered = np.ones((HEIGHT, WIDTH), np.float32), np.ones((HEIGHT, WIDTH), np.float32)
    assert not figures_of(people, covered).patches(np.zeros(1), np.full(1, 2.0)).any()
    whole = figures_of(people).patches(np.zeros(1), np.full(1, 2.0)).reshape(LAYERS, UP, ACROSS)
    np.testing.assert_allclose(whole, 1.0, atol=1e-3)


def test_beyond_the_lower_border_nothing_is_known():
    reported = figures_of(np.ones((HEIGHT, WIDTH), np.float32)).patches(np.zeros(1), np.full(1, 1.0))
    known = reported.reshape(LAYERS, UP, ACROSS)[KNOWN]
    assert known[0] == pytest.approx(1.0, abs=1e-3)
    assert not known[-1].any()


def test_cells_far_above_a_low_camera_show_nothing():
    low, maps = all_round(0.5), np.ones((3, 180, 480), np.float32)
    figures = FigureMap.build(maps[0], maps[1], 0.0 * maps[2], low)
    patch = figures.patches(np.zeros(1), np.array([0.6])).reshape(LAYERS, UP, ACROSS)
    assert (patch[:, :3] == 0.0).all()
    assert patch[KNOWN].max() == pytest.approx(1.0)
