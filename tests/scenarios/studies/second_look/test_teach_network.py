import jax
import numpy as np
import pytest

from peopleboy.scenarios.studies.second_look.looks import LookExamples
from peopleboy.scenarios.studies.second_look.teach_network import first_weights, loss, teach_network, told
from peopleboy.tracker.proposals.crops import COLUMNS, NUMBERS, PLANES, ROWS, SCORES, planes_of
from peopleboy.tracker.proposals.placing import OFFSETS
from peopleboy.tracker.proposals.second_look import SCALES, USUAL, SecondLook
from tests.helpers.calls.refused import refused


def drawn_looks(count: int, seed: int = 0) -> LookExamples:
    """Crops of which those of people have a bright upright bar in the middle, the others a lying one."""
    rng = np.random.default_rng(seed)
    crops = rng.integers(60, 120, (count, ROWS, COLUMNS, PLANES)).astype(np.uint8)
    is_person = rng.random(count) < 0.5
    crops[is_person, 10:54, 20:28, 0] = 220
    crops[~is_person, 28:36, 4:44, 0] = 220
    crops[..., 2] = 255
    numbers = rng.normal(0.0, 0.1, (count, NUMBERS)).astype(np.float32)
    offsets = rng.normal(0.0, 0.02, (count, OFFSETS)) + USUAL[1:]
    return LookExamples(
        crops, numbers, np.where(is_person, 0.8, 0.0).astype(np.float32), offsets.astype(np.float32)
    )


def drawn_weights() -> dict[str, np.ndarray]:
    weights = first_weights(np.random.default_rng(3))
    weights["last"] *= np.float32(5.0)
    return weights


def test_what_is_taught_is_what_the_tracker_computes() -> None:
    looks, weights = drawn_looks(4), drawn_weights()
    planes = planes_of(looks.crops)
    ours = SecondLook(weights).told(planes, looks.numbers)
    np.testing.assert_allclose(
        np.asarray(told(weights, planes, looks.numbers)) * SCALES + USUAL, ours, atol=1e-4
    )


def test_the_loss_is_that_of_log_odds_and_huber_s_of_places() -> None:
    looks, weights = drawn_looks(6), drawn_weights()
    planes = planes_of(looks.crops)
    ours = SecondLook(weights).told(planes, looks.numbers)
    is_person = looks.overlap > 0.5
    off = np.abs((ours[:, 1:] - looks.offsets) / SCALES[1:]) * is_person[:, None]
    bent = np.where(off < 2.0, off**2 / 2.0, 2.0 * off - 2.0)
    expected = np.log1p(np.exp(np.where(is_person, -ours[:, 0], ours[:, 0]))).mean() + 0.5 * bent.mean()
    assert float(loss(weights, planes, looks, 1.0)[0]) == pytest.approx(expected, rel=1e-3)


def test_who_is_neither_somebody_nor_nobody_does_not_count() -> None:
    looks, weights = drawn_looks(4), drawn_weights()
    between = looks._replace(overlap=np.full(4, 0.3, np.float32))
    slopes = jax.grad(lambda w: loss(w, planes_of(looks.crops), between, 1.0)[0])(weights)
    assert all(not np.asarray(slope).any() for slope in slopes.values())


def test_people_are_told_from_others_after_a_short_lesson() -> None:
    said: list[str] = []
    network = teach_network(drawn_looks(640), np.random.default_rng(0), rounds=8, say=said.append)
    others = drawn_looks(200, seed=5)
    ours = network.told(planes_of(others.crops), others.numbers)
    before = SCORES * others.numbers[:, 0]
    is_person = others.overlap > 0.5
    assert np.mean((before > 0.0) == is_person) < 0.7
    assert np.mean((ours[:, 0] > 0.0) == is_person) > 0.95


def test_the_same_lesson_gives_the_same_network() -> None:
    one, same = (
        teach_network(drawn_looks(128), np.random.default_rng(4), rounds=1, say=print) for _ in range(2)
    )
    for name, weights in one.weights.items():
        np.testing.assert_array_equal(same.weights[name], weights)


def test_too_little_to_learn_from_is_refused() -> None:
    with refused("10 proposals", "at least 64"):
        teach_network(drawn_looks(10), np.random.default_rng(0), rounds=1, say=print)
