import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, decode_boxes, encode_boxes
from peopleboy.tracker.sensors.thermal.detector.patches import integrate
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS
from tests.helpers.images.drawn_trees import drawn_cells, drawn_placing, sums_of

PLACES = st.floats(-300.0, 600.0)
SIZES = st.floats(1.0, 500.0)
BOXES = st.tuples(PLACES, PLACES, SIZES, SIZES)


@given(window=BOXES, box=BOXES)
def test_a_window_that_is_moved_by_what_tells_a_box_from_it_is_that_box(
    window: tuple[float, ...], box: tuple[float, ...]
) -> None:
    windows, boxes = np.array([window]), np.array([box])
    np.testing.assert_allclose(decode_boxes(windows, encode_boxes(windows, boxes)), boxes, atol=1e-6)


def test_offsets_are_told_in_heights_of_the_window() -> None:
    window = np.array([[100.0, 50.0, 16.0, 40.0]])
    box = np.array([[103.0, 54.0, 18.0, 80.0]])  # 4 px to the right, 4 px down, twice as high
    np.testing.assert_allclose(encode_boxes(window, box), [[0.1, 0.1, np.log(2.0), 0.45]])


def test_boxes_are_those_that_a_walk_through_the_trees_tells() -> None:
    cells, placing = drawn_cells(), drawn_placing()
    row, column = np.array([0, 3, 14, 14]), np.array([0, 9, 2, 17])
    window = np.array([[10.0 * k, 5.0 * k, 16.0 + k, 40.0 + k] for k in range(4)])
    found = placing.boxes(integrate(cells), row, column, window)
    for k, (left, top, width, height) in enumerate(window.tolist()):
        seen = cells[:, row[k] : row[k] + ROWS, column[k] : column[k] + COLUMNS]
        aside, down, larger, wide = (
            sums_of(seen, placing.patches, placing.feature[n], placing.threshold[n], placing.leaf[n])[-1]
            for n in range(OFFSETS)
        )
        middle = left + width / 2.0 + aside * height
        expected = [
            middle - wide * height / 2.0, top + down * height, wide * height, height * np.exp(larger)
        ]  # fmt: skip
        assert found[k].tolist() == pytest.approx(expected, abs=1e-4)


def test_of_no_windows_there_are_no_boxes() -> None:
    none = np.empty(0, np.int64)
    assert drawn_placing().boxes(integrate(drawn_cells()), none, none, np.empty((0, 4))).shape == (0, 4)
