import numpy as np
import pytest

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.crops import (
    CHANNELS,
    FEATURES,
    CropSize,
    crop_features,
    cut_crops,
    normalise_crops,
)

SIZE = CropSize(64, 48, 1.4)
ROWS, COLUMNS, _ = SIZE
BOX = np.array([[100.0, 60.0, 20.0, 64.0 / 1.4]])  # as large as a crop shows it
MOUNT = Mount(100.0, 300.0, 1.2)


def ramp() -> np.ndarray:
    """An image that is brighter to the right, by one grey a column."""
    return np.tile(np.arange(240, dtype=np.uint8), (200, 1))


def proposed(box: np.ndarray, score: float = 0.0) -> Detections:
    return Detections.from_trees(box, np.full(len(box), score))


def test_a_crop_of_its_own_size_shows_the_pixels_round_the_middle_of_the_box() -> None:
    grey = np.random.default_rng(0).integers(0, 256, (200, 240)).astype(np.uint8)
    crop = cut_crops(grey, np.zeros_like(grey), BOX, SIZE)[0, ..., 0]
    # The middle of the box is at column 110.0 and row 82.86, pixels are counted from their middles.
    left, top = 110.5 - COLUMNS / 2.0, 60.0 + 32.0 / 1.4 + 0.5 - ROWS / 2.0
    rows, columns = round(top), int(left + 0.5)
    near = grey[rows : rows + ROWS, columns : columns + COLUMNS].astype(float)
    assert np.corrcoef(near.ravel(), crop.astype(float).ravel())[0, 1] > 0.5


@pytest.mark.parametrize("height", [24.0, 46.0, 90.0, 150.0])
def test_what_is_in_the_middle_stays_there_at_any_size(height: float) -> None:
    box = np.array([[120.0 - 0.11 * height, 100.0 - height / 2.0, 0.22 * height, height]])
    crop = cut_crops(ramp(), ramp(), box, SIZE)[0].astype(float)
    inside = crop[..., 2] > 0
    across = (np.arange(COLUMNS) + 0.5 - COLUMNS / 2.0) * 1.4 * height / ROWS + 120.0
    expected = np.tile(across, (ROWS, 1))
    assert np.abs(crop[..., 0] - expected)[inside].max() < 2.0
    np.testing.assert_array_equal(crop[..., 0], crop[..., 1])


@pytest.mark.parametrize("size", [SIZE, CropSize(96, 72, 1.3), CropSize(40, 40, 2.0)])
def test_a_crop_shows_so_many_heights(size: CropSize) -> None:
    grey = np.zeros((200, 240), np.uint8)
    grey[60:140] = 200
    box = np.array([[110.0, 60.0, 20.0, 80.0]])
    crop = cut_crops(grey, grey, box, size)[0]
    assert crop.shape == (size.rows, size.columns, CHANNELS)
    assert (crop[:, 20, 0] > 100).sum() == pytest.approx(size.rows / size.heights, abs=1.0)


def test_what_is_beyond_the_image_is_told() -> None:
    grey = np.full((120, 160), 9, np.uint8)
    box = np.array([[70.0, 90.0, 20.0, 60.0]])
    inside = cut_crops(grey, grey, box, SIZE)[0, ..., 2] > 0
    above = (120.0 - (120.0 - 0.7 * 60.0)) / (1.4 * 60.0)  # share of rows that the image has
    assert inside[: int(above * ROWS) - 1].all()
    assert not inside[int(above * ROWS) + 1 :].any()


def test_gain_and_offset_of_an_image_do_not_matter() -> None:
    rng = np.random.default_rng(1)
    grey, change = rng.integers(40, 100, (200, 240)), rng.integers(0, 20, (200, 240))
    one = normalise_crops(cut_crops(grey.astype(np.uint8), change.astype(np.uint8), BOX, SIZE))
    other = normalise_crops(
        cut_crops((2 * grey + 20).astype(np.uint8), (2 * change).astype(np.uint8), BOX, SIZE)
    )
    assert np.abs(one - other).max() < 0.3  # the noise that is always allowed for


def test_nothing_proposed_has_no_crops() -> None:
    none = np.empty((0, 4))
    crops = cut_crops(ramp(), ramp(), none, SIZE)
    assert crops.shape == (0, ROWS, COLUMNS, CHANNELS)
    assert normalise_crops(crops).shape == crops.shape
    assert crop_features(proposed(none), crops, (200, 240), MOUNT).shape == (0, FEATURES)


def numbers(box: tuple[float, float, float, float], mount: Mount | None) -> list[float]:
    boxes = np.array([box])
    crops = cut_crops(ramp(), ramp(), boxes, SIZE)
    told = crop_features(proposed(boxes, 2.0), crops, (200, 240), mount)
    return [float(number) for number in told[0]]


def test_numbers_tell_score_size_and_what_is_cut_off() -> None:
    score, height, above, below, left, right, *_ = numbers((-5.0, 130.0, 20.0, 80.0), None)
    assert (score, height) == (0.5, 0.0)
    assert (above, left, right) == (0.0, 0.25, 0.0)
    assert below == pytest.approx(10.0 / 80.0)


@pytest.mark.parametrize(("stature_m", "sign"), [(1.7, 0.0), (2.1, 1.0), (1.3, -1.0)])
def test_numbers_tell_the_stature_of_who_stands_there(stature_m: float, sign: float) -> None:
    distance_m = 6.0
    foot = MOUNT.horizon_px + MOUNT.focal_px * MOUNT.height_m / distance_m
    height = MOUNT.focal_px * stature_m / distance_m
    *_, stature, is_known = numbers((100.0, foot - height, 20.0, height), MOUNT)
    assert is_known == 1.0
    assert np.sign(round(stature, 5)) == sign


def test_without_a_mount_no_stature_is_told() -> None:
    assert numbers((100.0, 60.0, 20.0, 80.0), None)[-2:] == [0.0, 0.0]
