"""A run that is watched for what was moved in it."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.cli import cli
from peopleboy.scenarios.finished_runs.run_frames import REPORTED_S, PersonPositions
from peopleboy.scenarios.finished_runs.run_scene_model import describe_change, true_events
from peopleboy.scenarios.finished_runs.true_events import PersonNames, TrueEvent, matching, thing_names
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.tracker.scene_model.scene import Change, Happening

SCENARIO = """
name: one_box
description: A box is taken away by somebody who comes for it.
duration_s: 8.0
place: {kind: room, length_m: 6.0, width_m: 6.0}
things:
  - kind: block
    name: box
    at_m: [3.6, 0.0]
    size_m: [0.3, 0.4, 0.5]
    actions: [{at_s: 3.5, kind: vanish, by: anna}]
people:
  - name: anna
    path:
      - {at_m: [4.4, 2.4]}
      - {at_m: [4.2, 0.1], speed_m_s: 1.0, pause_s: 1.6}
      - {at_m: [4.4, 2.4], speed_m_s: 1.2}
robot:
  at_m: [0.8, 0.0]
  cameras:
    depth: {kind: depth, preset: tof}
"""

GONE = Happening(time_s=3.5, known_s=6.0, change=Change.VANISHED, object=2, from_m=(2.8, 0.0, 0.25), person=1)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with images."""
    folder = tmp_path_factory.mktemp("watch")
    (folder / "one_box.yaml").write_text(SCENARIO)
    arguments = [
        "run",
        str(folder / "one_box.yaml"),
        "--frames",
        "--no-recording",
        "--out",
        str(folder / "run"),
    ]
    CliRunner().invoke(cli, arguments, catch_exceptions=False)
    return folder / "run"


def watch(*arguments: str) -> str:
    return CliRunner().invoke(cli, ["scene-model", *arguments], catch_exceptions=False).output


@pytest.mark.slow
def test_a_slower_camera_need_not_have_taken_an_image_when_something_happened(tmp_path: Path) -> None:
    scenario = (
        SCENARIO.replace("8.0", "4.0")
        .replace("3.5, kind: vanish, by: anna", "1.1, kind: vanish")
        .replace("tof}", "tof, rate_hz: 5}")
    )
    (tmp_path / "slower.yaml").write_text(scenario)
    arguments = [
        "run",
        str(tmp_path / "slower.yaml"),
        "--frames",
        "--no-recording",
        "--out",
        str(tmp_path / "run"),
    ]
    CliRunner().invoke(cli, arguments, catch_exceptions=False)
    watch(str(tmp_path / "run"))
    (vanished,) = true_events(open_run(tmp_path / "run"))
    assert (vanished.thing, vanished.from_m) == ("box", pytest.approx((3.6, 0.0)))


@pytest.mark.slow
def test_what_was_moved_is_told_by_names_and_left_in_files(run: Path) -> None:
    (line,) = [line for line in watch(str(run)).splitlines() if " s: " in line]
    assert line.endswith("s: anna took away box")
    scene = run / "scene"
    frames = [json.loads(line) for line in (scene / "scene.jsonl").read_text().splitlines()]
    assert len(frames) == 120
    assert sum(len(frame["persons"]) for frame in frames) > 30
    background = cv2.imread(str(scene / "background.png"), cv2.IMREAD_UNCHANGED)
    ever = cv2.imread(str(run / "truth" / "depth_ever.png"), cv2.IMREAD_UNCHANGED)
    assert background is not None
    assert ever is not None
    known = background > 0
    assert known.mean() > 0.97
    assert np.abs(background.astype(int) - ever)[known].mean() < 8.0
    head, rows = (scene / "static_map.ply").read_bytes().split(b"end_header\n", 1)
    assert head.startswith(b"ply\nformat binary_little_endian 1.0\nelement vertex ")
    points = np.frombuffer(rows, "<f4").reshape(-1, 6)
    on_floor = points[np.abs(points[:, 2]) < 0.02]
    assert np.median(on_floor[:, 5]) > 0.99  # up, to the camera
    assert (scene / "scene.rrd").stat().st_size > 1000


def test_bad_input_is_refused_in_a_line_and_leaves_nothing(run: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(run, tmp_path / "copy")
    (copy / "depth" / "000020.png").write_bytes(b"no image")
    with pytest.raises(BadInput, match=r"000020.png: cannot be read as an image"):
        watch(str(copy), "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()
    shutil.rmtree(copy / "depth")
    with pytest.raises(BadInput, match="has no images; run the scenario with --frames"):
        watch(str(copy))
    (tmp_path / "mine").mkdir()
    with pytest.raises(BadInput, match="is not replaced"):
        watch(str(run), "--out", str(tmp_path / "mine"))


def test_a_run_without_a_depth_camera_is_refused(run: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(run, tmp_path / "copy")
    text = (copy / "scenario.yaml").read_text()
    (copy / "scenario.yaml").write_text(text.replace("depth:", "deep:"))
    with pytest.raises(BadInput, match="the robot has no camera 'depth'"):
        watch(str(copy))


def test_sentences_have_names_where_they_are_known() -> None:
    assert describe_change(GONE) == "3.5 s: person 1 took away object 2"
    assert describe_change(GONE, {1: "anna"}.get, "box") == "3.5 s: anna took away box"


def test_a_happening_is_of_the_event_that_was_there_then() -> None:
    first = Pose2(0.8, 0.0, 0.0)
    event = TrueEvent(thing="box", by="anna", from_s=3.5, to_s=3.5, from_m=(3.6, 0.0))
    later = TrueEvent(thing="box", by="", from_s=13.5, to_s=13.5, from_m=(3.6, 0.0))
    aside = TrueEvent(thing="bag", by="", from_s=3.5, to_s=3.5, from_m=(3.6, 1.0))
    assert matching([GONE], [later, aside, event], first) == {0: (2,)}


def test_a_true_name_goes_to_what_matches_it_alone_and_only_once() -> None:
    first = Pose2(0.8, 0.0, 0.0)
    teddy = TrueEvent(thing="teddy", by="anna", from_s=5.0, to_s=7.4, from_m=(4.6, -0.8), to_m=(4.5, 0.3))
    fern = TrueEvent(thing="fern", by="", from_s=12.0, to_s=12.0, to_m=(6.0, 0.4))
    moved = Happening(
        time_s=5.4,
        known_s=10.9,
        change=Change.MOVED,
        object=1,
        from_m=(3.7, -0.8, 0.9),
        to_m=(3.6, 0.3, 0.2),
    )
    gone = replace(GONE, time_s=8.8, object=5, from_m=(3.375, -0.19, 1.06))
    taken = replace(GONE, time_s=12.0, object=6, from_m=(5.1, 0.4, 0.8))
    assert thing_names([gone, moved, taken], [teddy, fern], first) == {1: "teddy"}
    halves = [replace(GONE, time_s=5.4, object=k, from_m=(3.7 + 0.1 * k, -0.8, 0.9)) for k in range(3)]
    assert thing_names(halves, [teddy], first) == {1: "teddy"}


def test_what_vanishes_where_somebody_stood_was_no_thing() -> None:
    bodies = PersonPositions()
    bodies.look(2.0, [(2.8, 0.1)])
    bodies.look(3.0, [(2.8, 0.35)])
    assert bodies.explain(GONE)
    assert not bodies.explain(replace(GONE, time_s=4.5))
    bodies.look(3.0 + REPORTED_S, [])
    assert bodies.explain(GONE)  # which is told late
    assert not bodies.explain(replace(GONE, change=Change.APPEARED, from_m=None, to_m=GONE.from_m))
    bodies.look(200.0, [])
    assert not bodies.explain(GONE)  # forgotten, so that long runs take no more room


def test_who_is_who_is_told_by_most_instants() -> None:
    who = PersonNames()
    for place in ((1.0, 0.1), (1.0, 0.0), (1.0, 5.0)):
        who.look([(1, (1.0, 0.0))], [("anna", place), ("ben", (1.0, 0.5))])
    assert (who.name(1), who.name(2), who.name(None)) == ("anna", None, None)
