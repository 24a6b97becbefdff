import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.scenarios.scores.bootstrap import bootstrap

NAN = math.nan


@given(st.lists(st.floats(-1e3, 1e3) | st.just(NAN), min_size=1, max_size=20))
def test_the_interval_holds_the_mean_and_lies_within_the_values(values):
    found = bootstrap(values, np.random.default_rng(0))
    known = [value for value in values if not math.isnan(value)]
    if not known:
        assert math.isnan(found.mean)
        return
    assert min(known) - 1e-6 <= found.low <= found.high <= max(known) + 1e-6
    assert found.mean == pytest.approx(np.mean(known))


def test_the_interval_of_many_normal_values_is_that_of_the_standard_error():
    values = np.random.default_rng(1).normal(5.0, 2.0, 400)
    found = bootstrap(values.tolist(), np.random.default_rng(0))
    assert (found.high - found.low) / 2.0 == pytest.approx(1.96 * values.std() / 20.0, rel=0.1)
