import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.studies.reproductions.experiments.distance_trials import (
    FILTERS,
    KALMAN,
    MODEL_ALONE,
    SplitTrial,
    as_noisy_as_printed,
    correlations,
    general_networks,
    general_trials,
    new_people_trials,
    personal_trials,
    position_trials,
    predicted_in_turn,
    random_split,
)
from peopleboy.studies.reproductions.image_errors import BLOCKS, ErrorSummary, ImageErrors, pooled
from peopleboy.studies.training.distance import Backpropagation, DistanceSamples, block_split, walks

QUICK = Backpropagation(epochs=60)


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
    return DistanceSamples.from_rows(rows)


def walking():
    """The same people, who go at 0.7 m/s at most, as people do."""
    return replace(film(), **_slow(film()))


def _slow(run):
    k = np.arange(len(run.cues))
    distance, bearing = 3.5 + 1.5 * np.sin(k / 10), 0.5 * np.sin(k / 31)
    cues = np.stack([60 / distance, 100 - 120 / distance, 3000 / distance**2], axis=1)
    true = distance[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    return {"cues": cues, "bearing_rad": bearing, "true_m": true}


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
    heaps = [rng.exponential(size=n) for n in (10, 33, 0, 7)]
    every = np.concatenate(heaps)
    together = pooled([ErrorSummary.of(heap) for heap in heaps])
    assert (together.images, together.mean, together.deviation) == pytest.approx(
        (50, every.mean(), every.std())
    )


def test_blocks_and_splits_hold_the_same_errors_and_come_back_from_plain_data():
    rng = np.random.default_rng(0)
    tested = [
        (rows := np.sort(rng.permutation(200)[:140]), rng.exponential(size=len(rows))) for _ in range(3)
    ]
    errors = ImageErrors.of(tested, 200)
    by_block, by_split = pooled(errors.blocks), errors.all
    assert (by_block.images, by_block.mean) == pytest.approx((by_split.images, by_split.mean))
    in_third = np.concatenate([part[(rows >= 20) & (rows < 30)] for rows, part in tested])
    assert errors.block_means[2] == pytest.approx(in_third.mean())
    assert ImageErrors.of_plain(errors.plain()) == errors
    assert errors.only(min).all.mean == min(part.mean() for _, part in tested)
    assert errors.only(max).all.mean == max(part.mean() for _, part in tested)


def test_films_are_put_one_after_the_other_and_people_of_one_film_together():
    one, other = (ImageErrors.of([(np.array(rows), np.array(rows) / 10)], 4) for rows in ([0, 1], [2, 3]))
    assert ImageErrors.joined([one, other]).films == 2
    assert len(ImageErrors.joined([one, other]).blocks) == 2 * BLOCKS
    both = ImageErrors.merged([one, other])
    assert [block.images for block in both.blocks[::5]] == [1] * 4
    assert (both.all.images, both.all.mean) == pytest.approx((4, 0.15))


def test_the_general_model_is_tested_in_every_split_and_always_the_same():
    trial = SplitTrial(split="random", repeats=10, settings=QUICK)
    found, again = (general_trials(film(), general_networks(film(), trial)) for _ in range(2))
    assert found == again
    assert [one.images for one in found.splits] == [280] * 10


def test_ones_own_model_is_better_where_people_differ():
    found = personal_trials(
        film(), SplitTrial(split="random", repeats=3, settings=Backpropagation(epochs=400))
    )
    mean = {pair: errors.all.mean for pair, errors in found.items()}
    assert set(mean) == {(1, 1), (1, 2), (2, 1), (2, 2)}
    assert mean[1, 1] < mean[1, 2]
    assert mean[2, 2] < mean[2, 1]


def test_new_people_are_told_by_a_network_that_saw_others():
    found = new_people_trials([film(seed=1), film(seed=2)], [film(seed=3)], Backpropagation(epochs=400))
    assert [errors.all.images for errors in found] == [400]
    assert found[0].all.mean < 0.2


def test_every_image_is_told_by_a_network_that_did_not_learn_from_it():
    run = film()
    told = predicted_in_turn(run, SplitTrial(split="blocks", settings=Backpropagation(epochs=400)))
    assert told.shape == run.distance_m.shape
    assert np.abs(told - run.distance_m).mean() < 0.3


@pytest.mark.parametrize("split", ["random", "blocks"])
def test_the_filter_gains_a_lot_where_measurements_are_as_noisy_as_the_papers(split):
    trial = SplitTrial(split=split, repeats=3, settings=Backpropagation(epochs=400))
    found = {
        way: errors.all.mean
        for way, errors in position_trials(
            walking(), general_networks(walking(), trial), is_noisy=True
        ).items()
    }
    assert list(found) == list(FILTERS)
    assert found[MODEL_ALONE] == pytest.approx(0.154, abs=0.015)
    for way in (KALMAN, "own Q and R, u = last step"):
        assert found[way] < 0.95 * found[MODEL_ALONE]


def test_noise_makes_up_for_what_the_paper_has_more_and_for_nothing_else():
    run, rng = walking(), np.random.default_rng(1)
    noisy = as_noisy_as_printed(run, run.true_m, rng)
    square = ((noisy - run.true_m) ** 2).sum(axis=1).mean()
    assert square == pytest.approx(0.154**2 + 0.094**2, rel=0.15)
    worse = run.true_m + 1.0
    assert np.array_equal(as_noisy_as_printed(run, worse, rng), worse)


def test_walks_end_where_the_person_changes_or_an_image_is_missing():
    run = film()
    kept = np.delete(np.arange(400), [50, 51])
    rows = np.column_stack([run.person, run.time_s, run.cues, run.bearing_rad, run.true_m])
    cut = DistanceSamples.from_rows(rows[kept])
    pieces = walks(cut, cut.true_m)
    assert [len(true) for true, _ in pieces] == [50, 148, 200]
    assert all(np.array_equal(true, seen) for true, seen in pieces)


def test_what_is_positions_at_the_true_distance_is_where_the_person_is_but_for_the_angle():
    run = film()
    off = np.linalg.norm(run.positions_at(run.distance_m) - run.true_m, axis=1)
    np.testing.assert_allclose(off, 2 * run.distance_m * np.sin(run.angle_error_rad / 2), atol=1e-12)


def test_the_lower_limit_grows_with_the_distance_the_others_shrink_and_the_network_is_best():
    trial = SplitTrial(split="random", repeats=1, settings=Backpropagation(epochs=400))
    width, gap, area, told = correlations(film(), general_networks(film(), trial))
    assert gap > 0.9
    assert width < 0
    assert area < 0
    assert told > gap
