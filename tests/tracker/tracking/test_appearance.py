from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.tracking.appearance import (
    FEATURES,
    PARTS,
    _histogram,
    blend_colours,
    colour_similarities,
    colour_similarity,
    describe_colours,
    transfer_boxes,
)
from peopleboy.tracker.tracking.config import STATURE_M
from peopleboy.tracker.tracking.viewpoint import Viewpoint

ROWS, COLUMNS = 240, 320
BOX = np.array([[100.0, 40.0, 50.0, 160.0]])
RED, BLUE, GREEN = (200, 40, 40), (40, 40, 200), (40, 160, 40)


def worn(
    box: NDArray[np.float64],
    torso: tuple[int, int, int],
    legs: tuple[int, int, int],
    floor_m: float | None = 1.2,
) -> NDArray:
    """The colours of somebody in a box of a grey image, of a camera so high above the floor."""
    image = np.full((ROWS, COLUMNS, 3), 90, np.uint8)
    left, top, width, height = box[0]
    middle, rows = round(top + 0.52 * height), slice(max(round(left), 0), round(left + width))
    image[max(round(top), 0) : middle, rows] = torso
    image[middle : round(top + height), rows] = legs
    frame = Frame(images={THERMAL: np.zeros((ROWS, COLUMNS), np.uint8), COLOUR: image}, time_s=0.0)
    view = replace(Viewpoint.of(None, (ROWS, COLUMNS)), floor_m=floor_m)
    return describe_colours(frame, box, view)[0]


def lower(by: float) -> NDArray[np.float64]:
    return BOX + np.array([0.0, by, 0.0, 0.0])


def test_the_same_clothes_are_alike_and_others_are_not() -> None:
    one = worn(BOX, RED, BLUE)
    assert colour_similarity(one, worn(lower(10.0), RED, BLUE)) > 0.95
    assert colour_similarity(one, worn(BOX, RED, GREEN)) == pytest.approx(0.5, abs=0.1)
    assert colour_similarity(one, worn(BOX, GREEN, GREEN)) < 0.1


def test_who_is_seen_without_legs_is_known_by_the_torso() -> None:
    whole, cut = worn(BOX, RED, BLUE), worn(lower(95.0), RED, BLUE)
    assert not cut.reshape(PARTS, -1)[1].any()
    assert colour_similarity(whole, cut) > 0.95
    assert colour_similarity(cut, cut) == pytest.approx(1.0, abs=1e-5)
    assert colour_similarity(worn(BOX, GREEN, BLUE), cut) < 0.1


def test_what_is_seen_of_legs_counts_where_the_floor_is_not_known() -> None:
    _, legs = worn(lower(95.0), RED, BLUE, floor_m=None).reshape(PARTS, -1)
    assert legs.any()


def test_of_whose_torso_is_not_seen_nothing_is_known() -> None:
    nothing = worn(lower(195.0), RED, BLUE)
    assert not nothing.any()
    same, is_known = colour_similarities(np.stack([nothing, worn(BOX, RED, BLUE)]), nothing[None])
    assert not same.any()
    assert not is_known.any()


def test_legs_are_remembered_while_the_torso_is_learned() -> None:
    whole, cut = worn(BOX, RED, BLUE), worn(lower(95.0), GREEN, BLUE)
    torso, legs = blend_colours(whole, cut, 0.3).reshape(PARTS, -1)
    np.testing.assert_array_equal(legs, whole.reshape(PARTS, -1)[1])
    np.testing.assert_allclose(
        torso, 0.7 * whole.reshape(PARTS, -1)[0] + 0.3 * cut.reshape(PARTS, -1)[0], atol=1e-6
    )
    nothing = np.zeros(FEATURES, np.float32)
    np.testing.assert_array_equal(blend_colours(whole, nothing, 0.3), whole)
    np.testing.assert_array_equal(blend_colours(nothing, cut, 0.3), cut)


@given(pixels=arrays(np.uint8, st.tuples(st.integers(3, 9), st.integers(4, 9), st.just(3))))
def test_each_pixel_is_shared_linearly_by_the_nearest_bins(pixels: NDArray[np.uint8]) -> None:
    red, green, blue = pixels.reshape(-1, 3).T.astype(np.float64)
    light = (red + green + blue) / 3.0
    result = np.zeros(FEATURES // PARTS, np.float32)
    is_light = _histogram(pixels, result)
    assert is_light == (light.mean() >= 24.0)
    if not is_light:
        assert not result.any()
        return
    shares = (light / 256.0, (red - green) / 120.0 + 0.5, (blue - (red + green) / 2.0) / 120.0 + 0.5)
    hats = [
        np.maximum(1.0 - np.abs(np.clip(share * bins - 0.5, 0.0, bins - 1)[:, None] - np.arange(bins)), 0.0)
        for share, bins in zip(shares, (4, 8, 8), strict=True)
    ]
    expected = np.einsum("ni,nj,nk->ijk", *hats) / len(light)
    np.testing.assert_allclose(PARTS * result**2, expected.ravel(), atol=1e-5)


@pytest.mark.parametrize("shift", [4, 8, 12])
def test_a_little_more_light_changes_colours_little(shift: int) -> None:
    darker = worn(BOX, RED, BLUE)
    lighter = worn(BOX, *(tuple(grey + shift for grey in colour) for colour in (RED, BLUE)))
    assert colour_similarity(darker, lighter) > 0.9


@given(st.integers(0, 10_000), st.sampled_from([0.1, 0.2, 1.0]))
def test_colours_are_blended_by_the_parts_that_are_seen(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    before, now = (
        (rng.random((PARTS, FEATURES // PARTS)) * rng.integers(0, 2, (PARTS, 1))).astype(np.float32)
        for _ in range(2)
    )
    result = blend_colours(before.ravel(), now.ravel(), share).reshape(PARTS, -1)
    for was, seen, both in zip(before, now, result, strict=True):
        gain = 0.0 if not seen.any() else share if was.any() else 1.0
        np.testing.assert_allclose(both, (1.0 - gain) * was + gain * seen, atol=1e-6)
    common = max(int((before.any(axis=1) & now.any(axis=1)).sum()), 1)
    assert colour_similarity(before.ravel(), now.ravel()) == pytest.approx(
        PARTS * float((before * now).sum()) / common, rel=1e-5
    )


SHAPE = (240, 320)


def calibration(aside_m: float = 0.0, height_m: float = 1.2, focal: float = 300.0) -> PinholeCalibration:
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    pose[:3, 3] = [0.1, aside_m, height_m]
    return PinholeCalibration(np.array([[focal, 0.0, 159.5], [0.0, focal, 119.5], [0.0, 0.0, 1.0]]), pose)


def seen(camera: PinholeCalibration, ahead_m: float, left_m: float) -> np.ndarray:
    """Box of somebody of the usual stature, .46 m wide."""
    ends = np.array([[ahead_m, left_m, STATURE_M], [ahead_m, left_m, 0.0]])
    (column, top), (_, bottom) = camera.project(ends)
    width = 0.46 * (bottom - top) / STATURE_M
    return np.array([column - width / 2.0, top, width, bottom - top])


@given(st.floats(2.0, 12.0), st.floats(-2.0, 2.0), st.floats(-0.2, 0.2), st.floats(0.6, 1.6))
def test_a_box_is_where_the_other_camera_sees_the_same_person(
    ahead_m: float, left_m: float, aside_m: float, height_m: float
) -> None:
    here, there = calibration(), calibration(aside_m, height_m, 250.0)
    found = transfer_boxes(seen(here, ahead_m, left_m)[None], Viewpoint.of(here, SHAPE), here, there)
    np.testing.assert_allclose(found[0], seen(there, ahead_m, left_m), atol=1e-6)


def test_the_camera_itself_sees_the_same() -> None:
    here = calibration()
    box = np.array([[100.0, 40.0, 30.0, 120.0], [10.0, 100.0, 8.0, 40.0]])
    np.testing.assert_allclose(transfer_boxes(box, Viewpoint.of(here, SHAPE), here, here), box, atol=1e-9)


def test_whom_the_other_camera_cannot_see_has_no_box() -> None:
    here, pose = calibration(), calibration().robot_from_camera.copy()
    pose[:3, :3] = pose[:3, :3] @ np.diag([-1.0, 1.0, -1.0])  # looks back
    behind = PinholeCalibration(here.intrinsics, pose)
    found = transfer_boxes(seen(here, 4.0, 0.0)[None], Viewpoint.of(here, SHAPE), here, behind)
    assert not found.any()
