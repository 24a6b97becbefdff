from __future__ import annotations

import numpy as np
import pytest

from peopleboy.sim.places.extent import BoxSet, boxes_of, overlaps
from peopleboy.sim.places.furniture.place_things import build_thing
from peopleboy.sim.places.furniture.thing_config import ThingConfig
from peopleboy.sim.places.moving import Stance


def random_boxes(rng: np.random.Generator, count: int) -> BoxSet:
    return BoxSet(
        rng.uniform(-1.0, 1.0, (count, 3)), rng.uniform(0.1, 0.6, (count, 3)), rng.uniform(-3.0, 3.0, count)
    )


def inside(boxes: BoxSet, k: int, points: np.ndarray) -> np.ndarray:
    """Whether points are in a box: by turning them into its frame."""
    offset = points - boxes.centre[k]
    c, s = np.cos(boxes.heading[k]), np.sin(boxes.heading[k])
    own = np.stack(
        [c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0], offset[:, 2]], 1
    )
    return np.asarray(np.all(np.abs(own) <= boxes.half[k], axis=1))


def test_boxes_overlap_where_some_point_is_in_both() -> None:
    rng = np.random.default_rng(1)
    a, b = random_boxes(rng, 12), random_boxes(rng, 12)
    told = overlaps(a, b, 0.0)
    points = rng.uniform(-2.0, 2.0, (200_000, 3))
    for i in range(12):
        within = points[inside(a, i, points)]
        for k in range(12):
            if inside(b, k, within).any():
                assert told[i, k]
    deep = overlaps(a, b, 0.25)
    assert 0 < deep.sum() < told.sum() < told.size
    assert not (deep & ~told).any()


def test_distances_are_to_the_nearest_side_of_the_nearest_box() -> None:
    boxes = BoxSet(
        np.array([[0.0, 0.0, 1.0], [5.0, 0.0, 1.0]]), np.full((2, 3), 0.5), np.array([0.0, np.pi / 4])
    )
    assert boxes.distance((1.5, 0.0)) == pytest.approx(1.0)
    assert boxes.distance((0.1, -0.2)) == 0.0
    assert boxes.distance((4.0, 0.0)) == pytest.approx(1.0 - np.sqrt(0.5))
    assert boxes.between(2.0, 3.0).distance((0.0, 0.0)) == np.inf


def test_boxes_of_a_thing_move_as_it_does() -> None:
    at = Stance((2.0, 1.0, 0.3), 0.7)
    thing = build_thing(ThingConfig(kind="table"), Stance((2.0, 1.0, 0.3), 0.7), name="x")
    there = boxes_of(thing, at).moved(at)
    world = boxes_of(thing)
    assert len(there.heading) == 5
    assert there.centre == pytest.approx(world.centre)
    assert there.heading == pytest.approx(world.heading)
