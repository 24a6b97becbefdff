import jax
import numpy as np
import pytest

from peopleboy.studies.training.foreground import first_weights, mask_loss
from peopleboy.studies.training.optimiser import Optimiser
from peopleboy.tracker.networks.mask_network import INPUTS, OUTPUTS, MaskNetwork

ROWS, COLUMNS = 9, 20
KEY = jax.random.key(0)


@pytest.fixture(scope="module")
def samples():
    rng = np.random.default_rng(1)
    squares = rng.normal(0, 0.5, (2, ROWS, COLUMNS, INPUTS)).astype(np.float32)
    return squares, (squares[..., :OUTPUTS] > 0.4).astype(np.float32)


def test_it_learns_what_can_be_learned_and_the_same_each_time(samples):
    def trained():
        optimiser = Optimiser(mask_loss, first_weights(ROWS, np.random.default_rng(0)))
        return [optimiser.step(samples, 0.01)["entropy"] for _ in range(60)], optimiser.weights

    losses, weights = trained()
    assert losses[-1] < 0.5 * losses[0]
    assert np.array_equal(weights["first"], trained()[1]["first"])


def test_training_sees_what_the_tracker_sees(samples):
    """The loss is that of the probabilities which the network predicts when it is used."""
    weights = first_weights(ROWS, np.random.default_rng(0))
    squares, people = samples[0][:1], samples[1][:1]
    told = MaskNetwork(**weights).predict(np.ascontiguousarray(squares[0].transpose(2, 0, 1)))
    truth = people[0].reshape(ROWS, COLUMNS, 4, 4).transpose(0, 2, 1, 3).reshape(ROWS * 4, COLUMNS * 4)
    entropy = -np.mean(truth * np.log(told) + (1 - truth) * np.log(1 - told))
    assert float(mask_loss(weights, (squares, people), KEY)[0]) == pytest.approx(entropy, rel=1e-4)
