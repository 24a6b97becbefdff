import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.studies.second_look.looks import LookExamples
from peopleboy.scenarios.studies.second_look.teach_network import first_weights, slopes_of, teach_network
from peopleboy.tracker.proposals.crops import COLUMNS, NUMBERS, PLANES, ROWS, SCORES, planes_of
from peopleboy.tracker.proposals.placing import OFFSETS
from peopleboy.tracker.proposals.second_look import SCALES, UNITS, USUAL, SecondLook
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


def loss(network: SecondLook, looks: LookExamples) -> float:
    """The mean loss, in other words than in the code: of the log odds, and of Huber's for places."""
    told = network.told(planes_of(looks.crops), looks.numbers)
    is_person = looks.overlap > 0.5
    off = np.abs((told[:, 1:] - looks.offsets) / SCALES[1:]) * is_person[:, None]
    bent = np.where(off < 2.0, off**2 / 2.0, 2.0 * off - 2.0)
    odds = np.where(is_person, -told[:, 0], told[:, 0])
    return float((np.log1p(np.exp(odds)) + 0.5 / OFFSETS * bent.sum(axis=1)).mean())


def kept() -> NDArray[np.float32]:
    return np.ones((4, UNITS), np.float32)


@pytest.mark.parametrize("name", ["kernel0", "bias1", "kernel2", "kernel4", "all", "last", "last_bias"])
def test_slopes_are_those_of_the_loss(name: str) -> None:
    looks, weights = drawn_looks(4), first_weights(np.random.default_rng(3))
    weights["last"] *= np.float32(5.0)
    slopes, _ = slopes_of(weights, looks, planes_of(looks.crops), kept())
    steepest = np.unravel_index(np.abs(slopes[name]).argmax(), slopes[name].shape)
    step = 2e-3
    sides = []
    for sign in (1.0, -1.0):
        moved = weights[name].copy()
        moved[steepest] += sign * step
        sides.append(loss(SecondLook({**weights, name: moved}), looks))
    assert (sides[0] - sides[1]) / (2.0 * step) == pytest.approx(slopes[name][steepest], rel=0.05)


def test_who_is_neither_somebody_nor_nobody_does_not_count() -> None:
    looks, weights = drawn_looks(4), first_weights(np.random.default_rng(3))
    between = looks._replace(overlap=np.full(4, 0.3, np.float32))
    slopes, _ = slopes_of(weights, between, planes_of(looks.crops), kept())
    assert all(not slope.any() for slope in slopes.values())


def test_people_are_told_from_others_after_a_short_lesson() -> None:
    said: list[str] = []
    network = teach_network(drawn_looks(640), np.random.default_rng(0), rounds=8, say=said.append)
    others = drawn_looks(200, seed=5)
    told = network.told(planes_of(others.crops), others.numbers)
    before = SCORES * others.numbers[:, 0]
    is_person = others.overlap > 0.5
    assert np.mean((before > 0.0) == is_person) < 0.7
    assert np.mean((told[:, 0] > 0.0) == is_person) > 0.95


def test_too_little_to_learn_from_is_refused() -> None:
    with refused("10 proposals", "at least 64"):
        teach_network(drawn_looks(10), np.random.default_rng(0), rounds=1, say=print)
