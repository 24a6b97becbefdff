import math

import numpy as np
import pytest

from peopleboy.scenarios.studies.distance_learning.distance_examples import Examples
from peopleboy.scenarios.studies.distance_learning.distance_trials import (
    BLOCKS,
    FILTERS,
    REPEATS,
    ErrorSummary,
    block_split,
    correlations,
    general_trials,
    personal_trials,
    position_trials,
    random_split,
    walks,
)
from peopleboy.scenarios.studies.distance_learning.show_distances import of_three, pooled, print_trials
from peopleboy.tracker.panoramic.paper.distance_network import Lessons

QUICK = Lessons(epochs=60)


def film(noise=0.02, seed=0):
    """Two people, one after the other, walk on circles; the second one is wider."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(400):
        person = 1 + k // 200
        distance, bearing = 3.5 + 2.0 * math.sin(k / 9), 1.2 * math.sin(k / 23)
        cues = np.array([60 * (1 + 0.4 * (person - 1)) / distance, 100 - 120 / distance, 3000 / distance**2])
        seen = cues * rng.normal(1.0, noise, 3)
        place = distance * math.cos(bearing), distance * math.sin(bearing)
        rows.append([person, k / 3, *seen, bearing + rng.normal(0.0, 0.02), *place])
    return Examples.of_rows(rows)


@pytest.mark.parametrize("split", [random_split, block_split])
def test_a_split_takes_each_image_once_and_learns_from_30_percent(split):
    training, rest = split(684, np.random.default_rng(0))
    assert sorted([*training, *rest]) == list(range(684))
    assert len(training) == pytest.approx(205, abs=5)


def changes_of_side(training):
    return np.count_nonzero(np.diff(np.isin(np.arange(684), training).astype(int)))


def test_blocks_keep_neighbours_on_one_side():
    assert changes_of_side(block_split(684, np.random.default_rng(3))[0]) < BLOCKS
    assert changes_of_side(random_split(684, np.random.default_rng(3))[0]) > 150


def test_pooled_errors_are_those_of_all_splits_in_one_heap():
    rng = np.random.default_rng(0)
    heaps = [rng.exponential(size=n) for n in (10, 33, 7)]
    every = np.concatenate(heaps)
    splits = [ErrorSummary.of(heap) for heap in heaps]
    assert pooled(splits) == pytest.approx((every.mean(), every.std()))
    told = of_three(splits)
    assert told["best"][0] == min(heap.mean() for heap in heaps)
    assert told["worst"][0] == max(heap.mean() for heap in heaps)


def test_the_general_model_is_tested_ten_times_and_always_the_same():
    run = film()
    found, again = (list(general_trials(run, "random", QUICK)) for _ in range(2))
    assert found == again
    assert len(found) == REPEATS
    assert {one.count for one in found} == {280}


def test_ones_own_model_is_better_where_people_differ():
    found = personal_trials(film(), "random", Lessons(epochs=400))
    mean = {pair: pooled(splits)[0] for pair, splits in found.items()}
    assert set(mean) == {(1, 1), (1, 2), (2, 1), (2, 2)}
    assert mean[1, 1] < mean[1, 2]
    assert mean[2, 2] < mean[2, 1]


def test_the_filter_that_is_told_its_own_noise_is_no_worse_than_the_model_alone():
    found = {way: pooled(splits)[0] for way, splits in position_trials(film(0.1), "random", QUICK).items()}
    assert list(found) == list(FILTERS)
    assert found["Kalman filter, own Q and R, u = last step"] <= found["appearance model"]


def test_walks_end_where_the_person_changes_or_an_image_is_missing():
    run = film()
    kept = np.delete(np.arange(400), [50, 51])
    cut = Examples(
        person=run.person[kept],
        time_s=run.time_s[kept],
        cues=run.cues[kept],
        bearing_rad=run.bearing_rad[kept],
        true_m=run.true_m[kept],
    )
    pieces = walks(cut, cut.true_m)
    assert [len(true) for true, _ in pieces] == [50, 148, 200]
    assert all(np.array_equal(true, seen) for true, seen in pieces)


def test_what_is_seen_at_the_true_distance_is_where_the_person_is_but_for_the_angle():
    run = film()
    off = np.linalg.norm(run.seen_at(run.distance_m) - run.true_m, axis=1)
    np.testing.assert_allclose(off, 2 * run.distance_m * np.sin(run.angle_error_rad / 2), atol=1e-12)


def test_the_lower_limit_grows_with_the_distance_and_the_others_shrink():
    width, gap, area = correlations([film()])
    assert gap > 0.9
    assert width < 0
    assert area < 0


def test_all_tables_are_printed_with_the_papers_figures(capsys):
    print_trials([film()], Lessons(epochs=5))
    told = capsys.readouterr().out
    for printed in ("[m]", "2.01 ± 1.60", "0.126 ± 0.167", "0.231 ± 0.276", "0.145 ± 0.092"):
        assert printed in told
    assert "nan" not in told
