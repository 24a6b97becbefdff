from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.studies.people_learning import window_mining
from peopleboy.scenarios.studies.people_learning.shots import PeopleShot
from peopleboy.tracker.proposals.window import Kind
from tests.helpers.images.drawn_films import WIDTH_PER_HEIGHT
from tests.helpers.images.drawn_trees import drawn_cascade

Floats = NDArray[np.float64]


def test_windows_with_people_come_with_where_in_them_they_are(shots: list[PeopleShot]) -> None:
    windows, offsets = window_mining.windows_with_people(shots[:6], np.random.default_rng(0), Kind.WHOLE)
    assert windows.shape == (len(windows), window_mining.CELLS)
    assert offsets.shape == (len(windows), 4)
    assert 2 * 6 < len(windows) <= 2 * 6 * 2 * 2  # varied twice, in a level or two, and a cell off
    aside, down, larger, wide = offsets.T
    assert (np.abs(np.stack([aside, down])) <= 1.5 * 2.0 / 32.0 + 1e-9).all()  # a cell and a half
    assert (np.abs(larger) < 0.55 * np.log(2.0) / 3.0).all()  # about half a step of the sizes
    np.testing.assert_allclose(wide / np.exp(larger), WIDTH_PER_HEIGHT)


@pytest.mark.parametrize("kind", Kind)
def test_who_cannot_be_learned_from_fills_no_window(kind: Kind, shots: list[PeopleShot]) -> None:
    nobody = np.zeros(1, np.bool_)
    hidden = replace(shots[0], is_good=nobody, is_clear=nobody)
    windows, offsets = window_mining.windows_with_people([hidden], np.random.default_rng(0), kind)
    assert (windows.shape, offsets.shape) == ((0, window_mining.CELLS), (0, 4))


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
