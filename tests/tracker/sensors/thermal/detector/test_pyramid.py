import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.tracker.boxes import shared_of_smaller
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS, OVER
from peopleboy.tracker.sensors.thermal.detector.pyramid import STEP, pyramid_levels
from peopleboy.tracker.sensors.thermal.detector.window import (
    COLUMNS,
    PERSON_PX,
    ROWS,
    WindowKind,
    boxes_of,
    cells_of,
)

GREY: NDArray[np.uint8] = np.kron(
    np.random.default_rng(0).integers(0, 256, (60, 80)), np.ones((4, 4))
).astype(np.uint8)
STILL = np.zeros_like(GREY)
MOUNT = Mount(horizon_px=119.5, focal_px=300.0, height_m=1.2)


def test_a_window_and_the_box_of_its_person_belong_together() -> None:
    cells = np.array([[3.0, 5.0], [0.0, -2.0], [17.5, 40.25]])
    box = boxes_of(cells[:, 0], cells[:, 1], (1.3, 1.31))
    np.testing.assert_allclose(cells_of(box, (1.3, 1.31)), cells)
    np.testing.assert_allclose(box[:, 3], PERSON_PX / 1.3)


def test_levels_go_from_the_smallest_people_to_those_as_high_as_the_image() -> None:
    heights = [PERSON_PX / level.scale[0] for level in pyramid_levels(GREY, STILL, None, 24.0)]
    assert heights[0] == pytest.approx(24.0, rel=0.01)
    assert heights[-1] > 0.6 * 240
    np.testing.assert_allclose(np.diff(np.log(heights)), np.log(STEP), atol=0.05)


def test_a_window_has_all_features_of_the_trees() -> None:
    level = next(pyramid_levels(GREY, STILL, None, 24.0))
    assert level.cells[:, :ROWS, :COLUMNS].shape == (CHANNELS, ROWS, COLUMNS)


def test_a_known_mount_leaves_out_rows_and_changes_nothing_in_the_others() -> None:
    for whole, part in zip(
        pyramid_levels(GREY, STILL, None, 24.0), pyramid_levels(GREY, STILL, MOUNT, 24.0), strict=True
    ):
        assert part.scale == whole.scale
        if not part.rows[WindowKind.WHOLE]:
            continue
        (first, end), (top, bottom) = part.rows[WindowKind.WHOLE][0], whole.rows[WindowKind.WHOLE][0]
        shift = part.first
        assert end - first <= bottom - top
        np.testing.assert_allclose(
            part.cells[:, first : end + ROWS - 1], whole.cells[:, first + shift : end + ROWS - 1 + shift],
            atol=1e-3,
        )  # fmt: skip
        row, column = np.array([first]), np.array([4])
        np.testing.assert_allclose(part.boxes(row, column), whole.boxes(row + shift, column))


@pytest.mark.parametrize("stature_m", [1.4, 1.7, 2.0])
@pytest.mark.parametrize("mount", [MOUNT, Mount(60.0, 300.0, 1.2), Mount(119.5, 300.0, 1.6)])
def test_whoever_stands_is_looked_for_with_a_known_mount(stature_m: float, mount: Mount) -> None:
    for level in pyramid_levels(GREY, STILL, mount, 24.0):
        height = PERSON_PX / level.scale[0]
        foot = mount.horizon_px + height * mount.height_m / stature_m
        if foot < 240.0 and foot - height > 0.0:
            row = level.windows(np.array([[100.0, foot - height, 10.0, height]]))[0, 0]
            assert any(first <= row <= end - 1 for ranges in level.rows.values() for first, end in ranges)


def test_people_who_cannot_stand_in_view_cost_nothing() -> None:
    assert not list(
        pyramid_levels(GREY, STILL, Mount(horizon_px=-2000.0, focal_px=300.0, height_m=1.2), 24.0)
    )


def test_an_image_too_small_for_a_window_has_no_level() -> None:
    assert not list(pyramid_levels(GREY[:16, :20], STILL[:16, :20], None, 24.0))


def test_every_window_that_is_looked_for_has_a_kind_and_its_cells() -> None:
    for level in pyramid_levels(GREY, STILL, None, 24.0):
        whole, cut = level.rows[WindowKind.WHOLE], level.rows[WindowKind.CUT]
        high = level.cells.shape[1] - 2 * OVER
        looked_at = {row for first, end in whole + cut for row in range(first, end)}
        if PERSON_PX / level.scale[0] < 48.0:
            assert not cut
        else:
            assert looked_at == set(range(high + 2 * OVER - ROWS + 1))
        assert bool(whole) == (high >= 12)


def test_who_is_cut_off_is_looked_for_beyond_the_image() -> None:
    for level in pyramid_levels(GREY, STILL, None, 24.0):
        high = level.cells.shape[1] - 2 * OVER
        for first, end in level.rows[WindowKind.CUT] if level.rows[WindowKind.WHOLE] else ():
            beyond = [(OVER - row, row + ROWS - OVER - high) for row in range(first, end)]
            assert all(above >= 6 or below >= 9 for above, below in beyond)
            assert all(above <= OVER and below <= OVER for above, below in beyond)


def test_windows_are_covered_by_people_with_whom_theirs_share_much() -> None:
    people = np.array([[40.0, 60.0, 30.0, 80.0], [200.0, 20.0, 40.0, 180.0], [-20.0, 150.0, 30.0, 120.0]])
    for level in pyramid_levels(GREY, STILL, MOUNT, 24.0):
        is_covered = level.covered(people, 0.65)
        row, column = np.indices(is_covered.shape).reshape(2, -1)
        theirs = np.repeat(level.boxes(row, column)[:, None], len(people), axis=1)
        middle = theirs[..., 0] + theirs[..., 2] / 2.0
        theirs[..., 2] = people[:, 2] / people[:, 3] * theirs[..., 3]  # as broad as those
        theirs[..., 0] = middle - theirs[..., 2] / 2.0
        shared = shared_of_smaller(theirs, people[None]).max(axis=1)
        is_clear = np.abs(shared - 0.65) > 1e-9
        assert is_covered.shape == (level.cells.shape[1] - ROWS + 1, level.cells.shape[2] - COLUMNS + 1)
        np.testing.assert_array_equal(is_covered.ravel()[is_clear], (shared > 0.65)[is_clear])
