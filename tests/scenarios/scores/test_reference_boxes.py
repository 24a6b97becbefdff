"""Boxes of others are held against the truth's of their own kind, in the images in which they are."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from peopleboy.registry import Entry
from peopleboy.scenarios.report.findings.run_findings import analyse_run, headline
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.scores.following_metrics import tracks_on_target
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import TRACKERS
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs import synthetic_ticks as made
from tests.helpers.runs.exported import SCENE, make_run

SLOW = {"kind": "colour", "width_px": 96, "height_px": 72, "rate_hz": 5}
SEEN: dict[str, Any] = SCENE | {
    "name": "seen",
    "duration_s": 1.0,
    "robot": SCENE["robot"] | {"cameras": {**SCENE["robot"]["cameras"], "low": SLOW}},
}
EDGES = ("whole_left_px", "whole_top_px", "whole_width_px", "whole_height_px")


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(SEEN, tmp_path_factory.mktemp("yardstick") / "seen", "--tracker", "truth")


def perfect(run: Path) -> Path:
    """Write results with the boxes of whole people, of everybody of whom something is seen."""
    rows = pq.read_table(run / "truth.parquet").to_pylist()
    lines = [
        f"{row['frame']},{row['id']},{','.join(f'{row[edge]:.2f}' for edge in EDGES)},1,-1,-1,-1\n"
        for row in rows
        if row["visible_px"]
    ]
    path = run.parent / "perfect.txt"
    path.write_text("".join(lines), encoding="utf-8")
    return path


def said(folder: Path, name: str = "metrics.json") -> dict[str, Any]:
    content: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return content


def figures(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    """What `evaluate` tells of one run."""
    capsys.readouterr()
    assert run_cli("evaluate", *arguments, "--json") == 0
    (tracker,) = json.loads(capsys.readouterr().out)["trackers"].values()
    (run,) = tracker["runs"]
    return dict(run)


def told_in_report(run: Path) -> str:
    return headline([analyse_run(open_run(run))])


@pytest.mark.slow
def test_perfect_boxes_of_whole_people_are_perfect_and_scored_so_again(
    seen: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = seen.parent / "whole"
    options = ("--name", "theirs", "--boxes", "whole", "--no-recording", "--out", out)
    assert run_cli("import-tracks", seen, perfect(seen), *options) == 0
    metrics = said(out)
    assert metrics["scored_by"] == {"camera": "thermal", "boxes": "whole"}
    assert said(out, "run.json")["boxes"] == "whole"
    assert metrics["mot"]["HOTA_percent"] > 99.9
    assert (out / "truth/gt.txt").read_bytes() == (seen / "truth/gt.txt").read_bytes()
    again = figures(capsys, out)
    assert (again["metrics"]["mot"], again["notes"]) == (metrics["mot"], [])
    as_torsos = figures(capsys, out, "--boxes", "torso")
    assert as_torsos["metrics"]["mot"]["HOTA_percent"] < 90.0
    (note,) = as_torsos["notes"]
    assert_names(note, "as wide as high", "--boxes whole")
    assert run_cli("evaluate", seen, out) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "truth against torsos in thermal images; theirs against whole people in thermal images" in told
    assert told_in_report(out) == told_in_report(seen)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["torso", "whole"])
def test_boxes_that_are_corners_are_said_to_be(
    kind: str, seen: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [line.split(",") for line in perfect(seen).read_text(encoding="utf-8").splitlines()]
    corners = seen.parent / "corners.txt"
    lines = []
    for frame, number, left, top, width, height, *rest in rows:
        right, bottom = float(left) + float(width), float(top) + float(height)
        lines.append(",".join([frame, number, left, top, f"{right:.2f}", f"{bottom:.2f}", *rest]))
    corners.write_text("\n".join(lines) + "\n", encoding="utf-8")
    out = seen.parent / f"corners_{kind}"
    options = ("--name", "theirs", "--boxes", kind, "--no-recording", "--out", out)
    assert run_cli("import-tracks", seen, corners, *options) == 0
    (note,) = figures(capsys, out)["notes"]
    assert_names(note, "not corners", "left, top, width and height")


def test_torsos_are_the_default_and_called_so_if_held_against_whole_people(
    seen: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert said(seen)["scored_by"] == {"camera": "thermal", "boxes": "torso"}
    assert said(seen, "run.json")["boxes"] == "torso"
    assert figures(capsys, seen)["notes"] == []
    (note,) = figures(capsys, seen, "--boxes", "whole")["notes"]
    assert_names(note, "--boxes torso")


@pytest.mark.slow
def test_boxes_where_nobody_is_are_of_no_kind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = make_run(SEEN | {"name": "empty", "people": []}, tmp_path / "empty", "--tracker", "truth")
    ghost = tmp_path / "ghost.txt"
    ghost.write_text("3,1,20,10,12,50,1,-1,-1,-1\n", encoding="utf-8")
    out = tmp_path / "haunted"
    assert run_cli("import-tracks", empty, ghost, "--name", "seer", "--no-recording", "--out", out) == 0
    assert figures(capsys, out)["notes"] == []


@pytest.mark.slow
def test_a_slow_camera_has_its_images_counted_as_in_an_export(
    seen: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    home = seen.parent
    assert run_cli("export", seen, "--format", "mot", "--camera", "low", "--out", home / "mot") == 0
    (exported,) = (home / "mot" / "gt").rglob("gt.txt")
    by_image, by_frame = (
        [f"{','.join(line.split(',')[:6])},1,-1,-1,-1" for line in path.read_text("utf-8").splitlines()]
        for path in (exported, seen / "truth" / "low.gt.txt")
    )
    theirs = home / "low.txt"
    theirs.write_text("".join(f"{line}\n" for line in by_image), encoding="utf-8")
    options = ("--name", "slow", "--camera", "low", "--no-recording", "--out", home / "slow")
    assert run_cli("import-tracks", seen, theirs, *options) == 0
    kept = (home / "slow" / "tracks" / "low.txt").read_text(encoding="utf-8").splitlines()
    assert [line.split(",")[:6] for line in kept] == [line.split(",")[:6] for line in by_frame]
    assert said(home / "slow")["mot"]["HOTA_percent"] == 100.0
    theirs.write_text("".join(f"{line}\n" for line in by_frame), encoding="utf-8")
    assert_names(
        refusal(capsys, "import-tracks", seen, theirs, *options, "--overwrite"), "image 5", "'low'", "got 13"
    )


class Colourist:
    """Knows where people are in the colour image."""

    cameras = ("colour",)
    rows: tuple[list[str], ...] = ()

    def __init__(self, _rng: np.random.Generator) -> None:
        self._frame = 0

    def update(self, _frame: Frame) -> tuple[Track, ...]:
        self._frame += 1
        return tuple(
            Track(
                id=int(number),
                boxes={"colour": (float(left), float(top), float(width), float(height))},
                confidence=1.0,
                status=Status.TRACKED,
                age_s=0.0,
            )
            for frame, number, left, top, width, height, *_ in self.rows
            if int(frame) == self._frame
        )


@pytest.mark.slow
def test_who_gives_boxes_in_another_image_alone_is_scored_there_and_told_so(
    seen: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (seen / "truth" / "colour.gt.txt").read_text(encoding="utf-8")
    monkeypatch.setattr(Colourist, "rows", tuple(line.split(",") for line in text.splitlines()))
    monkeypatch.setitem(TRACKERS.shipped, "colourist", Entry(Colourist))
    run = make_run(SEEN, seen.parent / "colour", "--tracker", "colourist")
    told = capsys.readouterr()
    assert "People were found in 100 % of" in told.out
    assert_names(told.err, "peopleboy: note: all boxes are in images of colour, and scored there")
    assert said(run)["scored_by"] == {"camera": "colour", "boxes": "torso"}
    again = figures(capsys, run)
    assert again["metrics"]["mot"] == said(run)["mot"]
    (note,) = figures(capsys, run, "--camera", "thermal")["notes"]
    assert_names(note, "images of colour", "--camera colour")
    assert told_in_report(run) == told_in_report(seen)
    assert run_cli("report", run, "--out", seen.parent / "colour.html") == 0
    assert "images of colour" in capsys.readouterr().err
    page = (seen.parent / "colour.html").read_text(encoding="utf-8")
    assert "scored against torsos in colour images" in page


def test_a_tracker_of_whole_people_is_seen_to_follow_the_right_one() -> None:
    tick = made.make_tick(1)
    person = next(person for person in tick.truth.people if person.id == 1)
    left, top, width, height = person.box or (0.0,) * 4
    wide = (left - width, top, 3.0 * width, height)
    people = tuple(replace(one, whole_box=wide) if one is person else one for one in tick.truth.people)
    truth = replace(tick.truth, people=people)
    track = replace(made.with_box(wide), id=7)
    tick = replace(tick, truths={"thermal": truth}, tracks=(track,), following=7)
    assert tracks_on_target(tick)[0] == 0
    assert tracks_on_target(tick, BoxKind.WHOLE) == (7, False)


def test_a_track_stays_on_a_person_on_whom_another_one_lies_better_for_a_moment() -> None:
    tick = made.make_tick(1)
    person = next(person for person in tick.truth.people if person.id == 1)
    left, top, width, height = person.box or (0.0,) * 4
    own, other = (
        replace(made.with_box((left + aside * width, top, width, height)), id=number)
        for number, aside in ((3, 0.2), (5, 0.1))
    )
    tick = replace(tick, tracks=(own, other))
    assert [tracks_on_target(tick, before=before)[0] for before in (0, 3, 5, 8)] == [5, 3, 5, 5]


def test_a_kind_of_boxes_is_asked_for_runs_of_scenarios_alone(
    seen: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = ("--truth", seen / "truth" / "gt.txt", "--tracks", seen / "tracks.txt")
    assert_names(refusal(capsys, "evaluate", *files, "--boxes", "whole"), "--boxes", "leave it out")
    spoilt = seen.parent / "spoilt"
    spoilt.mkdir()
    for path in seen.rglob("*"):
        if path.is_file():
            (spoilt / path.relative_to(seen)).parent.mkdir(parents=True, exist_ok=True)
            (spoilt / path.relative_to(seen)).write_bytes(path.read_bytes())
    (spoilt / "run.json").write_text(json.dumps(said(seen, "run.json") | {"boxes": "head"}), encoding="utf-8")
    assert_names(refusal(capsys, "evaluate", spoilt), "run.json", "torso or whole", "'head'")
    (spoilt / "truth.parquet").unlink()
    assert_names(refusal(capsys, "evaluate", spoilt, "--boxes", "whole"), "--boxes whole", "spoilt")
