import math

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.footage_files import SIZE, write_folder

COUNT = 14


def tracked(tmp_path, *arguments):
    result = call(tmp_path / "clip", "--out", tmp_path / "out", *arguments)
    assert result.exit_code == 0, result.output
    return pq.read_table(tmp_path / "out" / "tracks.parquet").to_pylist()


@pytest.fixture
def clip(tmp_path):
    return write_folder(tmp_path / "clip", COUNT)


@pytest.mark.usefixtures("clip")
def test_height_and_field_of_view_give_positions_on_the_floor(tmp_path):
    last = tracked(tmp_path, "--camera-height-m", "1.2", "--vertical-fov-deg", "44")[-1]
    focal_px = SIZE[0] / 2.0 / math.tan(math.radians(22.0))
    feet_px = last["top_px"] + last["height_px"] - SIZE[0] / 2.0
    assert last["place_x_m"] == pytest.approx(1.2 * focal_px / feet_px, rel=0.15)
    middle_px = last["left_px"] + last["width_px"] / 2.0 - SIZE[1] / 2.0
    assert last["place_y_m"] == pytest.approx(-middle_px / focal_px * last["place_x_m"], abs=0.15)


@pytest.mark.usefixtures("clip")
def test_without_them_positions_are_unknown(tmp_path):
    assert tracked(tmp_path)[-1]["place_x_m"] is None


@pytest.mark.parametrize(("side", "is_found"), [(slice(0, 80), True), (slice(110, 160), False)])
@pytest.mark.usefixtures("clip")
def test_people_are_searched_for_inside_the_mask_only(tmp_path, side, is_found):
    mask = np.zeros(SIZE, np.uint8)
    mask[:, side] = 255
    cv2.imwrite(str(tmp_path / "mask.png"), mask)
    rows = tracked(tmp_path, "--mask", tmp_path / "mask.png")
    assert any(row["status"] == "tracked" for row in rows) == is_found


@pytest.mark.usefixtures("clip")
def test_a_mask_that_is_all_white_changes_nothing(tmp_path):
    cv2.imwrite(str(tmp_path / "mask.png"), np.full(SIZE, 255, np.uint8))
    plain = tracked(tmp_path)
    assert tracked(tmp_path, "--mask", tmp_path / "mask.png", "--overwrite") == plain


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--camera-height-m", "1.2"), ("--vertical-fov-deg", "--focal-px", "--calibration")),
        (("--vertical-fov-deg", "44"), ("--camera-height-m",)),
        (("--mask", "small.png"), ("--mask", "160x120", "got 30x40")),
        (("--mask", "black.png"), ("black.png", "all black")),
        (("--mask", "none.png"), ("none.png",)),
        (("--calibration", "none.yml"), ("none.yml",)),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, clip, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    cv2.imwrite("small.png", np.full((40, 30), 255, np.uint8))
    cv2.imwrite("black.png", np.zeros(SIZE, np.uint8))
    assert_names(refusal(clip, "--out", tmp_path / "out", *arguments), *words)
    assert not (tmp_path / "out").exists()
