import jax
import numpy as np
import pytest

from peopleboy.studies.training.look_learning.second_look_loss import second_look_loss
from peopleboy.tracker.proposals.looks.crops import planes_of
from peopleboy.tracker.proposals.looks.second_look import SCALES, SecondLook
from tests.helpers.images.drawn_looks import drawn_looks, drawn_weights


def test_the_loss_is_that_of_log_odds_and_huber_s_of_places() -> None:
    looks, weights = drawn_looks(SecondLook.FORM, 6), drawn_weights(SecondLook.FORM)
    planes = planes_of(looks.crops)
    ours = SecondLook(weights | {"line": np.array([1.0, 0.0], np.float32)}).told(planes, looks.numbers)
    is_person = looks.overlap > 0.5
    off = np.abs((ours[:, 1:] - looks.offsets) / SCALES[1:]) * is_person[:, None]
    bent = np.where(off < 2.0, off**2 / 2.0, 2.0 * off - 2.0)
    expected = np.log1p(np.exp(np.where(is_person, -ours[:, 0], ours[:, 0]))).mean() + 0.5 * bent.mean()
    assert float(jax.jit(second_look_loss)(weights, planes, looks, 1.0).all) == pytest.approx(
        expected, rel=1e-3
    )


@pytest.mark.usefixtures("small")
def test_who_is_neither_somebody_nor_nobody_does_not_count() -> None:
    looks, weights = drawn_looks(SecondLook.FORM, 4), drawn_weights(SecondLook.FORM)
    planes, between = planes_of(looks.crops), looks._replace(overlap=np.full(4, 0.3, np.float32))
    slopes = jax.jit(jax.grad(lambda w: second_look_loss(w, planes, between, 1.0).all))(weights)
    assert all(not np.asarray(slope).any() for slope in slopes.values())
