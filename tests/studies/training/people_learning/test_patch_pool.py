import numpy as np

from peopleboy.studies.training.people_learning.patch_pool import patch_pool
from peopleboy.studies.training.people_learning.window_mining import CELLS
from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.window import COLUMNS, ROWS


def test_every_cell_may_be_asked_for_by_itself() -> None:
    pool = patch_pool(0)
    places = {(int(channel), *box) for channel, box in zip(pool.channel, pool.first.tolist(), strict=True)}
    assert len(pool) == len(places) == CELLS
    assert not pool.second.any()
    assert all(bottom - top == right - left == 1 for _, top, left, bottom, right in places)


def test_what_is_drawn_lies_in_the_window_and_is_always_the_same() -> None:
    pool, again = patch_pool(2000), patch_pool(2000)
    for boxes in (pool.first, pool.second):
        assert (boxes[:, :2] <= boxes[:, 2:]).all()
        assert (boxes[:, 2:] <= (ROWS, COLUMNS)).all()
    assert set(pool.channel.tolist()) == set(range(CHANNELS))
    np.testing.assert_array_equal(again.first, pool.first)
    np.testing.assert_array_equal(again.second, pool.second)


def test_pairs_beside_each_other_mirrored_and_anywhere_are_all_drawn() -> None:
    pool = patch_pool(2000)
    first, second = (boxes[CELLS:].astype(int) for boxes in (pool.first, pool.second))
    is_alone = ~second.any(axis=1)
    is_as_large = ((first[:, 2:] - first[:, :2]) == (second[:, 2:] - second[:, :2])).all(axis=1)
    mirrored = np.stack([first[:, 0], COLUMNS - first[:, 3], first[:, 2], COLUMNS - first[:, 1]], axis=1)
    is_mirrored = (second == mirrored).all(axis=1)
    assert 0.2 < is_alone.mean() < 0.4
    assert 0.1 < is_mirrored.mean() < 0.3
    assert 0.2 < (is_as_large & ~is_mirrored).mean() < 0.5
    assert (~is_alone & ~is_as_large).mean() > 0.1
