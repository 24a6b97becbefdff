"""A user's detector, or a file of detections, in place of the tracker's own, through the commands."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.mot_files import read_detections
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, export

BRIEF: dict[str, Any] = SCENE | {
    "name": "brief",
    "duration_s": 2.0,
    "things": [],
    "people": [
        {"name": "anna", "path": [{"at_m": [4.6, -0.8]}, {"at_m": [4.6, 0.8], "speed_m_s": 1.0}]},
    ],
}
MODULE = """\
import cv2
import numpy as np


class Warm:
    def detect(self, image):
        warm = cv2.morphologyEx((image > 80).astype(np.uint8), cv2.MORPH_CLOSE, np.ones((7, 3)))
        blobs = cv2.connectedComponentsWithStats(warm)[2][1:]
        blobs = blobs[blobs[:, 3] > 20]
        return blobs[:, :4], np.full(len(blobs), 0.9)


class Late(Warm):
    def __init__(self):
        self.images = 0

    def detect(self, image):
        self.images += 1
        return super().detect(image) if self.images < 3 else self.fail(image)


class Wrong(Late):
    def fail(self, image):
        return [(1, 2, -3, 4)], [0.5]


class Raising(Late):
    def fail(self, image):
        return 1 / 0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold the scenario, the module of detectors, a run with images, and its export."""
    folder = tmp_path_factory.mktemp("detectors")
    (folder / "brief.yaml").write_text(yaml.safe_dump(BRIEF), encoding="utf-8")
    (folder / "warm_for_test.py").write_text(MODULE, encoding="utf-8")
    options = ("--no-recording", "--frames", "--out", folder / "plain")
    assert run_cli("run", folder / "brief.yaml", *options) == 0
    export(folder / "plain", "mot", folder / "mot")
    return folder


@pytest.fixture(autouse=True)
def home(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(folder)
    return folder


def det_file(home: Path) -> Path:
    return home / "mot/gt/mot_challenge/peopleboy-all/brief-0/det/det.txt"


def about(run: str) -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(Path(run, "run.json").read_text(encoding="utf-8"))
    return loaded


def recall(run: str) -> float:
    metrics = json.loads(Path(run, "metrics.json").read_text(encoding="utf-8"))
    return float(metrics["thesis"]["CR_percent"])


def test_a_run_with_it_says_so_and_finds_the_person() -> None:
    command = ("run", "brief.yaml", "--detector", "warm_for_test:Warm", "--boxes", "whole", "--no-recording")
    assert run_cli(*command) == 0
    run = "runs/brief-0-warm_for_test.Warm"
    assert about(run)["tracker"] == "detection+warm_for_test:Warm"
    assert recall(run) > 60.0
    assert run_cli("report", run, "--out", "page.html") == 0
    page = Path("page.html").read_text(encoding="utf-8")
    assert "--tracker detection+warm_for_test:Warm --boxes whole" in page


def test_runs_with_and_without_it_are_compared_as_two_trackers(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--detector", "warm_for_test:Warm", "--seeds", 1, "--workers", 1, "--out", "swept")
    assert run_cli("sweep", "brief.yaml", *options) == 0
    assert run_cli("sweep", "brief.yaml", *options) == 0  # a complete sweep stays as it is
    capsys.readouterr()
    assert run_cli("evaluate", "plain", "swept/brief-0", "--json") == 0
    assert set(json.loads(capsys.readouterr().out)["trackers"]) == {
        "detection",
        "detection+warm_for_test:Warm",
    }


@pytest.mark.thorough
def test_another_process_gives_the_same_bytes(home: Path) -> None:
    command = ("run", "brief.yaml", "--detector", "warm_for_test:Warm", "--no-recording")
    assert run_cli(*command, "--out", "here") == 0
    script = f"from peopleboy.scenarios.cli import main; main({[*command, '--out', 'there']!r})"
    subprocess.run([sys.executable, "-c", script], check=True, cwd=home)
    for name in ("tracks.txt", "tracks.parquet"):
        assert Path("here", name).read_bytes() == Path("there", name).read_bytes()


def test_an_export_has_the_detections_of_every_image(home: Path) -> None:
    found = read_detections(det_file(home))
    assert len(np.unique(found.frame)) > 20
    assert ((found.score > 0.0) & (found.score <= 1.0)).all()
    truth = np.loadtxt(det_file(home).parents[1] / "gt" / "gt.txt", delimiter=",")
    sure = found.score > 0.5
    overlap = [
        iou(box[None], truth[truth[:, 0] == frame, 2:6]).max(initial=0.0)
        for frame, box in zip(found.frame[sure], found.box[sure], strict=True)
    ]
    assert np.mean(np.array(overlap) > 0.5) > 0.9


def test_the_exported_detections_track_as_the_detector_does(home: Path) -> None:
    command = ("run", "brief.yaml", "--detector", det_file(home), "--no-recording", "--out", "from_file")
    assert run_cli(*command) == 0
    assert about("from_file")["tracker"] == "detection+det.txt"
    assert recall("from_file") >= recall("plain") - 10.0


def test_a_file_is_tracked_in_images_too(home: Path) -> None:
    assert run_cli("track", "plain/thermal", "--detector", det_file(home), "--out", "tracked") == 0
    assert about("tracked")["tracker"] == "detection+det.txt"
    assert len(Path("tracked/tracks.txt").read_text(encoding="utf-8").splitlines()) > 15


def test_a_class_is_used_in_images_too() -> None:
    assert run_cli("track", "plain/thermal", "--detector", "warm_for_test:Warm", "--out", "warm") == 0
    assert about("warm")["tracker"] == "detection+warm_for_test:Warm"
    assert Path("warm/tracks.txt").read_text(encoding="utf-8")


def test_an_invalid_detection_ends_the_run_with_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--detector", "warm_for_test:Wrong", "--no-recording", "--out", "wrong")
    said = refusal(capsys, "run", "brief.yaml", *options)
    assert_names(said, "frame 3", "'detection+warm_for_test:Wrong'", "box 0", "width > 0", "-3.0")
    assert about("wrong")["status"] == "failed"
    said = refusal(
        capsys, "track", "plain/thermal", "--detector", "warm_for_test:Wrong", "--out", "wrong_too"
    )
    assert_names(said, "frame 3", "'detection+warm_for_test:Wrong'", "width > 0")
    assert not Path("wrong_too").exists()


def test_an_error_in_it_names_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--detector", "warm_for_test:Raising", "--no-recording", "--out", "raising")
    assert run_cli("run", "brief.yaml", *options) == 1
    said = capsys.readouterr().err
    assert_names(said, "frame 3", "detection+warm_for_test:Raising", "ZeroDivisionError", "warm_for_test.py")


@pytest.mark.parametrize(
    ("command", "says"),
    [
        (
            ("run", "brief.yaml", "--tracker", "contour"),
            ("'contour' uses no detector", "detection, detection-live, handover"),
        ),
        (("run", "brief.yaml", "--tracker", "truth"), ("'truth' uses no detector",)),
        (("track", "plain/thermal", "--tracker", "thesis"), ("'thesis' uses no detector",)),
    ],
)
def test_with_another_tracker_it_is_refused(
    command: tuple[str, ...],
    says: tuple[str, ...],
    capsys: pytest.CaptureFixture[str],
) -> None:
    said = refusal(capsys, *command, "--detector", "warm_for_test:Warm", "--out", "refused")
    assert_names(said, *says)
    assert not Path("refused").exists()


def test_a_file_is_refused_for_several_runs(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--detector", det_file(home), "--seeds", 2, "--workers", 1, "--out", "several")
    assert_names(refusal(capsys, "sweep", "brief.yaml", *options), "det.txt", "one run")
    assert not Path("several").exists()


def test_a_file_of_a_longer_run_is_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    longer = home / "longer.txt"
    longer.write_text(
        f"{det_file(home).read_text(encoding='utf-8')}31,-1,9,9,20,60,0.9,-1,-1,-1\n", encoding="utf-8"
    )
    for command in (("run", "brief.yaml"), ("track", "plain/thermal")):
        said = refusal(capsys, *command, "--detector", longer, "--out", "longer")
        assert_names(said, "longer.txt", "must end with frame 30", "got 31")
        assert not Path("longer").exists()


def test_the_kind_of_boxes_in_footage_is_up_to_the_detector(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--detector", "warm_for_test:Warm", "--boxes", "whole", "--out", "kinds")
    assert_names(refusal(capsys, "track", "plain/thermal", *options), "--boxes whole", "your own")
