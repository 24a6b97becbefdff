from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.cameras.imaging.camera_view import KELVIN_STEP, LIGHT_STEP, make_paint_table
from peopleboy.sim.cameras.imaging.surfaces import (
    PixelRun,
    paint_run,
    painted,
)
from peopleboy.sim.shapes.materials import Painting, Unrolling

ROWS, COLUMNS, TEXEL_M = 5, 7, 0.1


def slope(unrolling: Unrolling) -> Painting:
    """3 K a metre across and 2 K a metre up, from the first texel on; light falls by a half."""
    across, up = np.meshgrid(np.arange(COLUMNS) * TEXEL_M, np.arange(ROWS) * TEXEL_M)
    return Painting(
        unrolling=unrolling,
        origin_m=(-0.3, 0.2),
        texel_m=TEXEL_M,
        kelvin=(3.0 * across + 2.0 * up).astype(np.float32),
        light=(1.0 - 0.5 * across).astype(np.float32),
    )


@given(st.floats(0.0, 0.59), st.floats(0.0, 0.39), st.floats(-2.0, 2.0))
def test_between_texels_a_painting_is_linear_whatever_lies_across_it(
    across: float, up: float, other: float
) -> None:
    paint, texels = make_paint_table(
        [None, *(slope(way) for way in (Unrolling.UPRIGHT, Unrolling.LEVEL, Unrolling.ASLANT))]
    )
    expected = (3.0 * across + 2.0 * up, 1.0 - 0.5 * across)
    upright = painted(paint, texels, 1, across - 0.3 - other, other, up + 0.2)
    level = painted(paint, texels, 2, across - 0.3, up + 0.2, other)
    assert upright == pytest.approx(expected, abs=0.002)
    assert level == pytest.approx(expected, abs=0.002)
    # Of a round thing, both sums of two coordinates change whichever way one looks at it.
    aslant = painted(paint, texels, 3, across - 0.3 - other, other, up + 0.2 - 0.5 * (across - 0.3) + other)
    assert aslant == pytest.approx(expected, abs=0.002)


@pytest.mark.parametrize("unrolling", Unrolling)
def test_a_run_of_pixels_shows_what_a_painting_has_at_their_points(unrolling: Unrolling) -> None:
    rng = np.random.default_rng(3)
    paint, texels = make_paint_table([None, slope(unrolling), slope(unrolling)])
    depths = rng.uniform(0.2, 1.0, 9).astype(np.float32)
    matrices = rng.uniform(-0.2, 0.2, (3, 3, 4))
    for v, layer, step, part in ((1, 0, KELVIN_STEP, 1), (3, 1, LIGHT_STEP, 2)):
        line = np.full(9, np.nan, np.float32)
        paint_run(line, PixelRun(2, 8, np.int32(part), v, depths, matrices), paint, texels[layer], step)
        for u in range(2, 8):
            point = matrices[part] @ (u * depths[u], v * depths[u], depths[u], 1.0)
            assert line[u] == pytest.approx(painted(paint, texels, part, *point)[layer], abs=1e-4)
        assert np.isnan(line[[0, 1, 8]]).all()


def test_beyond_its_edge_a_painting_goes_on_as_it_ends() -> None:
    paint, texels = make_paint_table([slope(Unrolling.LEVEL)])
    assert painted(paint, texels, 0, -9.0, -9.0, 0.0) == pytest.approx((0.0, 1.0), abs=0.01)
    assert painted(paint, texels, 0, 9.0, 9.0, 0.0) == pytest.approx((1.8 + 0.8, 0.7), abs=0.01)


def test_a_part_without_a_painting_takes_no_texels() -> None:
    paint, texels = make_paint_table([None, None])
    assert (paint[:, 0] < 0.0).all()
    assert texels.size == 0
