import errno
import hashlib
import json
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.scenarios.cli import main
from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.evaluate_runs import evaluate_files, evaluate_runs
from peopleboy.tracker.trackers import TRACKERS
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.some_of import some_of

SCENE = {
    "name": "tiny",
    "description": "One person crosses a room.",
    "duration_s": 2.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "people": [{"name": "anna", "path": [{"at_m": [4.5, -1.0]}, {"at_m": [4.5, 1.5], "speed_m_s": 1.2}]}],
    "robot": {
        "at_m": [0.6, 0.0],
        "cameras": {"thermal": {"kind": "thermal", "width_px": 160, "height_px": 120}},
    },
}
FOLDER = {
    "run.json", "scenario.yaml", "truth", "tracks.txt", "truth.parquet", "tracks.parquet", "robot.parquet",
    "events.jsonl", "metrics.json", "contact_sheet.png", "latency.txt",
}  # fmt: skip
FRAMES = {"thermal", "thermal16", "thermal_scene", "colour"}


def scene(**changes: object) -> dict[str, object]:
    return SCENE | changes


def write_scene(path: Path, **changes: object) -> Path:
    path.write_text(yaml.safe_dump(scene(**changes)), encoding="utf-8")
    return path


def digests(folder: Path) -> dict[str, str]:
    """Hash of everything whose bytes are promised: images, truth, tracks, scores and the scenario."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.suffix != ".rrd" and path.name != "latency.txt"
    }


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    path = write_scene(folder / "tiny.yaml")
    assert run_cli("run", path, "--out", folder / "one", "--seed", 5, "--frames") == 0
    return folder / "one"


@pytest.mark.slow
def test_a_run_leaves_the_whole_folder(finished: Path) -> None:
    assert {path.name for path in finished.iterdir()} == FOLDER | FRAMES | {"recording.rrd"}
    about = json.loads((finished / "run.json").read_text())
    assert (about["status"], about["frames"], about["seed"]) == ("complete", 30, 5)
    for name in FRAMES:
        assert len(list((finished / name).glob("*.png"))) == 30


def test_truth_in_text_and_table_agree(finished: Path) -> None:
    rows = pq.read_table(finished / "truth.parquet").to_pylist()
    lines = [line.split(",") for line in (finished / "truth" / "gt.txt").read_text().splitlines()]
    assert len(lines) == len(rows) == 30
    for row, line in zip(rows, lines, strict=True):
        assert int(line[0]) == row["frame"]
        assert float(line[2]) == pytest.approx(row["left_px"], abs=0.006)
        assert float(line[8]) == pytest.approx(row["visible_fraction"], abs=1e-4)
        shares = dict(row["hidden_by"])
        assert row["visible_fraction"] + sum(shares.values()) == pytest.approx(1.0)


def test_a_fresh_process_gives_the_same_bytes_and_another_seed_does_not(
    finished: Path, tmp_path: Path
) -> None:
    scenario = str(write_scene(tmp_path / "tiny.yaml"))
    same, other = (
        ["run", scenario, "--out", str(tmp_path / name), "--seed", seed, "--frames", "--no-recording"]
        for name, seed in (("same", "5"), ("other", "6"))
    )
    subprocess.run([sys.executable, "-m", "peopleboy", *same], check=True, capture_output=True, cwd=tmp_path)
    assert run_cli(*other) == 0
    first, same, other = digests(finished), digests(tmp_path / "same"), digests(tmp_path / "other")
    assert first == same
    assert first.keys() == other.keys()
    for name in ("thermal/000009.png", "colour/000009.png", "truth.parquet", "tracks.parquet"):
        assert first[name] != other[name]


def test_it_is_said_by_which_span_the_tracker_got_its_grey(finished: Path) -> None:
    about = json.loads((finished / "run.json").read_text(encoding="utf-8"))
    assert about["gains"] == {"thermal": {"gain": "fixed", "lowest_c": 24.0, "highest_c": 36.0}}


def test_the_resolved_scenario_gives_the_same_world_again(finished: Path, tmp_path: Path) -> None:
    assert run_cli("run", finished / "scenario.yaml", "--out", tmp_path / "again", "--no-recording") == 0
    again = digests(tmp_path / "again")
    assert {name: again[name] for name in ("truth/gt.txt", "tracks.txt")} == {
        name: digests(finished)[name] for name in ("truth/gt.txt", "tracks.txt")
    }


def test_evaluate_prints_the_same_scores_for_a_run_and_for_its_files(
    finished: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = ("--truth", finished / "truth" / "gt.txt", "--tracks", finished / "tracks.txt")
    assert run_cli("evaluate", *files) == 0
    alone = capsys.readouterr().out
    assert run_cli("evaluate", finished) == 0
    together = capsys.readouterr().out
    assert run_cli("evaluate", finished.parent) == 0
    assert capsys.readouterr().out == together
    for figure in ("CP", "AA", "HOTA"):
        value = next(line.split()[1] for line in alone.splitlines() if line.startswith(figure))
        assert next(line.split()[1] for line in together.splitlines() if line.startswith(figure)) == value


def test_people_of_whom_little_is_seen_can_be_left_out(tmp_path: Path) -> None:
    truth = "1,1,10,10,20,60,1,1,0.2000\n1,2,100,10,20,60,1,1,0.9000\n"
    (tmp_path / "gt.txt").write_text(truth)
    (tmp_path / "tracks.txt").write_text("1,1,100,10,20,60,0.9,-1,-1,-1\n")
    files = (tmp_path / "gt.txt", tmp_path / "tracks.txt")
    assert evaluate_files(*files).thesis.cr == pytest.approx(50.0)
    assert evaluate_files(*files, min_visible=0.3).thesis.cr == pytest.approx(100.0)
    assert run_cli("evaluate", "--truth", files[0], "--tracks", files[1], "--min-visible", "0.3") == 0
    assert run_cli("evaluate", "--truth", files[0], "--tracks", files[1], "--min-visible", "1.5") == 2


def test_nobody_is_a_sensible_run(tmp_path: Path) -> None:
    path = write_scene(tmp_path / "tiny.yaml", people=[], duration_s=0.4)
    assert run_cli("run", path, "--out", tmp_path / "run", "--no-recording") == 0
    assert (tmp_path / "run" / "truth" / "gt.txt").read_text() == ""


def test_a_run_whose_images_cannot_be_written_fails_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = Path.write_bytes

    def write_until_full(path: Path, content: bytes) -> int:
        if path.name.startswith("000003.png") and path.parent.name == "thermal16":
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", write_until_full)
    ticks: list[int] = []
    with refused("thermal16/000003.png", "cannot write this image"):
        run(
            parse_scenario(scene(), source="tiny", folder=tmp_path),
            RunOptions(seed=0, out=tmp_path / "run", frames=True, record=False),
            lambda tick, _: ticks.append(tick.frame),
        )
    assert len(ticks) < 30  # frames of the scenario
    about = json.loads((tmp_path / "run" / "run.json").read_text())
    assert about["status"] == "failed"
    assert "cannot write this image" in about["error"]["message"]


def test_an_interrupted_run_says_so_and_stays_readable(tmp_path: Path) -> None:
    scenario = parse_scenario(scene(), source="tiny", folder=tmp_path)

    def interrupt(tick: object, _frames: int) -> None:
        if getattr(tick, "frame", 0) == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(scenario, RunOptions(seed=0, out=tmp_path / "run", record=False), interrupt)
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "cut off"
    assert pq.read_table(tmp_path / "run" / "robot.parquet").num_rows == 7
    (people,) = evaluate_runs([tmp_path / "run"])
    assert people.notes == ("incomplete: 7 of 30 frames",)


KILLED = """
import os, signal, sys
from peopleboy.scenarios.cli import main
from peopleboy.scenarios.loop.tracker_by_name import OracleTracker
update = OracleTracker.update
def update_or_die(self, frame):
    if frame.time_s > 0.5:
        os.kill(os.getpid(), signal.SIGKILL)
    return update(self, frame)
OracleTracker.update = update_or_die
main(sys.argv[1:])
"""


@pytest.mark.slow
def test_a_killed_run_loses_at_most_the_frame_in_flight_and_can_be_scored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    killed, whole = tmp_path / "killed:1", tmp_path / "whole"
    call = ["run", "single_stationary", "--tracker", "truth", "--no-recording", "--frames", "--out"]
    done = subprocess.run([sys.executable, "-c", KILLED, *call, killed.name], check=False, cwd=tmp_path)
    assert done.returncode == -signal.SIGKILL
    assert json.loads((killed / "run.json").read_text())["status"] == "running"
    with pytest.raises(SystemExit, match="0"):
        main(["evaluate", str(killed)])
    frames = json.loads((killed / "run.json").read_text())["frames"]
    assert frames in (7, 8)  # of the 8 up to 0.5 s, as the last one's images were being written
    assert f"incomplete: {frames} of 600 frames" in capsys.readouterr().err
    options = RunOptions(seed=0, out=whole, tracker="truth", frames=True, record=False)
    run(load_scenario("single_stationary").lasting(1.0), options)
    for name in ("truth", "tracks", "robot"):
        rows = pq.read_table(whole / f"{name}.parquet").to_pylist()
        expected = repr([row for row in rows if row["frame"] <= frames])
        assert repr(pq.read_table(killed / f"{name}.parquet").to_pylist()) == expected
    for text in ("truth/gt.txt", "truth/colour.gt.txt", "tracks.txt"):
        lines = (whole / text).read_text().splitlines()
        expected = [line for line in lines if int(line.partition(",")[0]) <= frames]
        assert (killed / text).read_text().splitlines() == expected
    images = sorted((killed / "colour").iterdir())
    assert [path.read_bytes() for path in images] == [
        (whole / "colour" / path.name).read_bytes() for path in images
    ]
    assert len(images) == frames
    assert not [path for path in killed.rglob("*") if path.suffix in (".log", ".part")]
    assert open_run(killed).events


def test_a_run_that_goes_on_is_not_taken_for_one_that_was_killed(tmp_path: Path) -> None:
    scenario = parse_scenario(scene(), source="tiny", folder=tmp_path)

    def read_at_once(tick: Tick, _frames: int) -> None:
        if tick.frame == 3:
            with refused("still going on"):
                evaluate_runs([tmp_path / "run"])

    run(scenario, RunOptions(seed=0, out=tmp_path / "run", record=False), read_at_once)


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(["SIGTERM", "SIGHUP"], 2))
def test_a_run_ended_by_a_signal_says_so_and_is_no_failure_of_its_tracker(tmp_path: Path, name: str) -> None:
    script = (
        "import os, signal, sys; from peopleboy.scenarios.cli import main\n"
        "import peopleboy.scenarios.loop.tracker_by_name as oracle\n"
        f"signal.signal(signal.{name}, signal.SIG_DFL)\n"  # under nohup, SIGHUP would be ignored
        f"oracle.OracleTracker.update = lambda *_: os.kill(os.getpid(), signal.{name})\n"
        "main(sys.argv[1:])"
    )
    call = [
        "run",
        "single_stationary",
        "--tracker",
        "truth",
        "--no-recording",
        "--out",
        str(tmp_path / "run"),
    ]
    done = subprocess.run([sys.executable, "-c", script, *call], check=False)
    assert done.returncode == 128 + signal.Signals[name]
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "cut off"


MISTAKES = {
    "misspelt key": ({"duration": 3.0}, "duration_s"),
    "NaN": ({"duration_s": float("nan")}, "duration_s"),
    "negative speed": (
        {"people": [{"name": "anna", "path": [{"at_m": [4, 0]}, {"at_m": [5, 0], "speed_m_s": -1.0}]}]},
        "people[0].path[1].speed_m_s",
    ),
    "waypoint in a wall": (
        {"people": [{"name": "anna", "path": [{"at_m": [4, 0]}, {"at_m": [4, 3.02]}]}]},
        "people[0].path[1]",
    ),
    "unknown garment": (
        {"people": [{"name": "anna", "clothes": {"top": "t_shrit"}, "path": [{"at_m": [4, 0]}]}]},
        "t_shirt",
    ),
    "one name for two": (
        {"people": [{"name": "anna", "path": [{"at_m": [4, y]}]} for y in (0, 1)]},
        "anna",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_the_file_is_one_line_and_leaves_nothing(
    mistake: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changes, clue = MISTAKES[mistake]
    path = write_scene(tmp_path / "tiny.yaml", **changes)
    assert_names(refusal(capsys, "run", path, "--out", tmp_path / "run"), path, clue)
    assert not (tmp_path / "run").exists()


def test_help_names_every_tracker(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("run", "--help") == 0
    text = "".join(capsys.readouterr().out.split())  # long names may be broken at their hyphens
    assert [name for name in (*TRACKERS, "truth") if name not in text] == []


def test_no_command_prints_the_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli() == 2
    assert "  sweep  " in capsys.readouterr().out


def test_another_tracker_has_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = write_scene(tmp_path / "tiny.yaml", duration_s=0.2)
    for tracker in ("detection", "paper"):
        assert run_cli("run", path, "--tracker", tracker, "--no-recording") == 0
    assert {folder.name for folder in (tmp_path / "runs").iterdir()} == {"tiny-0", "tiny-0-paper"}


@pytest.mark.parametrize(
    ("arguments", "clue"),
    [
        (("run", "no_such_scene"), "peopleboy list"),
        (("run", "missing.yaml"), "missing.yaml"),
        (("run", "empty_room", "--tracker", "best"), "contour"),
        (("run", "empty_room", "--renderer", "opengl"), "raycast"),
        (("run", "empty_room", "--seed", "-1"), "seed"),
        (("run", "empty_room", "--sed", "1"), "--sed"),
        (("run", "empty_room", "--out", "/dev/null/run"), "/dev/null/run"),
        (("evaluate", "--truth", "gt.txt"), "--tracks"),
        (("evaluate",), "--truth"),
        (("evaluate", "no_run"), "no_run"),
        (("show", "dataset1"), "dataset1"),
        (("run", "dataset1", "--seed", "1"), "--seed 1"),
        (("view", "no_run"), "no_run"),
        (("show", "empty_room", "--out", "/dev/null/plan.png"), "/dev/null/plan.png"),
    ],
)
def test_a_mistake_on_the_command_line_is_one_line_and_exit_code_2(
    arguments: tuple[str, ...],
    clue: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert_names(refusal(capsys, *arguments), clue)
    assert not list(tmp_path.iterdir())


def test_an_earlier_run_is_replaced_only_when_asked_and_other_folders_never(
    finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario = write_scene(tmp_path / "tiny.yaml", duration_s=0.2)
    keep = tmp_path / "mine"
    keep.mkdir()
    (keep / "thesis.txt").write_text("do not lose me")
    assert_names(refusal(capsys, "run", scenario, "--out", finished), finished, "--overwrite")
    assert_names(refusal(capsys, "run", scenario, "--out", keep, "--overwrite"), keep)
    assert (keep / "thesis.txt").exists()
    out = tmp_path / "run"
    assert run_cli("run", scenario, "--out", out, "--no-recording") == 0
    assert run_cli("run", scenario, "--out", out, "--no-recording", "--overwrite", "--seed", 1) == 0
    assert json.loads((out / "run.json").read_text())["seed"] == 1


@pytest.mark.parametrize("name", some_of(sorted(path.stem for path in LIBRARY.glob("*.yaml")), 16))
def test_every_library_scenario_runs_a_little(name: str, tmp_path: Path) -> None:
    loaded = load_scenario(name)
    short = replace(loaded, spec=replace(loaded.spec, duration_s=0.2))
    run(short, RunOptions(seed=1, out=tmp_path / name, record=False), lambda _tick, _frames: None)
    assert (tmp_path / name / "contact_sheet.png").stat().st_size > 10_000


def test_a_sweep_with_images_adds_them_to_runs_without(tmp_path: Path) -> None:
    scenario, out = write_scene(tmp_path / "tiny.yaml", duration_s=0.2), tmp_path / "runs"
    for options in ((), ("--frames",)):
        assert run_cli("sweep", scenario, "--workers", 1, "--seeds", 2, "--out", out, *options) == 0
        counts = [len(list((out / f"tiny-{seed}" / "thermal").glob("*.png"))) for seed in (0, 1)]
        assert counts == [3 * bool(options)] * 2


@pytest.mark.slow
def test_a_sweep_goes_on_where_it_was_and_takes_no_other_run_for_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario = write_scene(tmp_path / "tiny.yaml", duration_s=0.2)
    out = tmp_path / "runs"
    assert run_cli("sweep", scenario, "--workers", 1, "--seeds", 1, "--out", out) == 0
    stamp = (out / "tiny-0" / "run.json").stat().st_mtime_ns
    assert run_cli("sweep", scenario, "--workers", 1, "--seeds", 2, "--out", out) == 0
    assert (out / "tiny-0" / "run.json").stat().st_mtime_ns == stamp
    for folder in out.iterdir():
        about = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps(about | {"status": "running"}))
    assert run_cli("sweep", scenario, "--workers", 1, "--seeds", 2, "--out", out) == 0
    assert (out / "tiny-0" / "run.json").stat().st_mtime_ns != stamp
    write_scene(tmp_path / "tiny.yaml", duration_s=0.4)
    assert_names(
        refusal(capsys, "sweep", scenario, "--workers", 1, "--seeds", 2, "--out", out), out / "tiny-0"
    )
