from dataclasses import replace

import numpy as np
import pytest

from peopleboy.studies.training.foreground_learning.teach_network import Adam, first_network, loss_and_slopes
from peopleboy.tracker.panoramic.foreground.mask_network import INPUTS, OUTPUTS

ROWS, COLUMNS = 9, 20


@pytest.fixture(scope="module")
def examples():
    rng = np.random.default_rng(1)
    squares = rng.normal(0, 0.5, (2, ROWS, COLUMNS, INPUTS)).astype(np.float32)
    return squares, (squares[..., :OUTPUTS] > 0.4).astype(np.float32)


@pytest.mark.parametrize("name", ["first", "rows", "between", "biases", "last", "bias"])
def test_the_gradient_is_the_slope_of_the_loss(examples, name):
    network, step = first_network(ROWS, np.random.default_rng(0)), 1e-3
    slopes = loss_and_slopes(network, *examples)[1][name]
    way = slopes / np.linalg.norm(slopes)

    def loss(by):
        changed = getattr(network, name) + np.float32(by) * way
        return loss_and_slopes(replace(network, **{name: changed}), *examples)[0]

    assert (loss(step) - loss(-step)) / (2 * step) == pytest.approx(np.linalg.norm(slopes), rel=0.02)


def test_it_learns_what_can_be_learned_and_the_same_each_time(examples):
    def taught():
        pupil = Adam(network=first_network(ROWS, np.random.default_rng(0)))
        return [pupil.step(*examples, 0.01) for _ in range(60)], pupil.network

    losses, network = taught()
    assert losses[-1] < 0.5 * losses[0]
    assert np.array_equal(network.first, taught()[1].first)


def test_teaching_sees_what_the_tracker_sees(examples):
    """The loss is that of the probabilities which the network tells when it is used."""
    network = first_network(ROWS, np.random.default_rng(0))
    squares, people = examples[0][:1], examples[1][:1]
    told = network.probability(np.ascontiguousarray(squares[0].transpose(2, 0, 1)))
    truth = people[0].reshape(ROWS, COLUMNS, 4, 4).transpose(0, 2, 1, 3).reshape(ROWS * 4, COLUMNS * 4)
    entropy = -np.mean(truth * np.log(told) + (1 - truth) * np.log(1 - told))
    assert loss_and_slopes(network, squares, people)[0] == pytest.approx(entropy, rel=1e-4)
