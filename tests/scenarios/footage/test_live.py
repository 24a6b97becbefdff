import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.calls.footage_calls import refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.footage_files import SIZE, walker, write_video

RAW = ("--size", f"{SIZE[1]}x{SIZE[0]}", "--pixels", "gray16")
COUNT = 20


def start(out: Path, *arguments: str) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", "peopleboy", "track", "-", "--out", str(out), *arguments]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def feed(tracking: "subprocess.Popen[bytes]", numbers: range) -> list[dict]:
    """Write images one by one, each after the line of the one before, and return the lines."""
    lines = []
    for number in numbers:
        tracking.stdin.write((walker(number).astype(np.uint16) * 100).tobytes())
        tracking.stdin.flush()
        lines.append(json.loads(tracking.stdout.readline()))
    return lines


def about(out: Path) -> dict:
    return json.loads((out / "run.json").read_text())


def test_raw_images_of_a_pipe_are_tracked_as_they_come(tmp_path):
    tracking = start(tmp_path / "out", *RAW, "--rate-hz", "15")
    lines = feed(tracking, range(COUNT))
    _, errors = tracking.communicate()
    assert tracking.returncode == 0, errors.decode()
    assert [line["frame"] for line in lines] == list(range(1, COUNT + 1))
    assert lines[-1]["time_s"] == pytest.approx((COUNT - 1) / 15, abs=1e-5)
    assert lines[-1]["tracks"][0]["status"] == "tracked"
    last = (tmp_path / "out" / "tracks.txt").read_text().splitlines()[-1].split(",")
    assert int(last[0]) == COUNT
    assert [float(cell) for cell in last[2:6]] == pytest.approx(lines[-1]["tracks"][0]["box_px"], abs=0.01)
    assert "0 of 20 images dropped" in " ".join(about(tmp_path / "out")["notes"])


def test_an_interrupt_ends_it_with_all_files_written(tmp_path):
    tracking = start(tmp_path / "out", *RAW)
    lines = feed(tracking, range(3))
    tracking.send_signal(signal.SIGINT)
    _, errors = tracking.communicate(timeout=60)
    assert tracking.returncode == 0, errors.decode()
    assert about(tmp_path / "out")["frames"] == len(lines) == 3
    assert {"tracks.txt", "tracks.parquet", "contact_sheet.png"} <= {
        path.name for path in (tmp_path / "out").iterdir()
    }


@pytest.mark.thorough
def test_a_reader_that_ends_ends_it_with_all_files_written(tmp_path):
    tracking = start(tmp_path / "out", *RAW)
    feed(tracking, range(2))
    tracking.stdout.close()
    tracking.stdin.write((walker(3).astype(np.uint16) * 100).tobytes())
    tracking.stdin.flush()
    tracking.stdin.close()
    with tracking.stderr as errors:
        printed = errors.read().decode()
    assert tracking.wait(timeout=60) == 0, printed
    assert about(tmp_path / "out")["frames"] == 3


@pytest.mark.thorough
def test_encoded_video_of_a_pipe_is_decoded(tmp_path):
    tracking = start(tmp_path / "out")
    printed, errors = tracking.communicate(write_video(tmp_path / "film.mkv").read_bytes(), timeout=120)
    assert tracking.returncode == 0, errors.decode()
    assert json.loads(printed.splitlines()[0])["frame"] == 1
    assert (about(tmp_path / "out")["width"], about(tmp_path / "out")["height"]) == SIZE[::-1]
    assert "of 12 images dropped" in errors.decode()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-", *RAW[:2]), ("--size", "--pixels")),
        (("clip", "--out", "out", *RAW), ("--size", "standard input")),
        (("0", *RAW), ("camera 0", "--size")),
        (("-", "--colour", "clip"), ("--colour", "standard input")),
        (("-", "--start", "1,2,3,4"), ("--start",)),
        (("-", "--truth", "clip"), ("--truth",)),
        (("-", "--json"), ("--json",)),
        (("7",), ("camera 7",)),
    ],
)
def test_what_a_live_source_cannot_have_is_refused(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert_names(refusal(*arguments), *words)
    assert not list(tmp_path.rglob("run.json"))
