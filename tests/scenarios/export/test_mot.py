from __future__ import annotations

import configparser
import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from trackers.eval import evaluate_mot_sequences
from trackeval.datasets import MotChallenge2DBox
from trackeval.metrics import CLEAR, HOTA, Identity

from peopleboy.scenarios.scores.evaluate_runs import evaluate_files
from peopleboy.tracker.evaluation.evaluate import Scores
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, export, make_run


@pytest.fixture(scope="module")
def thesis(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("thesis") / "tiny-3-thesis"
    return make_run(SCENE, folder, "--seed", 3, "--tracker", "thesis")


@pytest.fixture(scope="module")
def folder(crossing: Path, thesis: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("mot") / "set"
    assert run_cli("export", crossing, thesis, "--format", "mot", "--out", out) == 0
    return out


def dataset(folder: Path, capsys: pytest.CaptureFixture[str]) -> MotChallenge2DBox:
    settings = {
        "GT_FOLDER": str(folder / "gt" / "mot_challenge"),
        "TRACKERS_FOLDER": str(folder / "trackers" / "mot_challenge"),
        "BENCHMARK": "peopleboy",
        "SPLIT_TO_EVAL": "all",
        "PRINT_CONFIG": False,
    }
    found = MotChallenge2DBox(settings)
    capsys.readouterr()
    return found


def score(data: MotChallenge2DBox, tracker: str) -> dict[str, float]:
    raw = data.get_raw_seq_data(tracker, "tiny-3")
    ready = data.get_preprocessed_seq_data(raw, "pedestrian")
    clear = CLEAR({"PRINT_CONFIG": False}).eval_sequence(ready)
    identity = Identity({"PRINT_CONFIG": False}).eval_sequence(ready)
    hota = HOTA().eval_sequence(ready)
    return {
        "MOTA": clear["MOTA"],
        "TP": clear["CLR_TP"],
        "FN": clear["CLR_FN"],
        "FP": clear["CLR_FP"],
        "IDSW": clear["IDSW"],
        "IDF1": identity["IDF1"],
        "HOTA": float(np.mean(hota["HOTA"])),
    }


def own(scores: Scores) -> dict[str, float]:
    clear, identity, hota = scores.mot.clear, scores.mot.identity, scores.mot.hota
    return {
        "MOTA": clear.mota / 100.0,
        "TP": clear.matches,
        "FN": clear.targets - clear.matches,
        "FP": clear.candidates - clear.matches,
        "IDSW": clear.switches,
        "IDF1": identity.idf1 / 100.0,
        "HOTA": hota.hota / 100.0,
    }


@pytest.mark.slow
def test_trackeval_reads_the_folder_and_gives_our_own_scores(
    folder: Path, crossing: Path, thesis: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = dataset(folder, capsys)
    assert (data.seq_list, data.seq_lengths) == (["tiny-3"], {"tiny-3": 60})
    assert sorted(data.tracker_list) == ["detection", "thesis"]
    for tracker, run, found in (("detection", crossing, 20), ("thesis", thesis, 1)):
        ours = own(evaluate_files(run / "truth" / "gt.txt", run / "tracks.txt", 60))
        assert score(data, tracker) == pytest.approx(ours, abs=1e-9)
        assert ours["TP"] > found


def test_boxes_agree_with_the_table_and_people_who_do_not_count_are_distractors(
    folder: Path, crossing: Path
) -> None:
    path = folder / "gt" / "mot_challenge" / "peopleboy-all" / "tiny-3" / "gt" / "gt.txt"
    lines = {(int(row[0]), int(row[1])): row for row in np.loadtxt(path, delimiter=",")}
    rows = {(row["frame"], row["id"]): row for row in pq.read_table(crossing / "truth.parquet").to_pylist()}
    for key, line in lines.items():
        row = rows[key]
        box = [row[f"{edge}_px"] for edge in ("left", "top", "width", "height")]
        assert line[2:6] == pytest.approx(box, abs=0.01)
        is_judged = row["is_counted"] and row["visible_fraction"] > 0.0
        assert tuple(line[6:8]) == ((1, 1) if is_judged else (0, 8))
    assert {line[7] for line in lines.values()} == {1, 8}


def test_the_truth_has_boxes_round_whole_people_if_asked_and_folders_may_share_a_name(
    crossing: Path, thesis: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = shutil.copytree(thesis, tmp_path / crossing.name)  # as those of two sweeps do
    out = tmp_path / "mot"
    order = ("--format", "mot", "--boxes", "whole", "--out", out)
    assert run_cli("export", crossing, again, *order) == 0
    for told in capsys.readouterr().err.splitlines()[-2:]:
        assert_names(told, "note: boxes of", "enclose torsos", "--boxes torso")
    data = dataset(out, capsys)
    for tracker, run in (("detection", crossing), ("thesis", thesis)):
        assert run_cli("evaluate", run, "--boxes", "whole", "--json") == 0
        (figures,) = json.loads(capsys.readouterr().out)["trackers"].values()
        mot = figures["all_frames"]["mot"]
        found = score(data, tracker)
        assert [100.0 * found[key] for key in ("MOTA", "IDF1", "HOTA")] == pytest.approx(
            [mot[f"{key}_percent"] for key in ("MOTA", "IDF1", "HOTA")], abs=1e-6
        )


def test_the_sequence_says_its_length_and_holds_the_images(folder: Path, crossing: Path) -> None:
    sequence = folder / "gt" / "mot_challenge" / "peopleboy-all" / "tiny-3"
    told = configparser.ConfigParser()
    told.read(sequence / "seqinfo.ini")
    numbers = [told["Sequence"][key] for key in ("frameRate", "seqLength", "imWidth", "imHeight")]
    assert numbers == ["15", "60", "160", "120"]
    names = sorted(path.name for path in (sequence / told["Sequence"]["imDir"]).iterdir())
    assert names == [f"{frame:06d}{told['Sequence']['imExt']}" for frame in range(1, 61)]
    for name in names[::20]:
        image = cv2.imread(str(sequence / "img1" / name), cv2.IMREAD_UNCHANGED)
        assert np.array_equal(image, cv2.imread(str(crossing / "thermal" / name), cv2.IMREAD_UNCHANGED))


def test_the_package_trackers_reads_the_folder_too(folder: Path, crossing: Path) -> None:
    found = evaluate_mot_sequences(
        folder / "gt" / "mot_challenge" / "peopleboy-all",
        folder / "trackers" / "mot_challenge" / "peopleboy-all" / "detection" / "data",
        seqmap=folder / "gt" / "mot_challenge" / "seqmaps" / "peopleboy-all.txt",
        metrics=["CLEAR", "HOTA", "Identity"],
    ).sequences["tiny-3"]
    ours = own(evaluate_files(crossing / "truth" / "gt.txt", crossing / "tracks.txt", 60))
    # It knows no distractors: whoever finds one is charged with a false alarm.
    assert [ours[key] for key in ("TP", "FN", "IDSW")] == [
        found.CLEAR.CLR_TP,
        found.CLEAR.CLR_FN,
        found.CLEAR.IDSW,
    ]
    assert ours["FP"] <= found.CLEAR.CLR_FP


def test_a_second_run_of_the_same_seed_and_tracker_is_refused(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(crossing, tmp_path / "again")
    order = (crossing, tmp_path / "again", "--format", "mot", "--out", tmp_path / "mot")
    assert_names(refusal(capsys, "export", *order), tmp_path / "again", crossing)
    assert [path.name for path in tmp_path.iterdir()] == ["again"]


@pytest.mark.thorough
def test_trackers_that_have_not_seen_the_same_sequences_are_refused(
    thesis: Path, following: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = refusal(capsys, "export", thesis, following, "--format", "mot", "--out", tmp_path / "mot")
    assert_names(told, "tiny-3", "tracker detection")


def test_a_sequence_is_exported_without_its_frames_too(thesis: Path, folder: Path, tmp_path: Path) -> None:
    assert not (thesis / "thermal").exists()
    out = export(thesis, "mot", tmp_path / "mot")
    place = Path("gt") / "mot_challenge" / "peopleboy-all" / "tiny-3" / "img1" / "000060.png"
    assert (out / place).read_bytes() == (folder / place).read_bytes()
