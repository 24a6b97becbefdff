from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.studies.training.look_learning.electronics import (
    equalised,
    sharpened,
    through_electronics,
)
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.camera_mount import Mount


def drawn_shot(seed: int = 0) -> PeopleShot:
    rng = np.random.default_rng(seed)
    grey = cv2.GaussianBlur(rng.normal(80.0, 60.0, (48, 64)), (0, 0), 2.0) * 2.0 - 80.0
    return PeopleShot(
        grey=np.clip(grey, 0.0, 255.0).astype(np.uint8),
        change=rng.integers(0, 40, (48, 64)).astype(np.uint8),
        mount=Mount(20.0, 80.0, 1.2),
        box=np.array([[10.0, 5.0, 8.0, 30.0]]),
        is_good=np.ones(1, np.bool_),
        is_clear=np.ones(1, np.bool_),
    )


@given(seed=st.integers(0, 99), share=st.floats(0.0, 1.0))
def test_equalising_keeps_the_order_of_greys(seed: int, share: float) -> None:
    before = drawn_shot(seed)
    after = equalised(before, share)
    order = np.argsort(before.grey, axis=None)
    assert (np.diff(after.grey.ravel()[order].astype(int)) >= 0).all()


def test_equalised_greys_are_all_as_frequent_and_what_changes_follows() -> None:
    before = drawn_shot()
    after = equalised(before, 1.0)
    assert np.quantile(after.grey, [0.25, 0.5, 0.75]) == pytest.approx([64, 128, 191], abs=12)
    narrow = replace(before, grey=(100 + before.grey // 8).astype(np.uint8))
    assert equalised(narrow, 1.0).change.mean() > 3.0 * narrow.change.mean()
    unchanged = equalised(before, 0.0)
    np.testing.assert_array_equal(unchanged.grey, before.grey)
    np.testing.assert_array_equal(unchanged.change, before.change)


def test_sharpening_leaves_rims_at_edges_alone() -> None:
    step = np.full((20, 40), 80, np.uint8)
    step[:, 20:] = 160
    after = sharpened(step, 1.5, 1.0)
    assert after[10, 19] < 80
    assert after[10, 20] > 160
    np.testing.assert_array_equal(after[:, [2, 37]], step[:, [2, 37]])


def test_people_stay_where_they_are() -> None:
    rng = np.random.default_rng(0)
    shot = drawn_shot()
    came = [through_electronics(shot, rng) for _ in range(40)]
    assert all(one.box is shot.box and one.grey.shape == shot.grey.shape for one in came)
    assert 4 < sum(np.array_equal(one.grey, shot.grey) for one in came) < 30
