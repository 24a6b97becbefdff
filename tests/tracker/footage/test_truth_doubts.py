import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.truth_doubts import doubts
from peopleboy.tracker.footage.truth_files import load_truth
from tests.helpers.calls.footage_calls import call
from tests.helpers.images.footage_files import box, walker

WIDTH, HEIGHT = 160, 120


def boxes(rows):
    table = np.array(rows, dtype=np.float64)
    ones = np.ones(len(table))
    frame = np.arange(len(table)) + 1
    return TrueBoxes(frame=frame, id=ones, box=table, counted=ones > 0, visible=ones)


def crossing(scale=1.0):
    return boxes([[scale * edge for edge in (x, 30.0, 20.0, 60.0)] for x in range(-10, 150, 4)])


def numbered(tmp_path: Path, first: int, count: int = 6) -> Path:
    clip = tmp_path / "clip"
    clip.mkdir()
    for frame in range(count):
        cv2.imwrite(str(clip / f"cam2_{first + frame:05d}.png"), walker(frame))
    return clip


def told(tmp_path, clip, frames):
    """Track with truth of these frames; give what notes say of it, and the frames it was written with."""
    truth, out = tmp_path / "truth.txt", tmp_path / "out"
    truth.write_text("".join(f"{f},4,{','.join(map(str, box(k)))},1,1,1\n" for k, f in enumerate(frames)))
    result = call(clip, "--out", out, "--truth", truth)
    assert result.exit_code == 0, result.output
    notes = [note for note in json.loads((out / "run.json").read_text())["notes"] if str(truth) in note]
    assert [line for line in result.stderr.splitlines() if str(truth) in line] == [
        f"peopleboy: note: {note}" for note in notes
    ]
    first_tracked = (out / "tracks.txt").read_text().split(",")[0]
    assert first_tracked in ("", *map(str, range(1, 7)))
    return notes, load_truth(out / "truth" / "gt.txt", None).truth.frame.tolist()


@pytest.mark.parametrize(
    ("first", "frames", "words", "taken"),
    [
        (1, range(1, 7), None, [1, 2, 3, 4, 5, 6]),
        (11, range(11, 17), "11 to 16", [1, 2, 3, 4, 5, 6]),
        (11, (13, 16), "11 to 16", [3, 6]),
        (11, range(1, 7), "first picture, which has number 11", [1, 2, 3, 4, 5, 6]),
        (3, (1, 2, 6), "first picture, which has number 3", [1, 2, 6]),
        (0, range(6), "0 to 5", [1, 2, 3, 4, 5, 6]),
        (0, range(1, 6), "first picture, which has number 0", [1, 2, 3, 4, 5]),
    ],
)
def test_frames_that_are_the_pictures_numbers_are_taken_so_and_it_is_said(
    tmp_path, first, frames, words, taken
):
    notes, found = told(tmp_path, numbered(tmp_path, first), frames)
    assert found == taken
    assert len(notes) == (words is not None)
    assert words is None or words in notes[0]


@pytest.mark.parametrize("scale", [1.5, 2.0, 4.0, 0.45, 0.3])
def test_boxes_of_pictures_of_another_size_raise_doubts(scale):
    (note,) = doubts(crossing(scale), WIDTH, HEIGHT)
    assert "160x120" in note
    assert "another size" in note


@pytest.mark.parametrize(
    "rows",
    [
        [],
        [[x, 30, 20, 60] for x in range(-19, 159, 3)],  # in at one side and out at the other
        [[60, 100 - y, 400, 40 * y] for y in range(1, 80)],  # comes so near that only the hair is seen
        [[-300, -200, 500, 900]],
        [[x, 10, 4, 12] for x in range(10, 30)],  # far away, in a corner
        [[x, 10, 4, 12] for x in range(10, 90)],  # and across the middle
    ],
)
def test_people_partly_outside_near_or_far_raise_none(rows):
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    assert doubts(boxes(table), WIDTH, HEIGHT) == []


def test_doubts_are_told_with_the_scores(tmp_path):
    clip = numbered(tmp_path, 1)
    truth = tmp_path / "large.txt"
    truth.write_text("".join(f"{f},4,{400 + f},90,40,200\n" for f in range(1, 7)))
    result = call(clip, "--out", tmp_path / "out", "--truth", truth)
    assert "note: truth: 100% of the boxes are outside" in result.stderr
