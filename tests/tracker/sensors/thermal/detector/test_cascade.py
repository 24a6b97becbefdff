import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.cascade import STRIDE, Cascade, Hits
from peopleboy.tracker.sensors.thermal.detector.patches import integrate
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS
from tests.helpers.images import drawn_trees
from tests.helpers.images.drawn_trees import drawn_cascade, drawn_cells, sums_of


def all_places() -> list[tuple[int, int]]:
    rows, columns = drawn_trees.ROWS - ROWS + 1, drawn_trees.COLUMNS - COLUMNS + 1
    return [(row, column) for row in range(rows) for column in range(columns)]


def sums_of_window(cells: NDArray[np.float32], row: int, column: int) -> NDArray[np.int32]:
    window = np.ascontiguousarray(cells[:, row : row + ROWS, column : column + COLUMNS])
    return integrate(window).ravel()


def score_of(window: NDArray[np.float32], cascade: Cascade) -> list[float]:
    return sums_of(window, cascade.patches, cascade.feature, cascade.threshold, cascade.leaf)


def test_all_windows_have_the_score_that_their_trees_add_up_to() -> None:
    cells, cascade = drawn_cells(), drawn_cascade()
    hits = cascade.scan(integrate(cells), (0, 34), stride=1)
    assert len(hits.score) == (drawn_trees.ROWS - ROWS + 1) * (drawn_trees.COLUMNS - COLUMNS + 1)
    for row, column, score in zip(*hits, strict=True):
        window = cells[:, row : row + ROWS, column : column + COLUMNS]
        assert score == pytest.approx(score_of(window, cascade)[-1], abs=1e-4)


@pytest.mark.parametrize("promising", [0, 256])  # with packed windows alone, and with neighbours
def test_windows_at_once_have_the_scores_of_windows_alone_to_the_last_bit(promising: int) -> None:
    cells, cascade = drawn_cells(), drawn_cascade()
    alone = np.stack([sums_of_window(cells, row, column) for row, column in all_places()], axis=1)
    hits = cascade.scan(integrate(cells), (0, 34), stride=1, promising=promising)
    np.testing.assert_array_equal(hits.score, cascade.running(alone)[:, -1])


def test_sums_may_have_the_size_of_a_window() -> None:
    cells, cascade = np.ascontiguousarray(drawn_cells()[:, :ROWS, :COLUMNS]), drawn_cascade()
    hits = cascade.scan(integrate(cells), (0, 1))
    np.testing.assert_array_equal(hits.score, cascade.running(integrate(cells).reshape(-1, 1))[:, -1])


def test_a_window_that_is_not_let_go_has_the_score_that_it_has_without_letting_go() -> None:
    cells = drawn_cells()
    all_of_them = drawn_cascade().scan(integrate(cells), (0, 34), stride=1)
    some = drawn_cascade(least=-1.0).scan(integrate(cells), (0, 34), stride=1)
    scores = dict(zip(zip(all_of_them.row, all_of_them.column, strict=True), all_of_them.score, strict=True))
    assert 0 < len(some.score) < len(all_of_them.score)
    for row, column, score in zip(*some, strict=True):
        running = score_of(cells[:, row : row + ROWS, column : column + COLUMNS], drawn_cascade())
        assert score == scores[row, column]
        assert min(running) > -1.0 - 1e-4


def test_a_stride_misses_some_windows_and_makes_up_none() -> None:
    sums, cascade = integrate(drawn_cells()), drawn_cascade(least=-1.0)
    every, coarse = (set(zip(*cascade.scan(sums, (0, 34), stride=stride), strict=True)) for stride in (1, 2))
    assert coarse <= every


def test_beside_a_window_that_comes_through_all_are_looked_at() -> None:
    sums, cascade = integrate(drawn_cells()), drawn_cascade()
    assert set(zip(*cascade.scan(sums, (0, 34)), strict=True)) == set(
        zip(*cascade.scan(sums, (0, 34), stride=1), strict=True)
    )


@given(st.integers(0, drawn_trees.TREES))
def test_windows_beside_promising_ones_are_looked_at_and_no_others(promising: int) -> None:
    cells, cascade = drawn_cells(), drawn_cascade(least=-1.0)
    sums = integrate(cells)
    every, found = cascade.scan(sums, (0, 34), stride=1), cascade.scan(sums, (0, 34), promising=promising)
    places = list(zip(every.row.tolist(), every.column.tolist(), strict=True))
    running = cascade.running(
        np.stack([sums_of_window(cells, row, column) for row, column in all_places()], axis=1)
    )
    comes_through = {
        place
        for place, scores in zip(all_places(), running, strict=True)
        if (scores[:promising] >= -1.0).all() and place[0] % STRIDE == place[1] % STRIDE == 0
    }
    beside = {(a + i, b + j) for a, b in comes_through for i in (-1, 0, 1) for j in (-1, 0, 1)}
    own = {place for place in places if place[0] % STRIDE == place[1] % STRIDE == 0}
    assert set(zip(found.row.tolist(), found.column.tolist(), strict=True)) == own | (beside & set(places))


def test_sums_of_many_sizes_are_looked_through_as_those_of_one() -> None:
    cascade, cells = drawn_cascade(), drawn_cells()
    for columns in [*range(COLUMNS, cells.shape[2]), *range(COLUMNS, cells.shape[2])] * 3:
        sums = integrate(np.ascontiguousarray(cells[:, :, :columns]))
        for one, other in zip(cascade.scan(sums, (0, 34)), drawn_cascade().scan(sums, (0, 34)), strict=True):
            np.testing.assert_array_equal(one, other)


def test_windows_that_are_known_are_passed_by_and_nothing_else_changes() -> None:
    sums, cascade = integrate(drawn_cells()), drawn_cascade(least=-1.0)
    is_known = np.zeros((drawn_trees.ROWS - ROWS + 1, drawn_trees.COLUMNS - COLUMNS + 1), np.bool_)
    is_known[:, 13:16] = True
    every, some = (
        set(zip(*cascade.scan(sums, (0, 34), known, stride=1), strict=True)) for known in (None, is_known)
    )
    assert some == {hit for hit in every if hit[1] not in (13, 14, 15)}
    assert 0 < len(some) < len(every)


def test_beside_one_that_is_much_surer_windows_do_not_count() -> None:
    hits = Hits(
        np.array([10, 11, 10, 20, 15]), np.array([5, 5, 8, 5, 7]), np.array([4.0, 0.5, 0.5, 0.5, 1.5])
    )
    best = hits.best()
    assert best.score.tolist() == [4.0, 0.5, 0.5, 1.5]
    assert best.row.tolist() == [10, 10, 20, 15]


def test_only_the_rows_that_are_asked_for_are_looked_at() -> None:
    assert set(drawn_cascade().scan(integrate(drawn_cells()), (3, 6)).row.tolist()) == {3, 4, 5}


@pytest.mark.parametrize("rows", [(5, 5), (20, 34), (-9, 0)])
def test_where_no_window_fits_none_is_found(rows: tuple[int, int]) -> None:
    assert len(drawn_cascade().scan(integrate(drawn_cells()), rows).score) == 0


def test_running_scores_are_those_of_the_trees() -> None:
    cells = drawn_cells()[:, :ROWS, : 2 * COLUMNS].reshape(-1, ROWS, 2, COLUMNS).transpose(2, 0, 1, 3)
    expected = [score_of(window, drawn_cascade()) for window in cells]
    exact = np.stack([integrate(window).ravel() for window in cells], axis=1)
    np.testing.assert_allclose(drawn_cascade().running(exact), expected, atol=1e-4)


def test_calibrated_trees_let_the_same_windows_through_with_scores_on_a_line() -> None:
    cascade = drawn_cascade(least=-2.0)
    before = cascade.scan(integrate(drawn_cells()), (0, 34))
    after = cascade.calibrated(0.4, -1.5).scan(integrate(drawn_cells()), (0, 34))
    assert len(before.score) >= 4
    np.testing.assert_array_equal(after.row, before.row)
    np.testing.assert_array_equal(after.column, before.column)
    np.testing.assert_allclose(after.score, 0.4 * before.score - 1.5, atol=1e-4)
