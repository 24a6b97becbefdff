from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.peers.compete import FilmTask
from benchmarks.peers.detectors import Blobs, Oracle, _from_colour
from benchmarks.peers.show import write_results
from benchmarks.results.measured import take_in
from benchmarks.results.tables import read_tables
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame


def no_news(part: int) -> None:
    """Nobody looks on."""


def frame(thermal: np.ndarray) -> Frame:
    return Frame(images={THERMAL: thermal}, time_s=0.0)


def test_blobs_find_a_warm_upright_region_and_leave_a_flat_one() -> None:
    image = np.zeros((240, 320), dtype=np.uint8)
    image[60:160, 100:130] = 120
    image[20:30, 200:300] = 255
    found = Blobs().detect(frame(image))
    assert found.box == pytest.approx(np.array([[115.0 - 13.5, 60.0, 27.0, 100.0]]))


def test_the_oracle_gives_each_frame_who_is_seen_well_enough() -> None:
    truth = TrueBoxes(
        frame=np.array([1, 1, 2]),
        id=np.array([1, 2, 1]),
        box=np.array([[0.0, 0, 10, 30], [50.0, 0, 10, 30], [2.0, 0, 10, 30]]),
        counted=np.ones(3, dtype=np.bool_),
        visible=np.array([1.0, 0.2, 0.9]),
    )
    oracle = Oracle(truth)
    blank = frame(np.zeros((240, 320), dtype=np.uint8))
    assert [oracle.detect(blank).box[:, 0].tolist() for _ in range(3)] == [[0.0], [2.0], []]


def test_boxes_of_the_colour_image_shrink_by_its_zoom_when_they_move_to_the_thermal_one() -> None:
    image = frame(np.zeros((240, 320), dtype=np.uint8))
    (box,) = _from_colour(np.array([[148.0, 108.0, 24.0, 24.0]]), (240, 320, 3), image)
    assert box[2:] == pytest.approx([20.0, 20.0])
    assert box[1] + 10.0 == pytest.approx(120.0)  # the middle row stays the middle row


def test_results_are_kept_and_the_oracle_is_right_about_everybody_it_tracks(tmp_path: Path) -> None:
    first = FilmTask(("oracle+bytetrack", "blobs+sort"), "crossing_2", 1, tmp_path)(no_news)
    again = FilmTask(("oracle+bytetrack", "blobs+sort"), "crossing_2", 1, tmp_path)(no_news)
    assert [run.ms for run in first] == [run.ms for run in again]
    assert first[0].scores.thesis.cp == 100.0
    assert first[0].scores.thesis.cr > first[1].scores.thesis.cr
    assert len(first[0].occlusions) > 0


def test_what_is_kept_of_the_peers_can_be_taken_into_the_tables_of_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("runs/peers").mkdir(parents=True)
    runs = FilmTask(("oracle+bytetrack",), "crossing_2", 1, tmp_path)(no_news)
    write_results({"oracle+bytetrack": runs}, Path("runs/peers/results.json"))
    kept = json.loads(Path("runs/peers/results.json").read_text())["oracle+bytetrack"]["kept"]["all"]
    tracked = [o for o in runs[0].occlusions if o.id_before is not None]
    assert kept == {"share": np.mean([o.is_kept for o in tracked]), "occlusions": len(tracked)}
    tables = read_tables().tables
    for name in ("peers", "identity"):
        row = next(row for row in tables[name].rows if row.measured.endswith("oracle+bytetrack"))
        taken = take_in(tables[name].model_copy(update={"rows": (row.model_copy(update={"runs": 1}),)}))
        assert None not in taken.rows[0].figures
