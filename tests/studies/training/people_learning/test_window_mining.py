from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.studies.training.people_learning import window_mining
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.cascade import Cascade
from peopleboy.tracker.proposals.placing import moved
from peopleboy.tracker.proposals.window import Kind
from tests.helpers.images.drawn_films import WIDTH_PER_HEIGHT
from tests.helpers.images.drawn_trees import drawn_cascade

Floats = NDArray[np.float64]


def test_windows_with_people_are_varied_in_a_level_or_two_and_a_cell_off(shots: list[PeopleShot]) -> None:
    windows = window_mining.windows_with_people(shots[:6], np.random.default_rng(0), Kind.WHOLE)
    assert windows.shape == (len(windows), window_mining.CELLS)
    assert 2 * 6 < len(windows) <= 2 * 6 * 2 * 2


def test_windows_let_through_come_with_where_in_them_people_are(shots: list[PeopleShot]) -> None:
    def through(cascade: Cascade) -> tuple[NDArray[np.float16], Floats]:
        return window_mining.windows_let_through(shots[:6], cascade, np.random.default_rng(0), Kind.WHOLE)

    windows, offsets = through(drawn_cascade())
    assert windows.shape == (len(windows), window_mining.CELLS)
    assert 2 * 6 < len(windows) <= 2 * 6 * 6
    _, _, larger, wide = offsets.T
    np.testing.assert_allclose(wide / np.exp(larger), WIDTH_PER_HEIGHT)
    assert np.ptp(larger) > np.log(2.0) / 3.0  # more than a step of the sizes: they fill them well and badly
    window = np.array([[0.0, 0.0, 0.41, 1.0]])
    assert (iou(moved(window, offsets), window) > 0.3).all()
    strict = drawn_cascade(least=1e6)
    assert len(through(strict)[0]) == 0


@pytest.mark.parametrize("kind", Kind)
def test_who_cannot_be_learned_from_fills_no_window(kind: Kind, shots: list[PeopleShot]) -> None:
    nobody = np.zeros(1, np.bool_)
    hidden = replace(shots[0], is_good=nobody, is_clear=nobody)
    none = (0, window_mining.CELLS)
    assert window_mining.windows_with_people([hidden], np.random.default_rng(0), kind).shape == none
    windows, offsets = window_mining.windows_let_through(
        [hidden], drawn_cascade(), np.random.default_rng(0), kind
    )
    assert (windows.shape, offsets.shape) == (none, (0, 4))


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("is_taught", [False, True])
def test_windows_without_people_show_nobody(
    is_taught: bool, kind: Kind, shots: list[PeopleShot], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Floats] = []
    clear = window_mining._is_clear

    def spy(box: Floats, one: PeopleShot) -> NDArray[np.bool_]:
        seen.append(window_mining.iou(box[:, None], one.box[None])[clear(box, one)].ravel())
        return clear(box, one)

    monkeypatch.setattr(window_mining, "_is_clear", spy)
    rng = np.random.default_rng(0)
    if is_taught:
        found = window_mining.mistakes(shots[:8], drawn_cascade(), rng, 50, kind)
    else:
        found = window_mining.windows_anywhere(shots[:12], rng, 10000, kind)
    assert found.shape == (len(found), window_mining.CELLS)
    assert len(found) >= 50
    assert max(one.max(initial=0.0) for one in seen) < 0.3
