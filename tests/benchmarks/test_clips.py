from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner, Result

from benchmarks.footage.__main__ import main
from benchmarks.footage.altered_clips import ALTERATIONS, alter, altered_name
from benchmarks.footage.compare_clips import OUT, change_of_hota, clip_metrics
from benchmarks.footage.real_clips import ClipResult, open_clips, score_clip
from benchmarks.footage.real_training import annotated_images
from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.footage.false_colours import FalseColours
from peopleboy.tracker.footage.image_sequences import open_footage
from tests.helpers.calls.refused import assert_names, refused

FRAMES = 12
WALKER, BICYCLE = (50.0, 23.0, 31.82, 74.0), (110.0, 30.0, 30.1, 70.0)


def write_clip(folder: Path, *, single: bool = False) -> Path:
    """A person who walks, and a bicycle; of a single one, only the walker is annotated."""
    pictures = folder / ("img" if single else "thermal")
    pictures.mkdir(parents=True)
    lines = []
    for frame in range(1, FRAMES + 1):
        image, x = np.full((120, 160), 60, np.uint8), 65 + frame
        cv2.ellipse(image, (x, 30), (5, 7), 0, 0, 360, 180, cv2.FILLED)
        cv2.ellipse(image, (x, 55), (11, 20), 0, 0, 360, 180, cv2.FILLED)
        cv2.rectangle(image, (x - 8, 60), (x + 8, 96), 180, cv2.FILLED)
        cv2.imwrite(str(pictures / f"{frame:06d}.jpg"), image)
        boxes = [",".join(map(str, (one[0] + frame, *one[1:]))) for one in (WALKER, BICYCLE)]
        lines += (
            [f"{boxes[0]}\n"]
            if single
            else [f"{frame},1,{boxes[0]},1,1,1\n", f"{frame},2,{boxes[1]},0,3,1\n"]
        )
    name = "groundtruth_rect.txt" if single else "gt.txt"
    (folder / name).write_text("".join(lines), encoding="utf-8")
    return folder


def said(*people: tuple[float, float, float, float]) -> list[tuple[int, int, np.ndarray]]:
    """Tracks that follow these boxes as the truth does."""
    return [
        (frame, number, np.array([box[0] + frame, *box[1:]]))
        for frame in range(1, FRAMES + 1)
        for number, box in enumerate(people, 1)
    ]


def result(scores: Scores, *boxes: tuple[float, float, float, float]) -> ClipResult:
    """A result with these detections in every frame."""
    rows = [(frame, number, box, 1.0 / number) for frame, number, box in said(*boxes)]
    return ClipResult(scores, 0.1, TrackBoxes.from_rows(rows))


def call(*arguments: object) -> Result:
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_a_bicycle_is_neither_hit_nor_miss(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    (clip,) = open_clips(tmp_path)
    for people in ((WALKER,), (WALKER, BICYCLE)):
        figures = clip_metrics(clip, [result(score_clip(clip, said(*people)))])
        assert (figures["HOTA"], figures["CP"], figures["CR"]) == pytest.approx(
            (100.0, 100.0, 100.0), abs=0.1
        )
        assert figures["false tracks per 1000"] == 0.0
        assert figures["frames per s"] == pytest.approx(10.0)


def test_precision_is_of_the_detections_and_by_size(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    (clip,) = open_clips(tmp_path)
    beside = (0.0, 0.0, 10.0, 20.0)
    found = result(score_clip(clip, said(WALKER)), beside, WALKER, BICYCLE)
    figures = clip_metrics(clip, [found])
    assert figures["AP50"] == figures["AP"] == pytest.approx(50.0)  # nothing is said of the bicycle
    assert figures["AP50 medium"] == 100.0
    assert np.isnan([figures["AP50 small"], figures["AP50 large"]]).all()


def test_a_track_on_nobody_is_false_and_counted_per_thousand_frames(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    (clip,) = open_clips(tmp_path)
    scores = score_clip(clip, said(WALKER, (0.0, 0.0, 10.0, 20.0)))
    metrics = clip_metrics(clip, [result(scores), result(scores)])
    assert metrics["false tracks per 1000"] == pytest.approx(1000.0 / FRAMES)
    assert metrics["CP"] == pytest.approx(50.0)


def test_of_a_clip_with_one_person_annotated_nothing_is_said_of_other_boxes(tmp_path: Path) -> None:
    write_clip(tmp_path / "airfield", single=True)
    (clip,) = open_clips(tmp_path)
    figures = clip_metrics(clip, [result(score_clip(clip, said(WALKER, BICYCLE)))])
    assert figures["one id"] == 100.0
    assert np.isnan([figures[name] for name in ("HOTA", "IDF1", "MOTA", "CP", "false tracks per 1000")]).all()


def test_clips_by_which_values_are_chosen_come_first_and_the_first_frames_alone_count(tmp_path: Path) -> None:
    for name in ("aaa", "camel_21"):
        write_clip(tmp_path / name)
    clips = open_clips(tmp_path, frames=5)
    assert [clip.name for clip in clips] == ["camel_21", "aaa"]
    assert [(clip.frames, clip.given.truth.last_frame) for clip in clips] == [(5, 5), (5, 5)]


@pytest.mark.slow
def test_clips_are_printed_as_one_table_and_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_clip(tmp_path / "clips" / "camel_21")
    write_clip(tmp_path / "clips" / "airfield", single=True)
    write_clip(tmp_path / "clips" / "left_out")
    which = ("--only", "camel_21", "--only", "airfield", "--peer", "HOG x 2 + ByteTrack")
    told = call("--clips", "clips", *which, "--frames", 6, "--seeds", 2)
    assert told.exit_code == 0, told.output
    rows = [line for line in told.stdout.splitlines() if line.startswith("| ")]
    assert [row.split(" | ")[:3] for row in rows[2:]] == [
        ["| camel_21", "6", "detection"],
        ["| camel_21", "6", "HOG x 2 + ByteTrack"],
        ["| airfield", "6", "detection"],
        ["| airfield", "6", "HOG x 2 + ByteTrack"],
    ]
    assert "used for tuning: camel_21\n" in told.stdout
    assert "not used for tuning: airfield\n" in told.stdout
    kept = json.loads(OUT.read_text(encoding="utf-8"))
    assert kept["camel_21"]["detection"]["runs"] == 2
    assert kept["airfield"]["detection"]["HOTA"] is None


def test_a_clip_or_tracker_that_there_is_not_is_refused(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    with refused(tmp_path, "square", "street"):
        open_clips(tmp_path, ["square"])
    for tracker, word in (("nobodys", "nobodys"), ("rgbd", "depth")):
        told = call("--clips", tmp_path, "--tracker", tracker)
        assert isinstance(told.exception, BadInput)
        assert_names(str(told.exception), word)


@pytest.mark.parametrize("name", ALTERATIONS)
def test_truth_moves_with_altered_pictures(name: str, tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    (clip,) = open_clips(tmp_path)
    altered = alter(clip, name, tmp_path / "altered")
    pictures = list(open_footage(altered.folder))
    assert len(pictures) == altered.frames == (FRAMES // 2 if name == "half rate" else FRAMES)
    walker = altered.given.truth.take(altered.given.truth.id == 1)
    assert walker.frame.tolist() == list(range(1, altered.frames + 1))
    grey = FalseColours().grey(pictures[0], [])
    left, top, width, height = np.round(walker.box[0]).astype(int)
    inside = np.median(grey[top : top + height, left + 8 : left + width - 8])
    around = np.median(grey[grey.shape[0] // 4 : -grey.shape[0] // 4, :20])
    assert (inside > around) == (name != "black-hot")


def test_change_of_hota_is_a_mean_over_clips_that_have_one() -> None:
    metrics = {
        ("a", "t"): {"HOTA": 60.0},
        ("b", "t"): {"HOTA": 50.0},
        ("c", "t"): {"HOTA": np.nan},
        (altered_name("a", "ironbow"), "t"): {"HOTA": 59.0},
        (altered_name("b", "ironbow"), "t"): {"HOTA": 46.0},
        (altered_name("c", "ironbow"), "t"): {"HOTA": np.nan},
    }
    assert change_of_hota(metrics, "t", ["a", "b", "c"], "ironbow") == -2.5
    assert change_of_hota(metrics, "t", ["c"], "ironbow") is None


def test_images_to_train_on_have_the_annotated_people_without_margins(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    (clip,) = open_clips(tmp_path)
    images = list(annotated_images(clip, 4))
    assert len(images) == 4
    for number, image in zip((3, 6, 9, 12), images, strict=True):
        left, top, width, height = WALKER
        assert image.grey.shape == (120, 160)
        (whole,), (torso,) = image.whole, image.box  # of the bicycle, nothing is known
        tall = height / 1.04
        np.testing.assert_allclose(
            whole, (left + number + 0.04 * tall - 0.5, top + 0.01 * tall - 0.5, width - 0.08 * tall, tall)
        )
        assert torso[0] + torso[2] / 2.0 == pytest.approx(whole[0] + whole[2] / 2.0)
        np.testing.assert_allclose(torso[[1, 3]], whole[[1, 3]])


def test_training_on_other_clips_needs_other_clips(tmp_path: Path) -> None:
    write_clip(tmp_path / "street")
    write_clip(tmp_path / "alone", single=True)
    failed = call("--clips", tmp_path, "--peer", "none", "--real-training").exception
    assert isinstance(failed, BadInput)
    assert_names(str(failed), "two or more clips", "got 1")
