"""Components of a mask, connected by depth and by the time of change."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label

from peopleboy.tracker.scene_model.connected_pieces import PixelSpan, pieces_of, pixels_by_label


def test_at_one_depth_they_are_those_of_eight_neighbours(rng: np.random.Generator) -> None:
    mask = rng.random((40, 60)) < 0.4
    labels, count = pieces_of(mask, np.ones(mask.shape, np.float32), 0.1)
    expected, number = label(mask, np.ones((3, 3)))
    assert count == number
    assert np.array_equal(labels, expected)
    assert [len(pixels) for _, pixels in pixels_by_label(labels, count)] == np.bincount(labels.flat)[
        1:
    ].tolist()


def test_where_all_neighbours_lie_apart_every_pixel_is_one() -> None:
    row, column = np.mgrid[:30, :41]
    depth = (1 + 2 * (row % 2) + 4 * (column % 2)).astype(np.float32)
    labels, count = pieces_of(np.ones(depth.shape, bool), depth, 0.1)
    assert count == labels.size
    assert np.array_equal(labels.ravel(), np.arange(1, count + 1))


def test_neighbours_that_changed_at_different_times_are_not_connected() -> None:
    mask, depth = np.ones((4, 6), bool), np.ones((4, 6), np.float32)
    first = np.repeat(np.array([[0.0, 0.0, 0.0, 5.0, 5.0, 5.0]], np.float32), 4, axis=0)
    span = PixelSpan(first, first + np.float32(1.0), first, 0.5)
    labels, count = pieces_of(mask, depth, 0.1, span)
    assert count == 2
    assert np.array_equal(labels, np.repeat([[1, 1, 1, 2, 2, 2]], 4, axis=0))


def test_an_empty_mask_has_none() -> None:
    labels, count = pieces_of(np.zeros((3, 3), bool), np.ones((3, 3), np.float32), 0.1)
    assert count == 0
    assert not labels.any()
