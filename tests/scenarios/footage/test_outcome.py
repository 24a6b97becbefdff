import re

import pytest

from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import Tracked, outcome_lines
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.footage.grey import Polarity, Radiometry
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from tests.helpers.calls.footage_calls import call
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.footage_files import box, write_empty, write_folder

START = ",".join(str(edge) for edge in box(0))


def tracked(frames=2, tracks=2, boxes=None):
    return Tracked(frames=frames, per_second=10.0, tracks=tracks, scores=None, notes=(), boxes=boxes)


@pytest.mark.parametrize(
    ("boxes", "words"),
    [
        (BoxKind.TORSO, "2 tracks, boxes enclose torsos, 10"),
        (BoxKind.WHOLE, "whole people"),
        (None, "2 tracks, 10"),
    ],
)
def test_it_is_said_what_boxes_are_drawn_round(tmp_path, boxes, words):
    options = TrackOptions(footage=tmp_path, out=tmp_path)
    assert words in outcome_lines(tracked(boxes=boxes), options)[0]


def test_if_nobody_is_found_that_is_said_with_what_to_look_at(tmp_path):
    out = tmp_path / "out"
    told = call(write_empty(tmp_path / "clip"), "--out", out).stdout
    assert "3 frames, 0 tracks" in told
    assert "shows them" not in told
    assert str(out / "contact_sheet.png") in told
    assert "--polarity black-hot" in told


@pytest.mark.parametrize("name", VARIANTS)
def test_the_heights_told_are_those_that_the_tracker_looks_for(tmp_path, name):
    options = TrackOptions(footage=tmp_path, out=tmp_path, tracker=name)
    shown = outcome_lines(tracked(tracks=0), options)[1]
    least, *most = (int(number) for number in re.findall(r"(\d+)%", shown))
    config = VARIANTS[name]
    limits = [100 * config.box.height_per_h * share for share in config.detector.limits.h]
    assert least == pytest.approx(limits[0], abs=1)
    assert most == ([pytest.approx(limits[1], abs=1)] if limits[1] < 100 else [])


def test_who_told_no_temperatures_to_the_tracker_that_knows_them_is_told_how(tmp_path):
    clip = write_empty(tmp_path / "clip")
    options = ("--out", tmp_path / "out", "--overwrite")
    for tracker, is_told in (("contour", True), ("detection", False)):
        last = call(clip, *options, "--tracker", tracker).stdout.splitlines()[-1]
        assert ("--temperature-range" in last) == is_told
    told = call(clip, *options, "--tracker", "contour", "--temperature-range", 20, 40).stdout
    assert "--temperature-range" not in told


def test_after_black_hot_the_advice_is_white_hot(tmp_path):
    options = TrackOptions(footage=tmp_path, out=tmp_path, radiometry=Radiometry(polarity=Polarity.BLACK_HOT))
    assert "--polarity white-hot" in outcome_lines(tracked(tracks=0), options)[1]


def test_of_a_tracker_of_ones_own_no_heights_are_known(tmp_path):
    options = TrackOptions(footage=tmp_path, out=tmp_path, tracker="mine:Tracker")
    assert_names(outcome_lines(tracked(tracks=0), options)[1], "contact_sheet.png", "--polarity black-hot")


def test_one_is_not_a_plural(tmp_path):
    told = call(write_folder(tmp_path / "clip", 1), "--out", tmp_path / "out", "--start", START).stdout
    assert "1 frame, 1 track, " in told


def test_with_a_film_the_last_line_names_it(tmp_path):
    pytest.importorskip("av")
    clip = write_folder(tmp_path / "clip", 3)
    told = call(clip, "--out", tmp_path / "out", "--start", START, "--video").stdout
    film = tmp_path / "out" / "overlay.mp4"
    assert_names(told.splitlines()[-1], tmp_path / "out" / "contact_sheet.png", film)
    assert film.is_file()
