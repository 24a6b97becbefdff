import numpy as np
import pytest

from peopleboy.studies.training.distance import Backpropagation, fit_distances, run_epoch
from peopleboy.tracker.reproductions.panoramic.distance_network import DistanceNetwork
from tests.helpers.calls.refused import refused

QUICK = Backpropagation(epochs=300)


def examples(count=120, seed=0):
    rng = np.random.default_rng(seed)
    distances = rng.uniform(1.2, 5.8, count)
    cues = np.stack([60 / distances, 100 * (1 - 1.2 / distances), 4000 / distances**2], axis=1)
    return cues * rng.normal(1.0, 0.01, cues.shape), distances


def forward(inputs, hidden, output):
    """One output by the textbook, unit by unit."""
    units = [1 / (1 + np.exp(-sum(w * x for w, x in zip(row, inputs, strict=True)))) for row in hidden]
    return 1 / (1 + np.exp(-sum(w * x for w, x in zip(output, [*units, 1.0], strict=True))))


def test_a_step_goes_down_the_gradient_of_half_the_squared_error_taken_by_differences():
    rng = np.random.default_rng(1)
    hidden, output = rng.normal(size=(4, 4)), rng.normal(size=5)
    inputs, target = np.array([0.2, 0.9, 0.4, 1.0]), 0.7

    def loss(weights):
        return 0.5 * (target - forward(inputs, weights[:16].reshape(4, 4), weights[16:])) ** 2

    weights = np.concatenate([hidden.ravel(), output])
    gradient = [(loss(weights + h) - loss(weights - h)) / 2e-5 for h in 1e-5 * np.eye(21)]
    run_epoch(inputs[None], np.array([target]), np.array([0]), hidden, output, 0.3)
    changed = np.concatenate([hidden.ravel(), output]) - weights
    np.testing.assert_allclose(changed, -0.3 * np.array(gradient), rtol=1e-5, atol=1e-10)


def test_it_has_21_weights():
    network = fit_distances(*examples(), np.random.default_rng(0), Backpropagation(epochs=1))
    assert network.hidden.size + network.output.size == 21


def test_its_answer_is_the_textbooks():
    cues, distances = examples()
    network = fit_distances(cues, distances, np.random.default_rng(0), QUICK)
    low, high = cues.min(axis=0), cues.max(axis=0)
    reported = [forward([*(row - low) / (high - low), 1.0], network.hidden, network.output) for row in cues]
    nearest, farthest = distances.min(), distances.max()
    expected = nearest + (np.array(reported) - 0.1) / 0.8 * (farthest - nearest)
    np.testing.assert_allclose(network.predict(cues), expected)


def test_it_learns_distances_of_people_whom_it_was_not_taught():
    network = fit_distances(*examples(), np.random.default_rng(0))
    cues, distances = examples(seed=1)
    assert np.abs(network.predict(cues) - distances).mean() < 0.1


def test_more_epochs_fit_the_examples_better():
    cues, distances = examples()
    errors = [
        np.abs(
            fit_distances(cues, distances, np.random.default_rng(0), Backpropagation(epochs=n)).predict(cues)
            - distances
        ).mean()
        for n in (10, 100, 2000)
    ]
    assert errors == sorted(errors, reverse=True)


def test_the_same_seed_gives_the_same_weights_and_another_gives_others():
    one, same, other = (fit_distances(*examples(), np.random.default_rng(seed), QUICK) for seed in (4, 4, 5))
    assert np.array_equal(one.hidden, same.hidden)
    assert np.array_equal(one.output, same.output)
    assert not np.array_equal(one.hidden, other.hidden)


def test_the_middle_output_stands_for_the_middle_distance():
    still = DistanceNetwork(
        hidden=np.zeros((4, 4)),
        output=np.zeros(5),
        cue_ranges=np.array([[0.0, 1.0]] * 3),
        distance_range_m=(1.0, 5.0),
    )
    assert still.predict(np.array([[3.0, 2.0, 9.0]])) == pytest.approx([3.0])


def test_next_to_no_examples_and_examples_that_are_all_alike_are_refused():
    cues, distances = examples()
    with refused("9 samples", "at least 10"):
        fit_distances(cues[:9], distances[:9], np.random.default_rng(0))
    for alike in ((cues, np.full(120, 2.0)), (np.ones((120, 3)), distances)):
        with refused("all are equal"):
            fit_distances(*alike, np.random.default_rng(0))
