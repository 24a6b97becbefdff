import jax
import numpy as np
import pytest

from peopleboy.studies.training.look_learning.closer_look_loss import closer_look_loss
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.looks.closer_look import SCALES, CloserLook
from peopleboy.tracker.proposals.looks.crops import planes_of
from peopleboy.tracker.proposals.placing import moved
from tests.helpers.images.drawn_looks import drawn_looks, drawn_weights

FORM = CloserLook.FORM
loss = jax.jit(closer_look_loss)
WINDOW = np.array([[40.0, 50.0, 20.0, 80.0]])


def test_the_loss_is_that_of_what_boxes_do_not_share_and_huber_s_of_places() -> None:
    looks, weights = drawn_looks(FORM, 6), drawn_weights(FORM)
    planes = planes_of(looks.crops)
    ours = CloserLook(weights).told(planes, looks.numbers)
    window = np.repeat(WINDOW, 6, axis=0)
    shared = iou(moved(window, ours), moved(window, looks.offsets.astype(np.float64)))
    off = np.abs(ours - looks.offsets) / SCALES
    bent = np.where(off < 1.0, off**2 / 2.0, off - 0.5)
    assert bent.max() < 8.0
    told = loss(weights, planes, looks, 1.0)
    assert float(told.all) == pytest.approx(4.0 * (1.0 - shared).mean() + 0.3 * bent.mean(), rel=1e-3)
    assert float(told.shown["units off"]) == pytest.approx(off.mean(), rel=1e-3)


def test_somebody_else_s_box_teaches_no_units() -> None:
    looks, weights = drawn_looks(FORM, 3), drawn_weights(FORM)
    planes = planes_of(looks.crops)
    far = looks._replace(offsets=looks.offsets + np.float32(3.0))
    assert float(loss(weights, planes, far, 1.0).all) == pytest.approx(4.0 + 0.3 * 8.0, rel=1e-5)


def test_the_score_of_what_was_found_says_nothing_of_where() -> None:
    looks, weights = drawn_looks(FORM, 3), drawn_weights(FORM)
    planes, other = planes_of(looks.crops), looks.numbers.copy()
    other[:, 0] += 1.0
    one, same = (loss(weights, planes, looks._replace(numbers=n), 1.0) for n in (looks.numbers, other))
    assert float(one.all) == float(same.all)
