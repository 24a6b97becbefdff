import numpy as np
import pytest

from peopleboy.studies.training.people_learning.boosting import Boosting
from peopleboy.studies.training.people_learning.patch_pool import patch_pool
from peopleboy.studies.training.people_learning.teach_cascade import teach_cascade
from peopleboy.studies.training.people_learning.teach_placing import teach_placing
from peopleboy.studies.training.people_learning.window_mining import CELLS
from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.patches import summed, summed_windows
from peopleboy.tracker.proposals.placing import offsets
from peopleboy.tracker.proposals.window import COLUMNS, ROWS
from tests.helpers.calls.refused import refused


def test_most_people_come_through() -> None:
    rng = np.random.default_rng(0)
    people, others = (rng.normal(size=(200, CELLS)).astype(np.float16) for _ in range(2))
    people[:, :50] += 1
    cascade = teach_cascade(people, others, patch_pool(50), Boosting(20, 0.3))
    running = cascade.running(summed_windows(people))
    assert (running >= cascade.least).all(axis=1).mean() > 0.8
    assert np.isfinite(cascade.least).all()


@pytest.mark.slow
def test_trees_learn_where_in_their_windows_people_are() -> None:
    rng = np.random.default_rng(0)
    seen = rng.normal(size=(200, CELLS)).astype(np.float16)
    is_so = seen[:, [5, 400, 900, 1700]] > 0
    told = np.where(is_so, [0.1, 0.05, 0.1, 0.5], [-0.1, -0.05, -0.1, 0.3])
    # Little else, or of the features that are drawn few would be of use.
    seen[:] = np.repeat(is_so, CELLS // 4, axis=1) + 0.01 * seen
    placing = teach_placing(seen, told, patch_pool(0))
    none, window = np.zeros(1, np.int64), np.array([[100.0, 50.0, 16.0, 40.0]])
    found = np.concatenate(
        [
            offsets(window, placing.boxes(summed(cells), none, none, window))
            for cells in seen.astype(np.float32).reshape(-1, CHANNELS, ROWS, COLUMNS)
        ]
    )
    np.testing.assert_allclose(found, told, atol=0.03)


def test_too_few_windows_are_refused() -> None:
    few, many = np.zeros((3, CELLS), np.float16), np.zeros((50, CELLS), np.float16)
    with refused("3 windows with people", "take more worlds"):
        teach_cascade(few, many, patch_pool(0), Boosting(2, 0.3))
