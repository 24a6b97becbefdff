from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from pycocotools import mask as reference

from peopleboy.scenarios.export.run_lengths import encode_lengths, run_lengths

# What pycocotools decodes into is older than numpy 2.
pytestmark = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")

masks = arrays.arrays(np.bool_, st.tuples(st.integers(1, 40), st.integers(1, 40)))


@given(mask=masks)
def test_masks_are_encoded_as_pycocotools_encodes_them(mask: np.ndarray) -> None:
    ours = {"size": list(mask.shape), "counts": encode_lengths(run_lengths(mask))}
    theirs = reference.encode(np.asfortranarray(mask, np.uint8))
    assert ours["counts"] == theirs["counts"].decode()
    assert np.array_equal(reference.decode(ours), mask)


def test_long_runs_take_several_groups() -> None:
    mask = np.zeros((960, 1280), np.bool_)
    mask[100:900, 300:1200] = True
    theirs = reference.encode(np.asfortranarray(mask, np.uint8))
    assert encode_lengths(run_lengths(mask)) == theirs["counts"].decode()


@given(mask=masks)
def test_lengths_add_up_to_the_pixels_and_every_second_one_to_the_mask(mask: np.ndarray) -> None:
    lengths = run_lengths(mask)
    assert (sum(lengths), sum(lengths[1::2])) == (mask.size, mask.sum())
