"""A panoramic camera in a scenario: in the run folder, in exports, and refused where it makes no sense."""

from __future__ import annotations

from pathlib import Path

import cv2
import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.scenarios.drawing.overlay import box_parts
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.geometry.mirror import MIRRORS
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Pinhole
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, run_cli


def scene(**camera: object) -> dict[str, object]:
    return SCENE | {
        "name": "all_round",
        "duration_s": 0.6,
        "place": {"kind": "room", "length_m": 12.0, "width_m": 6.0},
        "things": [],
        "people": [{"name": "carl", "path": [{"at_m": [3.5, 0.05]}]}],
        "robot": {"at_m": [6.0, 0.0], "cameras": {"panorama": {"kind": "panorama", **camera}}},
    }


def test_a_run_keeps_both_images_and_boxes_that_go_on_over_the_seam(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(scene(rate_hz=3, raw=True)), encoding="utf-8")
    assert run_cli("run", path, "--out", tmp_path / "run", "--frames") == 0
    for folder, shape in (("panorama", (120, 480, 3)), ("panorama_raw", (240, 240, 3))):
        assert [one.name for one in sorted((tmp_path / "run" / folder).iterdir())] == [
            "000001.png",
            "000006.png",
        ]
        assert cv2.imread(str(tmp_path / "run" / folder / "000001.png")).shape == shape
    (row, _) = pq.read_table(tmp_path / "run" / "truth" / "panorama.parquet").to_pylist()
    for kind in ("", "whole_", "visible_"):
        left, width = row[f"{kind}left_px"], row[f"{kind}width_px"]
        assert left < 479.5 < left + width < 500.0
    for form in ("coco", "mcap"):
        assert run_cli("export", tmp_path / "run", "--format", form, "--out", tmp_path / form) == 0
    for form in ("mot", "viper", "mp4"):
        out = ("--camera", "panorama", "--out", tmp_path / form)
        assert run_cli("export", tmp_path / "run", "--format", form, *out) == 0


def test_a_tracker_that_asks_for_a_panorama_gets_the_usual_one() -> None:
    cameras = load_scenario("crossing_2").mounting(("panorama",)).world(0).robot.cameras
    assert cameras["panorama"] == PanoramaConfig()


def test_a_mirror_is_told_by_name_or_by_values(tmp_path: Path) -> None:
    found = []
    for mirror in (
        "narrow",
        {"half_apex_deg": 62.5, "lens_half_angle_deg": 27.0, "lens_m": 0.08, "apex_m": 1.66},
    ):
        path = tmp_path / "scene.yaml"
        path.write_text(yaml.safe_dump(scene(mirror=mirror)), encoding="utf-8")
        found.append(load_scenario(path).world(0).robot.cameras["panorama"].camera)
    assert found == [Panorama(mirror=MIRRORS["narrow"])] * 2


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"mirror": "wide"}, ("mirror", "wide", "narrow")),
        ({"mirror": {"half_apex_deg": 40.0}}, ("mirror", "half_apex_deg", "40", "45")),
        (
            {"mirror": {"half_apex_deg": 46.0, "lens_half_angle_deg": 60.0}},
            ("mirror", "lens_half_angle", "60"),
        ),
        ({"mirror": {"lens_m": 0.5, "apex_m": 0.3}}, ("mirror", "lens_m", "0.5")),
        ({"yaw_deg": 3.0}, ("panorama", "yaw_deg")),
        ({"raw": 1}, ("panorama", "raw", "true or false")),
        ({"rate_hz": 4}, ("panorama", "rate_hz", "4", "3, 5")),
        ({"width_px": 3}, ("panorama", "width_px", "16")),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], keys: dict[str, object], named: tuple[str, ...]
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump(scene(**keys)), encoding="utf-8")
    said = refusal(capsys, "run", path, "--out", tmp_path / "none")
    assert_names(said, "robot.cameras", *named)
    assert not (tmp_path / "none").exists()


def test_a_box_across_the_seam_is_drawn_in_two_parts() -> None:
    box = (470.5, 10.0, 20.0, 30.0)
    assert box_parts(box, Panorama()) == ((470.5, 10.0, 9.0, 30.0), (-0.5, 10.0, 11.0, 30.0))
    assert box_parts(box, Pinhole(width=480, height=120)) == (box,)
    assert box_parts((459.5, 10.0, 20.0, 30.0), Panorama()) == ((459.5, 10.0, 20.0, 30.0),)
