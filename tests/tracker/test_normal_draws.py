from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.normal_draws import source_of, standard_normals


@pytest.mark.parametrize("count", [0, 1, 5000, 40_000])
@pytest.mark.parametrize("is_within_word", [False, True])
def test_numbers_and_the_generator_after_them_are_numpys_to_the_bit(count: int, is_within_word: bool) -> None:
    # 40 000 numbers meet all layers, and the tail about ten times; the last ones want further words.
    for seed in range(12):
        ours, numpys = np.random.default_rng(seed), np.random.default_rng(seed)
        if is_within_word:  # of 64 bits
            assert ours.random(dtype=np.float32) == numpys.random(dtype=np.float32)
        drawn = standard_normals(*source_of(ours), count)
        meant = numpys.standard_normal(count, dtype=np.float32)
        assert np.array_equal(drawn.view(np.uint32), meant.view(np.uint32))
        assert ours.bit_generator.state == numpys.bit_generator.state
