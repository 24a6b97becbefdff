import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed
from peopleboy.tracker.footage.grey import CENTIKELVIN, Radiometry, check_plausible
from tests.helpers.calls.footage_calls import call, call_afresh, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import write_counts, write_folder
from tests.helpers.some_of import some_of


@pytest.mark.parametrize(
    ("scale", "span"), [("1,0", "29315..30415"), ("0.01,0", "293..304"), ("0.1,-273.15", "2658..2768")]
)
def test_temperatures_of_no_place_with_people_are_refused_with_the_scale_that_fits(tmp_path, scale, span):
    printed = refusal(write_counts(tmp_path / "clip"), "--out", tmp_path / "out", "--scale", scale)
    assert_names(printed, f"--scale {scale}", f"{span} degC", "--scale centikelvin")
    assert not (tmp_path / "out").exists()


def test_a_temperature_range_in_kelvin_is_refused():
    given = Radiometry(span_c=(297.0, 309.0))
    with refused("--temperature-range 297 309", "kelvin", "degC"):
        check_plausible(given, given.values(np.arange(256, dtype=np.uint8).reshape(16, 16)))


@pytest.mark.parametrize(("per_k", "scale"), [(10, "0.1,-273.15"), (1, "1,-273.15"), (25, "0.04,-273.15")])
def test_other_counts_of_kelvin_are_recognised(per_k, scale):
    counts = np.full((30, 40), round(295 * per_k), np.uint16)
    given = Radiometry(scale=(2.0, 0.0))
    with refused(f"--scale {scale}"):
        check_plausible(given, given.values(counts))


def test_dead_pixels_an_empty_border_and_unknown_units_are_plausible():
    counts = np.full((30, 40), 29500, np.uint16)
    counts[:, :10], counts[3, 20:25] = 0, 65535
    given = Radiometry(scale=CENTIKELVIN)
    check_plausible(given, given.values(counts))
    check_plausible(Radiometry(), np.full((30, 40), 30000.0, np.float32))
    counts[:20] = 0
    with refused("--scale"):  # once there are more dead pixels than others
        check_plausible(given, given.values(counts))


@pytest.mark.parametrize(
    "start", ["400,10,20,50", "150,10,20,50", "-5,10,20,50", "nan,10,20,50", "10,100,20,50"]
)
def test_a_start_that_is_not_inside_the_pictures_is_refused(tmp_path, start):
    printed = refusal(write_folder(tmp_path / "clip", 3), "--out", tmp_path / "out", "--start", start)
    assert_names(printed, f"--start {start}", "160x120")
    assert not (tmp_path / "out").exists()


def test_a_start_may_touch_every_edge(tmp_path):
    clip = write_folder(tmp_path / "clip", 3)
    assert call(clip, "--out", tmp_path / "out", "--start", "0,0,160,120").exit_code == 0


def test_the_tracker_that_lives_on_colour_is_refused_without(tmp_path):
    clip = write_folder(tmp_path / "clip", 3)
    assert_names(refusal(clip, "--out", tmp_path / "out", "--tracker", "colour"), "--colour")
    colour = write_folder(tmp_path / "colour", 3, "jpg")
    options = ("--out", tmp_path / "out", "--tracker", "colour", "--colour", colour)
    assert call(clip, *options).exit_code == 0


@pytest.mark.slow
@pytest.mark.parametrize("content", some_of([b"a text that somebody called a video\n" * 40, b""], 2))
def test_a_video_that_is_none_is_refused_on_one_line_and_no_library_adds_another(tmp_path, content):
    video = tmp_path / "clip.mp4"
    video.write_bytes(content)
    done = call_afresh(video, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert_names(done.stderr, f"peopleboy: {video}: ")


def test_counts_of_temperatures_are_never_black_hot(tmp_path):
    clip = write_counts(tmp_path / "clip", 3)
    printed = refusal(clip, "--out", tmp_path / "out", "--scale", "centikelvin", "--polarity", "black-hot")
    assert_names(printed, "--polarity", "--scale")


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        ("None", ("tracker 'foot_none:Mine'", "tuple of Track")),
        ("1 / 0", ("tracker 'foot_zero:Mine' failed", "foot_zero.py, line 5")),
    ],
)
def test_a_mistake_of_ones_own_tracker_is_told_with_its_frame_and_leaves_nothing(
    tmp_path, monkeypatch, answer, says
):
    module = says[0].split("'")[1].removesuffix(":Mine")
    (tmp_path / f"{module}.py").write_text(
        "class Mine:\n    cameras = ('thermal',)\n    def __init__(self, rng): pass\n"
        f"    def update(self, frame):\n        return () if frame.time_s < 0.1 else {answer}\n"
    )
    monkeypatch.chdir(tmp_path)
    clip = write_folder(tmp_path / "clip", 4)
    done = call(clip, "--out", tmp_path / "out", "--tracker", f"{module}:Mine")
    assert isinstance(done.exception, BadInput if answer == "None" else OwnCodeFailed)
    assert_names(str(done.exception), "frame 3", *says)
    assert not (tmp_path / "out").exists()
    kept = tmp_path / "out-traceback.txt"
    assert kept.exists() == (answer == "1 / 0")
    if kept.exists():
        assert str(kept) in str(done.exception)
        assert "ZeroDivisionError: division by zero" in kept.read_text()
