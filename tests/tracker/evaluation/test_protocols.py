"""The files of benchmarks, scored as by TrackEval, which reads them itself."""

from pathlib import Path

import numpy as np
import pytest
from trackeval.datasets import Kitti2DBox, MotChallenge2DBox
from trackeval.metrics import CLEAR, HOTA, Identity

from peopleboy.scenarios.scores.evaluate_runs import evaluate_files
from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth
from peopleboy.tracker.evaluation.protocols import Protocol, recount
from tests.helpers.calls.refused import refused

FRAMES, SEEDS = 12, range(6)
TYPES = ("Pedestrian", "Pedestrian", "Pedestrian", "Person", "Car", "Cyclist", "Misc")


def scene(seed: int) -> tuple[np.random.Generator, np.ndarray]:
    """Return a generator, and people and things who walk, close together: rows of frame, id and box."""
    rng = np.random.default_rng(seed)
    frame, identity = (axis.ravel() for axis in np.mgrid[1 : FRAMES + 1, 1:15])
    start, pace = rng.uniform(0, 260, (15, 2)), rng.normal(0, 4, (15, 2))
    size = rng.uniform([18, 20], [40, 110], (15, 2))
    box = np.hstack([start[identity] + pace[identity] * frame[:, None], size[identity]])
    return rng, np.column_stack([frame, identity, box.round(2)])[rng.random(len(frame)) < 0.85]


def found_in(rng: np.random.Generator, rows: np.ndarray) -> np.ndarray:
    """Return what a tracker finds of the rows, with exchanged identities and boxes of nothing."""
    found = rows[rng.random(len(rows)) < 0.8].copy()
    found[:, 2:6] += rng.normal(0, 2.5, (len(found), 4)).round(2)
    late = found[:, 0] > FRAMES // 2
    found[late, 1] = (found[late, 1] % 14) + 1
    ghosts = rng.uniform([0, 0, 18, 10], [300, 300, 40, 90], (30, 4)).round(2)
    numbers = np.column_stack([rng.integers(1, FRAMES + 1, 30), np.arange(100, 130)])
    return np.vstack([found, np.hstack([numbers, ghosts])])


def written(path: Path, rows: list[list[object]], separator: str = ",") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    text = (separator.join(f"{v:g}" if isinstance(v, float) else str(v) for v in row) for row in rows)
    path.write_text("".join(f"{line}\n" for line in text))
    return path


def mot_sample(home: Path, benchmark: str, seed: int) -> tuple[Path, Path]:
    """Write a sequence with all classes, flags of 0 and people of visibility 0, and results."""
    rng, rows = scene(seed)
    truth = []
    kinds = rng.choice([1, 1, 1, 1, 2, 3, 4, 6, 7, 8, 9, 12, 13], 15)
    for row in rows.tolist():
        ends = [int(rng.random() < 0.9), int(kinds[int(row[1])]), float(rng.choice([0.0, 0.3, 1.0]))]
        if benchmark == "MOT15":
            ends = [ends[0], -1, -1, -1]
        if benchmark == "DanceTrack":
            ends = [1, 1, 1]
        truth.append([int(row[0]), int(row[1]), *row[2:], *ends])
    found = [[int(r[0]), int(r[1]), *r[2:], 0.9, -1, -1, -1] for r in found_in(rng, rows).tolist()]
    gt = written(home / "gt" / f"{benchmark}-train" / "one" / "gt" / "gt.txt", truth)
    return gt, written(home / "trackers" / f"{benchmark}-train" / "own" / "data" / "one.txt", found)


def kitti_sample(home: Path, seed: int) -> tuple[Path, Path]:
    """Write labels of all types, truncated, occluded and not annotated ones, and results of two types."""
    rng, rows = scene(seed)
    types, space = rng.choice(TYPES, 15), [-1] * 7

    def line(row: list[float], kind: str, *state: float) -> list[object]:
        frame, identity, left, top, width, height = row
        edges = (left, top, left + width, top + height)
        return [int(frame) - 1, int(identity), kind, *state, *edges, *space]

    truth = [
        line(row, types[int(row[1])], int(rng.random() < 0.15), int(rng.integers(0, 4)), 0.5)
        for row in rows.tolist()
    ]
    regions = [
        [frame, -1, left, 200.0, 90.0, 130.0] for frame in range(1, FRAMES + 1) for left in (0.0, 150.0)
    ]
    truth += [line(region, "DontCare", -1, -1, -10) for region in regions]
    kinds = ["Pedestrian", "Pedestrian", "Car"]
    found = [[*line(row, rng.choice(kinds), -1, -1, -10), 0.8] for row in found_in(rng, rows).tolist()]
    gt = written(home / "gt" / "label_02" / "0000.txt", truth, " ")
    (home / "gt" / "evaluate_tracking.seqmap.training").write_text(f"0000 empty 000000 {FRAMES:06d}\n")
    return gt, written(home / "trackers" / "own" / "data" / "0000.txt", found, " ")


def reference(data: MotChallenge2DBox | Kitti2DBox, sequence: str) -> dict[str, float]:
    raw = data.get_raw_seq_data("own", sequence)
    ready = data.get_preprocessed_seq_data(raw, "pedestrian")
    clear = CLEAR({"PRINT_CONFIG": False}).eval_sequence(ready)
    identity = Identity({"PRINT_CONFIG": False}).eval_sequence(ready)
    hota = HOTA().eval_sequence(ready)
    return {
        **{name: 100.0 * float(np.mean(hota[name])) for name in ("HOTA", "DetA", "AssA")},
        **{name: 100.0 * float(clear[name]) for name in ("MOTA", "MOTP")},
        **{name: 100.0 * float(identity[name]) for name in ("IDF1", "IDP", "IDR")},
        "FN": clear["CLR_FN"],
        "FP": clear["CLR_FP"],
        "IDSW": clear["IDSW"],
    }


def own(truth: Path, tracks: Path, protocol: Protocol | None = None) -> dict[str, float]:
    mot = evaluate_files(truth, tracks, FRAMES, protocol=protocol).mot
    return {
        "HOTA": mot.hota.hota,
        "DetA": mot.hota.deta,
        "AssA": mot.hota.assa,
        "MOTA": mot.clear.mota,
        "MOTP": mot.clear.motp,
        "IDF1": mot.identity.idf1,
        "IDP": mot.identity.idp,
        "IDR": mot.identity.idr,
        "FN": mot.clear.misses,
        "FP": mot.clear.false_positives,
        "IDSW": mot.clear.switches,
    }


@pytest.mark.parametrize("benchmark", ["MOT15", "MOT16", "MOT17", "MOT20", "DanceTrack"])
@pytest.mark.parametrize("seed", SEEDS)
def test_samples_of_motchallenge_are_scored_as_by_trackeval(tmp_path, benchmark, seed):
    truth, tracks = mot_sample(tmp_path, benchmark, seed)
    settings = {
        "GT_FOLDER": str(tmp_path / "gt" / f"{benchmark}-train"),
        "TRACKERS_FOLDER": str(tmp_path / "trackers" / f"{benchmark}-train"),
        "BENCHMARK": "MOT17" if benchmark == "DanceTrack" else benchmark,
        "SEQ_INFO": {"one": FRAMES},
        "SKIP_SPLIT_FOL": True,
        "PRINT_CONFIG": False,
    }
    assert own(truth, tracks) == pytest.approx(reference(MotChallenge2DBox(settings), "one"), abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_samples_of_kitti_are_scored_as_by_trackeval(tmp_path, seed):
    truth, tracks = kitti_sample(tmp_path, seed)
    settings = {
        "GT_FOLDER": str(tmp_path / "gt"),
        "TRACKERS_FOLDER": str(tmp_path / "trackers"),
        "PRINT_CONFIG": False,
    }
    theirs = reference(Kitti2DBox(settings), "0000")
    assert own(truth, tracks) == pytest.approx(theirs, abs=1e-9)


def test_the_protocols_differ_on_one_file_and_an_option_chooses(tmp_path):
    truth, tracks = mot_sample(tmp_path, "MOT17", 1)
    found = {each: own(truth, tracks, each)["HOTA"] for each in Protocol}
    assert found[Protocol.MOT17] == found[Protocol.MOT16] == found[Protocol.DANCETRACK]
    kinds = (Protocol.PEOPLEBOY, Protocol.MOT15, Protocol.MOT17, Protocol.MOT20)
    assert len({round(found[each], 6) for each in kinds}) == 4


def test_a_rendered_run_is_scored_by_another_protocol(tmp_path):
    path = written(tmp_path / "gt.txt", [[1, 1, 0, 0, 20, 60, 1, 1, 0], [1, 2, 90, 0, 20, 60, 0, 1, 1]])
    truth = read_truth(path)
    counted, around = recount(truth, Protocol.MOT17)
    assert (counted.id.tolist(), around.objects.id.tolist()) == ([1], [2])
    assert recount(truth, Protocol.PEOPLEBOY)[0].counted.tolist() == [True, False]


@pytest.mark.parametrize(
    "line",
    [
        "1,7,10,20,30,80",
        "1,7,10,20,30,80,0.9",
        "1,7,10,20,30,80,0.9,1",
        "1,7,10,20,30,80,0.9,-1,-1",
        "1,7,10,20,30,80,0.9,1,-1,-1,-1",
        "1,7,10,20,30,80,0.9,-1,-1,-1,",
        "1, 7, 10, 20, 30, 80, 0.9, -1, -1, -1",
        "1 7 10 20 30 80 0.9 -1 -1 -1",
        "1\t7\t10\t20\t30\t80\t0.9",
        "1;7;10;20;30;80;0.9;",
        "\ufeff1,7,10,20,30,80,0.9",
    ],
)
def test_results_of_every_width_and_separator_are_read(tmp_path, line):
    path = tmp_path / "tracks.txt"
    path.write_text(f"{line}\r\n", encoding="utf-8")
    tracks = read_tracks(path)
    assert (tracks.frame.tolist(), tracks.id.tolist()) == ([1], [7])
    assert tracks.box.tolist() == [[10, 20, 30, 80]]
    assert tracks.confidence[0] in (0.9, 1.0)


def test_results_of_other_classes_are_refused(tmp_path):
    path = tmp_path / "tracks.txt"
    path.write_text("1,7,10,20,30,80,0.9,1\n1,8,10,20,30,80,0.9,3\n")
    with refused(f"{path}:2", "class must be 1", "got 3"):
        read_tracks(path)
