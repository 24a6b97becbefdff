"""The particle filter on the floor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.reproductions.rgbd.floor_filter import FloorFilter
from peopleboy.tracker.reproductions.rgbd.observation_model import Body, colours_in
from peopleboy.tracker.reproductions.rgbd.rgbd_config import FloorFilterConfig
from peopleboy.tracker.sensors.depth.depth_view import RgbdView
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view
from tests.helpers.images.as_taken import as_taken

CONFIG = FloorFilterConfig()
small = st.floats(-0.3, 0.3)


def view_of(*blocks: Block) -> RgbdView:
    """Blocks are red, everything else grey."""
    depth = depth_of(blocks)
    colour = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
    for block in blocks:
        colour[depth == round(1000 * block.z_m)] = (200, 30, 30)
    return RgbdView(depth, as_taken(colour), make_view(), 0.0)


def body_in(view: RgbdView) -> Body:
    reds = np.flatnonzero((view.colour[..., 0] == 200).any(axis=0))
    box = (float(reds[0]), 90.0, float(len(reds)), 60.0)
    return Body(0.45, 1.65, 0.0, colours_in(view, box))


@given(x=st.floats(-5, 5), y=st.floats(-5, 5), advance=small, aside=small, turn=st.floats(-0.5, 0.5))
def test_a_place_that_stands_still_is_carried_as_the_robot_moves(
    x: float, y: float, advance: float, aside: float, turn: float
) -> None:
    after = Pose2(advance, aside, turn).points_to_local(np.array([x, y]))
    back = complex(*after) * complex(math.cos(turn), math.sin(turn)) + complex(advance, aside)
    assert (back.real, back.imag) == pytest.approx((x, y), abs=1e-9)


def test_what_is_ahead_is_on_the_right_after_a_turn_to_the_left() -> None:
    x, y = Pose2(heading=0.1).vectors_to_local(np.array([1.0, 0.0]))
    assert x > 0.9
    assert y < 0.0


def test_particles_walk_on_with_their_speeds() -> None:
    rng = np.random.default_rng(0)
    state = np.tile([4.0, 0.0, 0.0, 1.2], (2000, 1))
    moved = FloorFilter(state).predicted(0.5, CONFIG, rng)
    assert moved.place_m == pytest.approx((4.0, 0.7 * 0.6), abs=0.02)
    assert moved.state[:, 2:].mean(axis=0) == pytest.approx((0.0, 1.2), abs=0.05)


def test_particles_go_to_who_looks_like_the_person() -> None:
    view, rng = view_of(Block(0.3, 4.0)), np.random.default_rng(1)
    cloud = FloorFilter.begin(np.array([4.1, -0.15]), CONFIG, rng)
    for _ in range(8):
        update = cloud.predicted(1 / 15, CONFIG, rng).weighed(view, body_in(view), CONFIG, rng)
        assert not update.is_held
        cloud = update.filter
    assert update.place_m == pytest.approx((4.0, -0.3), abs=0.08)
    assert update.confidence > 0.5


def test_particles_are_held_while_somebody_else_is_in_front() -> None:
    lone = view_of(Block(0.3, 4.0))
    hidden = view_of(Block(0.3, 4.0), Block(0.2, 2.5, width_m=0.9))
    rng = np.random.default_rng(1)
    cloud = FloorFilter.begin(np.array([4.0, -0.3]), CONFIG, rng)
    update = cloud.weighed(hidden, body_in(lone), CONFIG, rng)
    assert update.is_held
    assert update.filter is cloud
    assert update.confidence == 0.0
