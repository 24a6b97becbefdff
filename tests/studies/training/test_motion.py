from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("optax")

from peopleboy.studies.training.motion import MotionTraining
from peopleboy.studies.training.samples import SampleTask, Split
from peopleboy.studies.training.walks import Walks, collect_library, samples_of
from peopleboy.tracker.prediction.motion_network import KNOTS_S
from peopleboy.tracker.prediction.tracked_people import STEP_S


def straight_walks(count: int, turn_after_s: float) -> Walks:
    """Return people who walk ahead, and stop after some time."""
    time_s = STEP_S * np.arange(150)
    walked_m = np.minimum(time_s, turn_after_s)
    people = np.zeros((150, count, 4))
    people[:, :, 0], people[:, :, 1] = 2.0 + walked_m[:, None], np.arange(count)
    people[:, :, 2] = (time_s < turn_after_s)[:, None]
    return Walks(people=people, robot=np.zeros((150, 5)))


def test_walks_of_a_scenario_have_the_places_of_its_people() -> None:
    walks = collect_library("crossing_2", 0)
    later = walks.people[1:, :, :2] - walks.people[:-1, :, :2]
    off = later / STEP_S - walks.people[1:, :, 2:]
    assert walks.people.shape[1] == 2
    assert np.nanmedian(np.abs(off)) < 0.1


def test_samples_have_the_true_places_later() -> None:
    walks = straight_walks(2, 100.0)
    for sample in samples_of(walks, np.random.default_rng(0)):
        is_known = np.isfinite(sample.later_m[0, :, 0])
        gaps_m = np.diff(sample.later_m[0, is_known, 0])
        assert gaps_m == pytest.approx(np.diff(KNOTS_S[is_known]))


def test_training_is_reproducible(tmp_path: Path) -> None:
    tasks = []
    for number in range(10):
        path = tmp_path / f"{number}.npz"
        straight_walks(8, 5.0 + number).save(path)
        tasks.append(SampleTask(path, straight_walks, ()))
    training = MotionTraining(sequences=10, epochs=2)
    data = training.load(Split(tasks[:8], tasks[8:]))
    first, second = (next(iter(training.fit(data).values())) for _ in range(2))
    assert all(np.array_equal(*layers) for layers in zip(first.layers, second.layers, strict=True))
    assert (first.scale > 0.0).all()
