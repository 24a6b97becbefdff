import math
from pathlib import Path

import pytest

from peopleboy.tracker.footage.odometry_file import load_odometry
from peopleboy.tracker.frame import Odometry
from tests.helpers.calls.refused import refused

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


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with refused(str(path), "CSV"):
            load_odometry(path, 2)
    (tmp_path / "odometry.csv").write_bytes(b"\xff\xfe\x00")
    with refused("odometry.csv", "CSV"):
        load_odometry(tmp_path / "odometry.csv", 2)
