"""Readings sorted into what stands, and what stands before it."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.scene_model.layers import Layers
from peopleboy.tracker.scene_model.readings import Readings

SIZE = (12, 16)
NO_PEOPLE = np.zeros(SIZE, np.bool_)
REACH = np.full(SIZE, 0.05, np.float32)


def readings(depth_m: float | np.ndarray) -> Readings:
    image = np.broadcast_to(np.asarray(depth_m, np.float32), SIZE).astype(np.float32)
    return Readings(image, image, np.zeros(SIZE, np.bool_), np.full(SIZE, 1e-3, np.float32), 1)


def see(layers: Layers, depths_m: list[float], start: int = 0, ignored: np.ndarray = NO_PEOPLE) -> None:
    for k, depth in enumerate(depths_m, start):
        layers.take_in(readings(depth), REACH, ignored, k / 15.0, 5)


def test_the_background_is_the_mean_of_raw_inverse_depths() -> None:
    layers = Layers(*SIZE)
    seen = [4.0, 4.02, 3.98, 4.01, 3.99] * 4
    see(layers, seen)
    assert layers.surface_m(np.full(SIZE, 1e-3, np.float32)) == pytest.approx(
        1.0 / np.mean(1.0 / np.array(seen)), abs=1e-5
    )


def test_what_is_farther_becomes_background_only_after_five_readings_in_a_row() -> None:
    layers = Layers(*SIZE)
    see(layers, [3.0] * 20 + [4.0] * 4)
    assert layers.background_m == pytest.approx(3.0)
    see(layers, [4.0], start=24)
    assert layers.background_m == pytest.approx(4.0)
    assert layers.past_m == pytest.approx(3.0)
    assert layers.past_gone_s == pytest.approx(20 / 15.0)


def test_one_far_spike_leaves_the_background_as_it_is() -> None:
    layers = Layers(*SIZE)
    see(layers, ([3.0] * 6 + [9.0]) * 6)
    assert layers.background_m == pytest.approx(3.0)
    assert not layers.is_covered.any()


def test_what_is_nearer_is_a_thing_since_its_first_reading_and_hides_the_background() -> None:
    layers = Layers(*SIZE)
    see(layers, [4.0] * 30 + [3.0] * 30)
    assert layers.is_covered.all()
    assert layers.front_m == pytest.approx(3.0)
    assert layers.front_since_s == pytest.approx(30 / 15.0)
    assert layers.back_seen_s == pytest.approx(29 / 15.0)
    assert layers.background_m == pytest.approx(4.0)


def test_a_thing_is_remembered_behind_people_and_gone_when_the_background_is_seen() -> None:
    layers = Layers(*SIZE)
    see(layers, [4.0] * 30 + [3.0] * 30)
    see(layers, [2.0] * 30, start=60, ignored=~NO_PEOPLE)
    assert layers.is_covered.all()
    see(layers, [4.0] * 5, start=90)
    assert not layers.is_covered.any()


def test_what_was_read_first_by_chance_gives_way_to_what_is_read_oftener() -> None:
    layers = Layers(*SIZE)
    see(layers, [4.0] * 3 + ([3.0] * 6 + [4.0]) * 12)
    assert layers.background_m == pytest.approx(3.0)
