"""The view from above, and its pieces."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig, depths_m, find_pieces, gaps, u_depth

CONFIG = UDepthConfig(trimmed=0.0)
ROWS = len(depths_m(CONFIG.row_m))


def counts_of(*blocks: tuple[int, int, int, int, int], width: int = 80) -> np.ndarray:
    counts = np.zeros((ROWS, width), np.int32)
    for first, last, left, right, count in blocks:
        counts[first : last + 1, left : right + 1] = count
    return counts


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), top=st.integers(0, 20), bottom=st.integers(20, 39))
def test_counts_are_those_of_a_plain_loop(seed: int, top: int, bottom: int) -> None:
    depth = np.random.default_rng(seed).integers(0, 11000, (40, 12)).astype(np.uint16)
    counts = u_depth(depth, np.full(ROWS, float(top)), np.full(ROWS, float(bottom)), CONFIG.row_m)
    expected = np.zeros((ROWS, 12), np.int32)
    for v in range(top, bottom + 1):
        for u in range(12):
            if depth[v, u] > 0 and depth[v, u] // 20 < ROWS:
                expected[depth[v, u] // 20, u] += 1
    assert np.array_equal(counts, expected)


def test_a_piece_has_the_extents_of_its_readings() -> None:
    (piece,) = find_pieces(counts_of((150, 159, 10, 29, 20)), CONFIG)
    assert (piece.left, piece.right, piece.mass) == (10, 29, 4000)
    assert (piece.near_m, piece.far_m) == pytest.approx((3.0, 3.2))
    assert piece.depth_m == pytest.approx(3.1)


def test_cells_with_ten_readings_or_fewer_are_dropped() -> None:
    assert find_pieces(counts_of((150, 159, 10, 29, 10)), CONFIG) == ()


@pytest.mark.parametrize(("row", "gap"), [(100, 2), (150, 4), (200, 6), (300, 10)])
def test_the_connector_bridges_wider_gaps_farther_away(row: int, gap: int) -> None:
    config = UDepthConfig(row_m=0.01, bridged_steps=0.0, trimmed=0.0)
    rows = round(row * 2)
    counts = np.zeros((len(depths_m(0.01)), 40), np.int32)
    counts[rows, 5:20] = counts[rows + gap + 1, 5:20] = 20
    assert len(find_pieces(counts, config)) == 1
    counts[:] = 0
    counts[rows, 5:20] = counts[rows + gap + 2, 5:20] = 20
    assert len(find_pieces(counts, config)) == 2


def test_without_the_connector_depths_fall_apart() -> None:
    counts = counts_of((300, 300, 10, 29, 20), (303, 303, 10, 29, 20))
    assert len(find_pieces(counts, CONFIG)) == 1
    assert len(find_pieces(counts, UDepthConfig(has_connector=False))) == 2


def test_gaps_grow_with_the_steps_of_the_sensor() -> None:
    reach = gaps(CONFIG)
    assert (np.diff(reach) >= 0).all()
    assert reach[round(9.0 / CONFIG.row_m)] * CONFIG.row_m > 0.00287 * 81.0
