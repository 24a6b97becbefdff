from functools import partial

import jax
import numpy as np
import pytest

from peopleboy.studies.training.look_learning import closer_look_loss, second_look_loss
from peopleboy.studies.training.look_learning.teach_network import last_of, teach_network
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from peopleboy.tracker.proposals.looks.crops import SCORES, planes_of
from peopleboy.tracker.proposals.looks.network import CropNetwork
from peopleboy.tracker.proposals.looks.second_look import SecondLook
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_looks import drawn_looks, drawn_weights

LINE = {"line": np.array([1.0, 0.0], np.float32)}


@pytest.mark.parametrize("kind", [SecondLook, CloserLook])
def test_what_is_taught_is_what_the_tracker_computes(kind: type[CropNetwork]) -> None:
    looks, weights = drawn_looks(kind.FORM, 4), drawn_weights(kind.FORM)
    planes, numbers = planes_of(looks.crops), looks.numbers[:, : kind.FORM.numbers]
    ours = kind(weights).last(planes, numbers)
    np.testing.assert_allclose(
        np.asarray(jax.jit(partial(last_of, kind.FORM))(weights, planes, numbers)), ours, atol=1e-3
    )


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_people_are_told_from_others_after_a_short_lesson() -> None:
    said: list[str] = []
    rng, form = np.random.default_rng(0), SecondLook.FORM
    weights = teach_network(
        second_look_loss.SECOND_LOOK, drawn_looks(form, 320), rng, rounds=8, say=said.append
    )
    others = drawn_looks(form, 200, seed=5)
    ours = SecondLook(weights | LINE).told(planes_of(others.crops), others.numbers)
    before = SCORES * others.numbers[:, 0]
    is_person = others.overlap > 0.5
    assert np.mean((before > 0.0) == is_person) < 0.7
    assert np.mean((ours[:, 0] > 0.0) == is_person) > 0.95


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_where_people_are_is_told_after_a_short_lesson() -> None:
    form = CloserLook.FORM
    looks, others = drawn_looks(form, 512), drawn_looks(form, 80, seed=5)
    looks, others = (each.take(np.flatnonzero(each.overlap > 0.5)) for each in (looks, others))
    weights = teach_network(
        closer_look_loss.CLOSER_LOOK, looks, np.random.default_rng(0), rounds=20, say=print
    )
    aside = CloserLook(weights).told(planes_of(others.crops), others.numbers)[:, 0]
    assert np.corrcoef(aside, others.offsets[:, 0])[0, 1] > 0.9


@pytest.mark.slow
@pytest.mark.usefixtures("small")
def test_the_same_lesson_gives_the_same_network() -> None:
    looks = drawn_looks(SecondLook.FORM, 128)
    one, same = (
        teach_network(second_look_loss.SECOND_LOOK, looks, np.random.default_rng(4), rounds=1, say=print)
        for _ in range(2)
    )
    for name, weights in one.items():
        np.testing.assert_array_equal(same[name], weights)


def test_too_little_to_learn_from_is_refused() -> None:
    with refused("10 examples", "at least 64"):
        teach_network(
            second_look_loss.SECOND_LOOK,
            drawn_looks(SecondLook.FORM, 10),
            np.random.default_rng(0),
            rounds=1,
            say=print,
        )
