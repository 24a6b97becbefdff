"""The scene model as its source prints it."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.studies.reproductions.scene_model.clusters import _flow, _linked
from peopleboy.studies.reproductions.scene_model.ellipses import inside, propagated
from peopleboy.studies.reproductions.scene_model.printed_config import VARIANTS, EllipseConfig, PrintedConfig
from peopleboy.studies.reproductions.scene_model.printed_model import PrintedSceneModel
from peopleboy.tracker.frame import DEPTH_COLOUR
from peopleboy.tracker.scene_model.scene import VistaScene
from tests.helpers.still_room import Screen, room_frame, true_depth

BOX = Screen(3.0, 0.3, -0.3, 0.0, 0.6)


@pytest.fixture
def rng() -> np.random.Generator:
    """Draws the same in every test."""
    return np.random.default_rng(0)


def last(name: str, films: list[list[Screen]], rng: np.random.Generator) -> VistaScene:
    model = PrintedSceneModel(VARIANTS[name], rng)
    return [model.update(room_frame(k, screens)) for k, screens in enumerate(films)][-1]


def test_the_mean_is_that_of_all_frames(rng: np.random.Generator) -> None:
    scene = last("mean", [[]] * 10 + [[BOX]] * 30, rng)
    wall, owner = true_depth([])[0][100, 80], true_depth([BOX])[1][100, 80]
    assert owner == 1
    assert scene.background_m[100, 80] == pytest.approx((10 * wall + 30 * 3.0) / 40, abs=0.01)


def test_adapt_keeps_the_farther_and_calls_the_nearer_movable(rng: np.random.Generator) -> None:
    scene = last("adapt", [[]] * 10 + [[BOX]] * 30, rng)
    empty, _ = true_depth([])
    inner = true_depth([replace(BOX, left_m=0.2, right_m=-0.2, top_m=0.5, foot_m=0.1)])[1] > 0
    assert scene.background_m[inner] == pytest.approx(empty[inner], abs=0.01)
    assert (scene.things > 0)[inner].all() or (scene.people > 0)[inner].all()


def test_linked_points_of_a_cluster_are_no_farther_apart_than_the_level(rng: np.random.Generator) -> None:
    data = rng.uniform(0.0, 1.0, (300, 6))
    blocks = np.repeat([7, 3], 150)
    index = _linked(data, blocks, 0.6)
    assert set(index) == set(range(index.max() + 1))
    for one in range(index.max() + 1):
        own = data[index == one]
        assert np.linalg.norm(own[:, None] - own[None], axis=2).max() <= 0.6
        assert len(set(blocks[index == one])) == 1


def test_the_flow_finds_the_displacement_of_an_image(rng: np.random.Generator) -> None:
    before = cv2.GaussianBlur(rng.uniform(0.0, 255.0, (80, 100)).astype(np.float32), (0, 0), 3.0)
    before = cv2.normalize(before, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)
    flow = _flow(np.roll(before, (2, 3), (0, 1)), before, PrintedConfig())
    assert np.nanmedian(flow[20:60, 20:80], axis=(0, 1)) == pytest.approx([-3.0, -2.0], abs=0.1)


def test_given_pixels_of_people_replace_tracked_ones(rng: np.random.Generator) -> None:
    model = PrintedSceneModel(VARIANTS["adapt"], rng)
    frame = room_frame(0, [])
    moving = np.zeros(true_depth([])[0].shape, np.bool_)
    moving[50:70, 30:60] = True
    scene = model.update(frame, moving)
    assert ((scene.people > 0) == moving).all()
    assert not scene.background_m[moving].any()


def test_adapt_learns_at_once_what_is_farther(rng: np.random.Generator) -> None:
    scene = last("adapt", [[BOX]] * 10 + [[]] * 10, rng)
    empty, _ = true_depth([])
    known = scene.background_m > 0.0
    assert np.abs(scene.background_m - empty)[known].max() < 0.06


def test_who_does_not_turn_walks_straight_on(rng: np.random.Generator) -> None:
    config = EllipseConfig(particles=50, first_order=1.0, turn_sd=0.0, speed_sd_m=0.0, radius_sd_m=0.0)
    particles = propagated(np.array([1.0, 2.0, math.pi / 2, 0.1, 0.3, 0.3]), config, rng)
    assert particles[:, :4] == pytest.approx(np.tile([1.0, 2.1, math.pi / 2, 0.1], (50, 1)))


def test_an_arc_is_as_long_as_the_way(rng: np.random.Generator) -> None:
    config = EllipseConfig(particles=500, first_order=1.0, turn_sd=0.5, speed_sd_m=0.0)
    particles = propagated(np.array([0.0, 0.0, 0.0, 0.1, 0.3, 0.3]), config, rng)
    chords = np.hypot(*particles[:, :2].T)
    assert (chords <= 0.1 + 1e-12).all()
    assert chords.mean() == pytest.approx(0.1, rel=0.03)


def test_an_ellipse_has_its_radii() -> None:
    state = np.array([1.0, 1.0, 0.0, 0.0, 0.4, 0.2])
    assert inside(state, np.array([[1.39, 1.0], [1.41, 1.0], [1.0, 1.19], [1.0, 1.21]]), 1.0).tolist() == [
        True, False, True, False,
    ]  # fmt: skip


def test_without_colours_or_amplitude_no_motion_is_seen(rng: np.random.Generator) -> None:
    frame = room_frame(0, [])
    bare = replace(frame, images={k: v for k, v in frame.images.items() if k != DEPTH_COLOUR})
    with pytest.raises(BadInput, match="depth_amplitude"):
        PrintedSceneModel(VARIANTS["adapt"], rng).update(bare)
