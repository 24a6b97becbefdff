from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.scenarios.recording.rows import METRE_STEP, PIXEL_STEP, TURN_STEP, rounded


@pytest.mark.parametrize("step", [METRE_STEP, PIXEL_STEP, TURN_STEP])
@given(values=arrays(np.float64, (4, 3), elements=st.floats(-1000.0, 1000.0)))
def test_rounding_gives_the_nearest_multiple_and_no_negative_zero(values: np.ndarray, step: float) -> None:
    short = rounded(values, step)
    assert np.abs(short - values).max() <= step / 2
    assert np.array_equal(short % step, np.zeros_like(short))
    assert not np.signbit(short[short == 0.0]).any()
