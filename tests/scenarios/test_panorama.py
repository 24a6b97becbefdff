"""A panoramic camera in a scenario: in the run folder, in exports, and refused where it makes no sense."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from xml.etree import ElementTree

import av
import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from pycocotools.coco import COCO
from rerun.chunk import RrdReader

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.scenarios.drawing.overlay import box_parts
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.report.findings.run_findings import analyse_run
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.scores.evaluate_runs import BoxReference, ScoreOptions, evaluate_runs
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.geometry.panorama import MIRRORS, Panorama
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.box_kinds import BoxKind
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, export, run_cli


def scene(**camera: object) -> dict[str, object]:
    return SCENE | {
        "name": "all_round",
        "duration_s": 0.6,
        "place": {"kind": "room", "length_m": 12.0, "width_m": 6.0},
        "things": [],
        "people": [{"name": "carl", "path": [{"at_m": [3.5, 0.05]}]}],
        "robot": {"at_m": [6.0, 0.0], "cameras": {"panorama": {"kind": "panorama", **camera}}},
    }


@pytest.mark.slow
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
    box, parts = (470.5, 10.0, 20.0, 30.0), ((470.5, 10.0, 9.0, 30.0), (-0.5, 10.0, 11.0, 30.0))
    assert box_parts(box, Panorama()) == parts
    assert box_parts((-9.5, 10.0, 20.0, 30.0), Panorama()) == parts
    assert box_parts(box, Pinhole(width=480, height=120)) == (box,)
    assert box_parts((459.5, 10.0, 20.0, 30.0), Panorama()) == ((459.5, 10.0, 20.0, 30.0),)


@pytest.fixture(scope="module")
def tracked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Carl comes when the background is learned, and walks over the seam."""
    carl = {"name": "carl", "enter_s": 1.8, "path": [{"at_m": [0.5, -0.9]}, {"at_m": [0.7, 1.6]}]}
    robot = {"at_m": [3.0, 0.0], "cameras": {"panorama": {"kind": "panorama", "rate_hz": 3}}}
    folder = tmp_path_factory.mktemp("tracked")
    path, run = folder / "scene.yaml", folder / "run"
    path.write_text(
        yaml.safe_dump(scene() | {"duration_s": 4.0, "people": [carl], "robot": robot}), encoding="utf-8"
    )
    assert run_cli("run", path, "--tracker", "panoramic-paper", "--out", run) == 0
    return run


def boxes_in(path: Path) -> dict[int, list[float]]:
    """The one person's or track's box by frame."""
    return {int(row[0]): row[2:6].tolist() for row in np.loadtxt(path, delimiter=",", ndmin=2)}


@pytest.mark.slow
def test_tracks_on_the_other_side_of_the_seam_match_all_the_same(tracked: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    shutil.copytree(tracked, run)
    truth = (run / "truth" / "panorama.gt.txt").read_text(encoding="utf-8").splitlines()
    lines = [line.split(",") for line in truth]
    text = [f"{frame},7,{float(left) - 480.0},{','.join(box)},1,-1,-1,-1" for frame, _, left, *box in
            (line[:6] for line in lines)]  # fmt: skip
    (run / "tracks" / "panorama.txt").write_text("".join(f"{line}\n" for line in text), encoding="utf-8")
    (people,) = evaluate_runs([run], ScoreOptions(camera="panorama", boxes=BoxKind.TORSO))
    scores = people.scores
    assert scores.counts.targets > 3
    assert scores.thesis.ca == scores.thesis.aa == pytest.approx(100.0)
    assert scores.mot.hota.hota == pytest.approx(100.0)


def test_who_is_near_counts_all_round_and_our_own_boxes_there_are_whole_ones(tracked: Path) -> None:
    """Nearer than 3 m, where the thermal camera's truth counts nobody."""
    rows = pq.read_table(tracked / "truth" / "panorama.parquet").to_pylist()
    assert all(row["is_counted"] and row["distance_m"] < 3.0 for row in rows)
    (on_floor,) = evaluate_runs([tracked])
    assert on_floor.scores.counts.targets == len(rows)
    (in_panorama,) = evaluate_runs([tracked], ScoreOptions(camera="panorama"))
    assert in_panorama.by == BoxReference("panorama", BoxKind.WHOLE)
    (asked,) = evaluate_runs([tracked], ScoreOptions(camera="panorama", boxes=BoxKind.TORSO))
    assert asked.by == BoxReference("panorama", BoxKind.TORSO)
    metrics = json.loads((tracked / "metrics.json").read_text(encoding="utf-8"))
    by_camera = to_json(in_panorama.scores) | {"latency": None}
    assert metrics["cameras"]["panorama"] | {"latency": None} == by_camera
    assert analyse_run(open_run(tracked)).due == 1


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")
def test_exports_say_the_truth_of_who_stands_across_the_seam(tracked: Path, tmp_path: Path) -> None:
    across = [
        (row["frame"], row)
        for row in pq.read_table(tracked / "truth" / "panorama.parquet").to_pylist()
        if row["visible_left_px"] is not None and row["visible_left_px"] + row["visible_width_px"] > 479.5
    ]
    assert across
    coco = COCO(export(tracked, "coco", tmp_path / "coco") / "annotations/panorama/person_keypoints.json")
    (video,) = coco.dataset["videos"]
    assert video["thermal_span_c"] is None
    told = PanoramaCalibration(**video["cameras"]["panorama"]["panorama"])
    assert told == Panorama().calibration
    thermal = json.loads((tmp_path / "coco/annotations/person_keypoints.json").read_text())["videos"][0]
    assert thermal["thermal_span_c"] == [24.0, 36.0]
    for frame, row in across:
        (image,) = (image for image in coco.imgs.values() if image["frame_id"] == frame)
        (label,) = (one for one in coco.anns.values() if one["image_id"] == image["id"])
        mask, (left, top, width, height) = coco.annToMask(label), label["bbox"]
        assert mask.sum() == label["area"] == row["visible_px"]
        assert (left, width) == (row["visible_left_px"] + 0.5, row["visible_width_px"])
        # Its first columns are seen again beyond the right border.
        wide = np.concatenate([mask, mask], axis=1)[:, int(left) : int(left + width)]
        assert wide.sum() == label["area"]
        assert wide.any(axis=0)[[0, -1]].all()
        assert int(top + height) <= mask.shape[0]

    out = ("--camera", "panorama", "--out")
    for form in ("mot", "viper"):
        assert run_cli("export", tracked, "--format", form, *out, tmp_path / form) == 0
    (told,), (given,) = (list((tmp_path / "mot").rglob(name)) for name in ("gt.txt", "data/*.txt"))
    for theirs, ours in ((told, "truth/panorama.gt.txt"), (given, "tracks/panorama.txt")):
        assert boxes_in(theirs) == {(k - 1) // 5 + 1: box for k, box in boxes_in(tracked / ours).items()}

    assert run_cli("export", tracked, "--format", "yolo-pose", "--least-px", 0, *out, tmp_path / "yolo") == 0
    for frame, row in across:
        file = tmp_path / "yolo" / "labels" / "all" / f"{tracked.name}_{(frame - 1) // 5 + 1:06d}.txt"
        labels = np.loadtxt(file, ndmin=2)
        middle, width = 480.0 * labels[:, 1], 480.0 * labels[:, 3]
        assert (middle + width / 2).max() == pytest.approx(480.0)
        assert (middle - width / 2).min() == pytest.approx(0.0, abs=1e-4)
        assert width.sum() == pytest.approx(row["visible_width_px"], abs=1e-4)
        flags = labels[:, 7::3] > 0
        assert flags.any(axis=1).all()
        assert flags.sum(axis=0).max() == 1  # each keypoint once

    for name, ours in (("truth", "truth/panorama.gt.txt"), ("tracks", "tracks/panorama.txt")):
        places = locations(tmp_path / "viper" / "run" / f"{name}.xgtf")
        for frame, (left, _, width, _) in boxes_in(tracked / ours).items():
            over = left + width - 479.5
            number = (frame - 1) // 5 + 1
            x, wide = places["LOCATION"][number]
            assert x == int(left + 0.5)
            assert (number in places["BEYOND_SEAM"]) == (over > 0.0)
            if over > 0.0:
                assert x + wide == 480
                assert places["BEYOND_SEAM"][number] == (0, math.ceil(over))


def locations(path: Path) -> dict[str, dict[int, tuple[int, int]]]:
    """Left column and width of the one object's boxes, by attribute and image."""
    found: dict[str, dict[int, tuple[int, int]]] = {}
    for thing in ElementTree.parse(path).getroot().iterfind(".//{*}object/{*}attribute"):
        found[thing.attrib["name"]] = {
            int(box.attrib["framespan"].split(":")[0]): (int(box.attrib["x"]), int(box.attrib["width"]))
            for box in thing
            if "x" in box.attrib
        }
    return found


@pytest.mark.slow
def test_pictures_show_the_tracks_that_its_tracker_gives(tracked: Path, tmp_path: Path) -> None:
    assert (
        run_cli("export", tracked, "--format", "mp4", "--camera", "panorama", "--out", tmp_path / "film") == 0
    )
    across = [k for k, (left, _, width, _) in boxes_in(tracked / "tracks/panorama.txt").items() if
              left + width > 479.5]  # fmt: skip
    with av.open(str(tmp_path / "film" / "run.mp4")) as film:
        frames = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]
    orange = np.array(track_colour(1))
    for number in ((k - 1) // 5 for k in across):
        picture = frames[number]
        is_orange = np.abs(picture - orange).max(axis=2) < 60
        columns = np.flatnonzero(is_orange[picture.shape[0] // 5 :].any(axis=0)) / picture.shape[1]
        assert columns.min() < 0.05
        assert columns.max() > 0.95


def test_its_recording_draws_what_the_tracker_sees_by(tracked: Path) -> None:
    told: dict[str, int] = {}
    labels = set()
    for chunk in RrdReader(tracked / "recording.rrd").stream():
        told[chunk.entity_path] = told.get(chunk.entity_path, 0) + (not chunk.is_static and chunk.num_rows)
        if chunk.entity_path == "/world/robot/places" and not chunk.is_static:
            labels |= {one for row in chunk.to_record_batch().column("Ellipsoids3D:labels").to_pylist()
                       for one in row or ()}  # fmt: skip
    explained = "/world/robot/panorama/explained"
    # Five images of the twelve are needed to know the empty scene.
    assert (told[f"{explained}/background"], told[f"{explained}/lines"]) == (1, 7)
    assert labels == {"1 · panorama"}
