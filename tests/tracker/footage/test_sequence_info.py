import json
import math
from pathlib import Path

import pytest

from peopleboy.tracker.footage.sequence_info import load_odometry
from peopleboy.tracker.frame import Odometry
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import write_folder


def sequence(tmp_path, text):
    write_folder(tmp_path / "seq" / "img1", 2)
    info = tmp_path / "seq" / "seqinfo.ini"
    info.write_text(text)
    return info


def rate(tmp_path, footage, *more):
    result = call(footage, "--out", tmp_path / "out", "--overwrite", *more)
    assert result.exit_code == 0, result.output
    return json.loads((tmp_path / "out" / "run.json").read_text())["rate_hz"], result.stderr


def test_the_rate_of_a_sequence_is_taken_and_told_unless_one_is_given(tmp_path):
    info = sequence(tmp_path, "[Sequence]\nname=a\nimDir=img1\nframeRate=30\nseqLength=2\n")
    for footage in (tmp_path / "seq", tmp_path / "seq" / "img1"):
        given, told = rate(tmp_path, footage)
        assert given == 30.0
        assert_names(told, "note: ", info, "frame rate, 30 Hz")
        assert rate(tmp_path, footage, "--rate-hz", 12) == (12.0, "")


@pytest.mark.parametrize("text", ["[Sequence]\nname=a\n", "[Other]\nframeRate=30\n", ""])
def test_without_a_rate_there_it_is_the_default(tmp_path, text):
    sequence(tmp_path, text)
    assert rate(tmp_path, tmp_path / "seq") == (15.0, "")


@pytest.mark.parametrize("told", ["fast", "0", "-30", "nan", "inf", "1e9", ""])
def test_a_rate_that_is_none_is_refused_unless_one_is_given(tmp_path, told):
    info = sequence(tmp_path, f"[Sequence]\nframeRate={told}\n")
    assert_names(
        refusal(tmp_path / "seq", "--out", tmp_path / "out"), info, "0.1..1000", repr(told), "--rate-hz"
    )
    assert rate(tmp_path, tmp_path / "seq", "--rate-hz", 12) == (12.0, "")


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    info = sequence(tmp_path, "frameRate: no section\n")
    assert_names(refusal(tmp_path / "seq", "--out", tmp_path / "out"), info, "cannot be read")


HEAD = "advance_m,aside_m,turn_deg"


def written(folder: Path, text: str) -> Path:
    (folder / "odometry.csv").write_text(text, encoding="utf-8")
    return folder / "odometry.csv"


def test_each_line_is_a_pictures_way_and_its_turn_in_degrees(tmp_path: Path) -> None:
    path = written(tmp_path, f"{HEAD}\n0,0,0\n0.1, -0.02, 90\n")
    told = load_odometry(path, 2)
    assert told == [Odometry(), Odometry(advance_m=0.1, aside_m=-0.02, turn_rad=math.pi / 2)]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (f"{HEAD}\n0,0,0\n", ("2 pictures", "got 1")),
        (f"{HEAD}\n0,0,0\n0,0,0\n0,0,0\n", ("2 pictures", "got 3")),
        (f"{HEAD}\n0,0,0\n0,nan,0\n", ("picture 2", "finite")),
        (f"{HEAD}\n0,0,0\n0,0,inf\n", ("picture 2", "finite")),
        (f"{HEAD}\n0,0,0\n0,x,0\n", ("picture 2", "three numbers")),
        (f"{HEAD}\n0,0\n0,0,0\n", ("picture 1", "three numbers")),
        ("0,0,0\n0,0,0\n", ("first line", HEAD)),
        ("", ("first line", HEAD)),
    ],
)
def test_what_is_no_odometry_of_these_pictures_is_refused(
    tmp_path: Path, text: str, named: tuple[str, ...]
) -> None:
    path = written(tmp_path, text)
    with refused(str(path), *named):
        load_odometry(path, 2)


def test_an_odometry_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with refused(str(path), "CSV"):
            load_odometry(path, 2)
    (tmp_path / "odometry.csv").write_bytes(b"\xff\xfe\x00")
    with refused("odometry.csv", "CSV"):
        load_odometry(tmp_path / "odometry.csv", 2)
