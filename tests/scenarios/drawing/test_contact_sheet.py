from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from peopleboy.scenarios.drawing.contact_sheet import (
    COLUMNS,
    HEAD_PX,
    MARGIN_PX,
    MOMENTS,
    PAGE,
    STRONG,
    WIDTH_PX,
    ContactSheet,
    cut,
    draw_head,
    font,
    read_tiles,
)
from peopleboy.scenarios.drawing.key_moments import KeyMoments
from peopleboy.scenarios.drawing.palette import TRUTH, track_colour
from peopleboy.sim.robot.robot_config import RobotConfig
from tests.helpers.calls.footage_calls import call
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import box, write_folder
from tests.helpers.runs import synthetic_ticks as made


def sheet(frames: int = 75) -> ContactSheet:
    made_sheet = ContactSheet("made, seed 7, tracker contour")
    for tick, events in made.make_run(frames):
        made_sheet.add(tick, events)
    return made_sheet


def pixels(path: Path) -> NDArray[np.uint8]:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def chosen(frames: int = 75) -> KeyMoments:
    moments = KeyMoments(RobotConfig().cameras)
    for tick, events in made.make_run(frames):
        moments.add(tick, events)
    return moments


def test_the_sheet_is_a_picture_of_three_rows_of_four_tiles(tmp_path: Path) -> None:
    sheet().save(tmp_path / "sheet.png")
    picture = pixels(tmp_path / "sheet.png")
    one_row = np.asarray(sheet(COLUMNS).draw()).shape[0]
    two_rows = np.asarray(sheet(2 * COLUMNS).draw()).shape[0]
    assert picture.shape == (one_row + 2 * (two_rows - one_row), WIDTH_PX, 3)


def test_tracks_are_drawn_in(tmp_path: Path) -> None:
    sheet().save(tmp_path / "sheet.png")
    like_track = np.abs(pixels(tmp_path / "sheet.png").astype(int) - track_colour(1)).max(axis=2) < 30
    assert like_track.sum() > 5000


def test_the_tiles_of_a_saved_sheet_can_be_read_back_with_their_words(tmp_path: Path) -> None:
    sheet().save(tmp_path / "sheet.png")
    tiles = read_tiles(tmp_path / "sheet.png")
    moments = chosen().choose(MOMENTS)
    assert [tile.words for tile in tiles] == [f"{m.time_s:.1f} s: {'; '.join(m.words)}" for m in moments]
    assert len({tile.picture.size for tile in tiles}) == 1


def test_a_sheet_that_does_not_say_where_its_tiles_are_is_one_tile(tmp_path: Path) -> None:
    Image.new("RGB", (40, 30)).save(tmp_path / "sheet.png")
    (tile,) = read_tiles(tmp_path / "sheet.png")
    assert tile.picture.size == (40, 30)


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one.png", "two.png"):
        sheet().save(tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


@pytest.mark.parametrize("frames", [0, 1, 3, 5])
def test_a_short_run_has_a_sheet_as_well(tmp_path: Path, frames: int) -> None:
    sheet(frames).save(tmp_path / "sheet.png")
    assert pixels(tmp_path / "sheet.png").shape[1] == WIDTH_PX


def test_a_folder_that_is_not_there_is_a_user_s_mistake(tmp_path: Path) -> None:
    with refused(tmp_path / "missing" / "sheet.png", "--out"):
        sheet(3).save(tmp_path / "missing" / "sheet.png")


def test_drawing_prints_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    sheet(20).save(tmp_path / "sheet.png")
    assert capfd.readouterr() == ("", "")


def test_start_detection_occlusion_and_loss_are_among_the_moments_and_in_order() -> None:
    moments = chosen().choose(MOMENTS)
    frames = [moment.frame for moment in moments]
    assert len(frames) == len(set(frames)) == MOMENTS
    assert frames == sorted(frames)
    assert {1, 5, 20, 30, 40, 70} <= set(frames)


def test_moments_say_what_happened() -> None:
    words = {moment.frame: "; ".join(moment.words) for moment in chosen().choose(MOMENTS)}
    assert words[1].startswith("start")
    assert_names(words[30], "ben", "95%", "anna")
    assert_names(words[20], "ben", "anna", "starts")
    assert "track 1: detected" in words[5]


def test_how_much_is_hidden_is_said_of_the_very_frame_that_is_shown() -> None:
    moments = KeyMoments(RobotConfig().cameras)
    run = made.make_run()
    detected, _ = run[4][1]
    run[4], run[27] = (run[4][0], []), (run[27][0], [detected])  # two frames before the most is hidden
    for tick, events in run:
        moments.add(tick, events)
    words = {moment.frame: "; ".join(moment.words) for moment in moments.choose(MOMENTS)}
    assert_names(words[28], "track 1: detected", "ben", "77%", "anna")


def test_what_nothing_happens_in_is_filled_evenly() -> None:
    moments = KeyMoments(RobotConfig().cameras)
    for frame in range(61, 661):
        moments.add(made.make_tick(frame), [])
    frames = [moment.frame for moment in moments.choose(9)]
    assert np.diff(frames).max() <= 150


def test_a_long_run_keeps_few_moments() -> None:
    moments = KeyMoments(RobotConfig().cameras)
    tick, events = made.make_run(20)[19]
    for _ in range(5000):
        moments.add(tick, events)
    assert len(moments._kept) + len(moments._spare) < 70


def head(title="clip", length="12 frames", **options):
    page = Image.new("RGB", (1600, 200), PAGE)
    draw_head(page, title, length, **options)
    return np.array(page)


def has(page, colour):
    return bool((page == colour).all(axis=2).any())


def test_the_head_keeps_to_its_rows_and_explains_truth_only_where_it_is_drawn():
    for has_truth in (True, False):
        page = head(has_truth=has_truth)
        assert (page[HEAD_PX:] == PAGE).all()
        assert has(page, STRONG)
        assert has(page, track_colour(1))
        assert has(page, TRUTH) == has_truth


def test_a_long_title_is_cut_and_runs_into_nothing():
    columns = np.flatnonzero((head(title="a long name " * 30) == STRONG).all(axis=2).any(axis=0))
    legend = np.flatnonzero((head() == track_colour(1)).all(axis=2).any(axis=0))
    assert columns[0] >= MARGIN_PX
    assert columns[-1] < legend[0]
    draw = ImageDraw.Draw(Image.new("RGB", (1, 1)))
    assert cut(draw, "short", font(15), 500) == "short"


def test_the_sheet_of_footage_says_whose_it_is_and_what_its_marks_mean(tmp_path):
    heads = []
    for name in ("one", "other"):
        clip = write_folder(tmp_path / name, 3)
        start = ",".join(str(edge) for edge in box(0))
        assert call(clip, "--out", tmp_path / f"{name}_out", "--start", start).exit_code == 0
        sheet = np.array(Image.open(tmp_path / f"{name}_out" / "contact_sheet.png").convert("RGB"))
        heads.append(sheet[:HEAD_PX])
        assert has(heads[-1], STRONG)
        assert has(heads[-1], track_colour(1))
        assert not has(heads[-1], TRUTH)
    assert not np.array_equal(*heads)
