from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.studies.training.detector import mining
from peopleboy.studies.training.detector.mining import CELLS, patch_pool
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.sensors.thermal.detector.box_regression import decode_boxes
from peopleboy.tracker.sensors.thermal.detector.cascade import Cascade
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS, WindowKind
from tests.helpers.images.drawn_films import WIDTH_PER_HEIGHT
from tests.helpers.images.drawn_trees import drawn_cascade

Floats = NDArray[np.float64]


def test_windows_with_people_are_varied_in_a_level_or_two_and_a_cell_off(shots: list[ThermalImage]) -> None:
    windows = mining.windows_with_people(shots[:6], np.random.default_rng(0), WindowKind.WHOLE)
    assert windows.shape == (len(windows), mining.CELLS)
    assert 2 * 6 < len(windows) <= 2 * 6 * 2 * 2


def test_detected_windows_come_with_where_in_them_people_are(shots: list[ThermalImage]) -> None:
    def through(cascade: Cascade) -> tuple[NDArray[np.float16], Floats]:
        return mining.detected_windows(shots[:6], cascade, np.random.default_rng(0), WindowKind.WHOLE)

    windows, offsets = through(drawn_cascade())
    assert windows.shape == (len(windows), mining.CELLS)
    assert 2 * 6 < len(windows) <= 2 * 6 * 6
    _, _, larger, wide = offsets.T
    np.testing.assert_allclose(wide / np.exp(larger), WIDTH_PER_HEIGHT)
    assert np.ptp(larger) > np.log(2.0) / 3.0  # more than a step of the sizes: they fill them well and badly
    window = np.array([[0.0, 0.0, 0.41, 1.0]])
    assert (iou(decode_boxes(window, offsets), window) > 0.3).all()
    strict = drawn_cascade(least=1e6)
    assert len(through(strict)[0]) == 0


@pytest.mark.parametrize("kind", WindowKind)
def test_who_cannot_be_learned_from_fills_no_window(kind: WindowKind, shots: list[ThermalImage]) -> None:
    nobody = np.zeros(1, np.bool_)
    hidden = replace(shots[0], is_good=nobody, is_clear=nobody)
    none = (0, mining.CELLS)
    assert mining.windows_with_people([hidden], np.random.default_rng(0), kind).shape == none
    windows, offsets = mining.detected_windows([hidden], drawn_cascade(), np.random.default_rng(0), kind)
    assert (windows.shape, offsets.shape) == (none, (0, 4))


@pytest.mark.parametrize("kind", WindowKind)
@pytest.mark.parametrize("is_taught", [False, True])
def test_windows_without_people_show_nobody(
    is_taught: bool, kind: WindowKind, shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Floats] = []
    clear = mining._is_clear

    def spy(box: Floats, one: ThermalImage) -> NDArray[np.bool_]:
        seen.append(mining.iou(box[:, None], one.box[None])[clear(box, one)].ravel())
        return clear(box, one)

    monkeypatch.setattr(mining, "_is_clear", spy)
    rng = np.random.default_rng(0)
    if is_taught:
        found = mining.false_positives(shots[:8], drawn_cascade(), rng, 50, kind)
    else:
        found = mining.windows_anywhere(shots[:12], rng, 10000, kind)
    assert found.shape == (len(found), mining.CELLS)
    assert len(found) >= 50
    assert max(one.max(initial=0.0) for one in seen) < 0.3


def test_every_cell_may_be_asked_for_by_itself() -> None:
    pool = patch_pool(0)
    places = {(int(channel), *box) for channel, box in zip(pool.channel, pool.first.tolist(), strict=True)}
    assert len(pool) == len(places) == CELLS
    assert not pool.second.any()
    assert all(bottom - top == right - left == 1 for _, top, left, bottom, right in places)


def test_what_is_drawn_lies_in_the_window_and_is_always_the_same() -> None:
    pool, again = patch_pool(2000), patch_pool(2000)
    for boxes in (pool.first, pool.second):
        assert (boxes[:, :2] <= boxes[:, 2:]).all()
        assert (boxes[:, 2:] <= (ROWS, COLUMNS)).all()
    assert set(pool.channel.tolist()) == set(range(CHANNELS))
    np.testing.assert_array_equal(again.first, pool.first)
    np.testing.assert_array_equal(again.second, pool.second)


def test_pairs_beside_each_other_mirrored_and_anywhere_are_all_drawn() -> None:
    pool = patch_pool(2000)
    first, second = (boxes[CELLS:].astype(int) for boxes in (pool.first, pool.second))
    is_alone = ~second.any(axis=1)
    is_as_large = ((first[:, 2:] - first[:, :2]) == (second[:, 2:] - second[:, :2])).all(axis=1)
    mirrored = np.stack([first[:, 0], COLUMNS - first[:, 3], first[:, 2], COLUMNS - first[:, 1]], axis=1)
    is_mirrored = (second == mirrored).all(axis=1)
    assert 0.2 < is_alone.mean() < 0.4
    assert 0.1 < is_mirrored.mean() < 0.3
    assert 0.2 < (is_as_large & ~is_mirrored).mean() < 0.5
    assert (~is_alone & ~is_as_large).mean() > 0.1
