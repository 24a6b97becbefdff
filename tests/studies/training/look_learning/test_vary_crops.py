import jax
import numpy as np
import pytest

from peopleboy.studies.training.look_learning.vary_crops import varied
from peopleboy.tracker.proposals.looks.crops import PLANES

vary = jax.jit(varied)

OUTSIDE = 25  # the first row that is below the image


def drawn_planes(count: int, rows: int = 32, columns: int = 24) -> np.ndarray:
    planes = np.random.default_rng(0).normal(0.0, 1.0, (count, rows, columns, PLANES)).astype(np.float32)
    planes[..., 1] = np.abs(planes[..., 1])
    planes[..., 2] = 1.0
    planes[:, OUTSIDE:] = 0.0  # below the image
    return planes


@pytest.mark.slow
@pytest.mark.parametrize(("rows", "columns"), [(32, 24), pytest.param(40, 36, marks=pytest.mark.thorough)])
def test_what_is_outside_the_image_stays_outside(rows: int, columns: int) -> None:
    planes = drawn_planes(400, rows, columns)
    after = np.asarray(vary(planes, jax.random.key(1)))
    assert after.shape == planes.shape
    np.testing.assert_array_equal(after[..., 2], planes[..., 2])
    assert not after[:, OUTSIDE:].any()


def test_some_crops_are_covered_and_some_stand_still() -> None:
    planes = drawn_planes(400)
    after = np.asarray(vary(planes, jax.random.key(2)))
    is_still = ~after[..., 1].any(axis=(1, 2))
    assert 0.08 < is_still.mean() < 0.25
    moves = after[~is_still][:, :OUTSIDE, :, 1]
    covered = (moves == 0.0).mean(axis=(1, 2))
    assert 0.08 < (covered > 0.01).mean() < 0.35
    assert covered.max() < 0.5


def test_the_same_key_gives_the_same() -> None:
    planes = drawn_planes(400)
    one, same, other = (np.asarray(vary(planes, jax.random.key(key))) for key in (5, 5, 6))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
