"""Inputs that once ended in a traceback, a hang, or without limits on time or memory."""

from __future__ import annotations

import copy
import errno
import gc
import json
import os
import pickle
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pybullet
import pytest
import yaml

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios import cli
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.recorded_drives import pack_drive, read_drive
from peopleboy.sim.physics.urdf import read_links, read_urdf
from peopleboy.tracker.footage.read_picture import read_picture
from peopleboy.tracker.tracker_names import with_detector
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.runs import toy_runs as toy

SCENE: dict[str, Any] = {
    "name": "x",
    "description": "x",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 5.0, "width_m": 5.0},
    "robot": {"at_m": [0.5, 0.0]},
}
LONG = "a" * 5000
LARGE = {"kind": "colour", "width_px": 4096, "height_px": 2048}
SCENES = {
    "empty doors": {"place": {**SCENE["place"], "doors": [{}] * 5000}},
    "many doors": {"place": {**SCENE["place"], "doors": [{"wall": "north", "along_m": 1.0}] * 101}},
    "long kind": {"things": [{"kind": LONG}]},
    "long key": {LONG: 1},
    "long camera": {"robot": {"at_m": [0.5, 0.0], "cameras": {LONG: {"kind": LONG}}}},
    "large cameras": {"robot": {"at_m": [0.5, 0.0], "cameras": {f"a{n}": LARGE for n in range(12)}}},
    "many cameras": {
        "robot": {"at_m": [0.5, 0.0], "cameras": {f"a{n}": {"kind": "colour"} for n in range(40)}}
    },
    "like a long name": {"like": LONG},
}


@pytest.mark.parametrize("changes", SCENES.values(), ids=SCENES)
def test_a_scenario_is_refused_soon_and_briefly(
    changes: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "x.yaml"
    path.write_text(yaml.safe_dump(SCENE | changes))
    began_s = time.process_time()
    line = refusal(capsys, "show", path)
    assert time.process_time() - began_s < 1.0
    assert len(line) < 500 + len(str(tmp_path))


def test_a_jitter_of_minus_zero_is_none(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    anna = {"name": "anna", "path": [{"at_m": [2.0, 0.0]}, {"at_m": [3.0, 0.0]}], "speed_jitter": -0.0}
    path.write_text(yaml.safe_dump(SCENE | {"people": [anna]}))
    assert load_scenario(path).people(0)


BOX = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
LINK = "<link name='{0}'>" + BOX + "</link>"
JOINT = "<joint name='{1}' type='fixed'><parent link='{0}'/><child link='{1}'/></joint>"
RINGS = {
    "itself": LINK.format("a") + JOINT.format("a", "a"),
    "two": LINK.format("a") + LINK.format("b") + JOINT.format("a", "b") + JOINT.format("b", "a"),
    "beside a root": "".join(map(LINK.format, "abc")) + JOINT.format("c", "b") + JOINT.format("b", "c"),
    "chain": "".join(JOINT.format(n, n + 1) for n in range(1000)) + LINK.format(1000),
}


@pytest.mark.parametrize("links", RINGS.values(), ids=RINGS)
def test_links_in_a_ring_or_an_endless_chain_are_refused(links: str, tmp_path: Path) -> None:
    path = tmp_path / "x.urdf"
    path.write_text(f"<robot name='r'>{links}</robot>")
    for read in (read_urdf, read_links):
        with pytest.raises(BadInput, match=r"x\.urdf cannot be read as a URDF: (links .* ring|more than)"):
            read(path)


@pytest.mark.parametrize("size", ["nan inf 0.5", "-1 -1 -1", "0 1 1", ""])
def test_a_urdf_with_impossible_sizes_is_refused(size: str, tmp_path: Path) -> None:
    shape = f'<collision><geometry><box size="{size}"/></geometry></collision>'
    (tmp_path / "x.urdf").write_text(f'<robot name="a"><link name="l">{shape}</link></robot>')
    path = tmp_path / "x.yaml"
    path.write_text(
        yaml.safe_dump(SCENE | {"things": [{"kind": "urdf", "urdf": "x.urdf", "at_m": [3.0, 1.0]}]})
    )
    with pytest.raises(BadInput, match=r"x\.urdf cannot be read as a URDF"):
        load_scenario(path)


CALLS = [
    ("show", "{}"),
    ("run", "{}"),
    ("evaluate", "{}"),
    ("evaluate", "--truth", "{}", "--tracks", "tracks.txt"),
    ("report", "{}"),
    ("export", "{}", "--format", "coco"),
    ("track", "{}", "--out", "o"),
    ("view", "{}"),
]


@pytest.mark.parametrize("call", CALLS, ids=" ".join)
def test_pipes_and_long_names_are_refused_before_they_are_read(
    call: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("f.yaml")
    for path in ("f.yaml", "/dev/zero", "/proc/kmsg", "\udcff", LONG, f"{LONG}.yaml"):
        assert len(refusal(capsys, *(word.format(path) for word in call))) < 500
    assert [path.name for path in tmp_path.iterdir()] == ["f.yaml"]


def test_a_run_may_be_in_a_folder_that_could_be_an_address(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a:b", "s3:/x/y"):
        assert run_cli("evaluate", toy.write_run(Path(name))) == 0


def test_a_picture_may_be_no_pipe(tmp_path: Path) -> None:
    path = tmp_path / "000001.png"
    os.mkfifo(path)
    with pytest.raises(BadInput, match="is a pipe or a device"):
        read_picture(path, [])


def test_a_file_of_detections_may_be_no_pipe(tmp_path: Path) -> None:
    path = tmp_path / "f.txt"
    os.mkfifo(path)
    with pytest.raises(BadInput, match="is a pipe or a device"):
        make_tracker(with_detector("detection", str(path)))


def test_text_without_end_and_links_in_a_ring_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    large, ring = tmp_path / "large.txt", tmp_path / "ring"
    with large.open("wb") as file:
        file.truncate(10**11)
    ring.symlink_to(ring)
    run = toy.write_run(tmp_path / "run")
    assert "at most" in refusal(capsys, "evaluate", "--truth", large, "--tracks", run / "tracks.txt")
    assert "at most" in refusal(capsys, "evaluate", "--truth", run / "truth/gt.txt", "--tracks", large)
    assert "cannot be a path" in refusal(capsys, "track", ring, "--out", tmp_path / "o")


def test_a_million_million_seeds_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert "from 1 to 100000" in refusal(capsys, "render", "crossing_2", "--seeds", 10**12)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EMFILE, errno.ENOENT, errno.EFBIG])
def test_a_fault_of_the_system_is_one_line(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(**_: object) -> None:
        raise OSError(number, os.strerror(number), "runs/x")

    monkeypatch.setattr(cli.cli, "main", fail)
    assert run_cli("list") == cli.FAILED
    assert capsys.readouterr().err.count("\n") == 1


ARGUMENTS: list[dict[str, Any]] = [
    {"physics_hz": 0},
    {"physics_hz": -240},
    {"physics_hz": 10**9},
    {"physics_hz": "x"},
    {"physics": np.zeros(2)},
    {"tracker": LONG},
    {"cameras": 1, "observation": "pixels"},
    {"tracker": []},
    {"task": np.zeros(2)},
    {"scenario": 3},
    {"scenario": LONG},
    {"max_episode_steps": "x"},
]


@pytest.mark.parametrize("arguments", ARGUMENTS, ids=str)
def test_wrong_arguments_of_an_environment_are_bad_input(arguments: dict[str, Any]) -> None:
    with pytest.raises(BadInput) as caught:
        PeopleBoyEnv(**arguments)
    assert len(str(caught.value)) < 500


def make_env(physics: str, observation: str = "truth") -> PeopleBoyEnv:
    return PeopleBoyEnv("single_follow", observation=observation, physics=physics)


def test_seeds_may_be_numpys_and_huge_actions_are_refused() -> None:
    env = make_env("kinematic")
    env.reset(seed=np.int64(3))  # type: ignore[arg-type]
    assert env.seed == 3
    for seed in (-1, 3.0, "x", True):
        with pytest.raises(BadInput, match="seed"):
            env.reset(seed=seed)  # type: ignore[arg-type]
    with pytest.raises(BadInput, match="actions"):
        env.step([10**400, 0])
    env.close()


def test_a_copy_in_an_episode_is_refused_with_bullet_and_right_without() -> None:
    env = make_env("bullet")
    env.reset(seed=0)
    for duplicate in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(BadInput, match="cannot be copied or pickled"):
            duplicate(env)
    env.close()


def pickled(env: PeopleBoyEnv) -> PeopleBoyEnv:
    twin = pickle.loads(pickle.dumps(env))
    assert isinstance(twin, PeopleBoyEnv)
    return twin


@pytest.mark.parametrize(
    ("observation", "duplicate"),
    [("truth", copy.copy), ("truth", copy.deepcopy), ("truth", pickled), ("tracks", copy.deepcopy)],
)
def test_a_copy_in_a_kinematic_episode_goes_on_by_itself(
    observation: str, duplicate: Callable[[PeopleBoyEnv], PeopleBoyEnv]
) -> None:
    env = make_env("kinematic", observation)
    env.reset(seed=0)
    twin = duplicate(env)
    theirs = [twin.step([1.0, 0.1])[0] for _ in range(3)][-1]
    ours = [env.step([1.0, 0.1])[0] for _ in range(3)][-1]
    assert all(np.array_equal(ours[name], theirs[name]) for name in ours)


def test_a_pickle_in_an_episode_with_images_is_refused() -> None:
    env = make_env("kinematic", "tracks")
    env.reset(seed=0)
    with pytest.raises(BadInput, match="cannot be pickled in an episode"):
        pickle.dumps(env)


def test_environments_that_are_dropped_or_fail_to_reset_free_their_worlds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def clients() -> int:
        return sum(pybullet.isConnected(number) for number in range(64))

    gc.collect()
    before = clients()
    for _ in range(3):
        env = make_env("bullet")
        env.reset(seed=0)
    monkeypatch.setattr(env, "_perceive", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        env.reset(seed=0)
    del env
    gc.collect()
    assert clients() == before


EVENT = '{{"frame": 1, "time_s": {}, "kind": {}, "who": "x"}}\n'
TAMPERED: dict[str, tuple[str, Callable[[Path], object]]] = {
    "short table": ("robot.parquet", lambda path: pq.write_table(pq.read_table(path).slice(0, 3), path)),
    "part of a box": ("tracks.parquet", lambda path: empty(path, "width_px")),
    "not UTF-8": ("metrics.json", lambda path: path.write_bytes(b"\xff\xfe{}")),
    "nested metrics": ("metrics.json", lambda path: path.write_text("[" * 100_000)),
    "kind of event": ("events.jsonl", lambda path: path.write_text(EVENT.format("0.0", "3"))),
    "time of event": ("events.jsonl", lambda path: path.write_text(EVENT.format('"x"', '"mode"'))),
    "nested event": ("events.jsonl", lambda path: path.write_text("[" * 100_000)),
    "nested run": ("run.json", lambda path: path.write_text("[" * 100_000)),
    "tracker": ("run.json", lambda path: tamper(path, "tracker", [])),
    "boxes": ("run.json", lambda path: tamper(path, "boxes", {"a": 1})),
}
"""What is wrong: the file, and how to make it so."""


def empty(path: Path, column: str) -> None:
    """Remove the values of a column of a table."""
    table = pq.read_table(path)
    at = table.column_names.index(column)
    pq.write_table(table.set_column(at, table.schema.field(at), pa.nulls(len(table), pa.float64())), path)


def tamper(path: Path, key: str, value: Any) -> None:
    """Change a value in a JSON file."""
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))


def test_a_table_whose_names_are_no_text_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = toy.write_run(tmp_path / "run") / "truth.parquet"
    content = path.read_bytes()
    path.write_bytes(content.replace(b"joints_m", b"join\xbes_m"))
    assert "truth.parquet" in refusal(capsys, "evaluate", tmp_path / "run")


def test_a_recorded_drive_without_a_value_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "drive.parquet"
    path.write_bytes(pack_drive([Command(linear_m_s=0.1, angular_rad_s=0.0)] * 2))
    table = pq.read_table(path)
    pq.write_table(table.set_column(0, table.schema.field(0), [[0.1, None]]), path)
    with pytest.raises(BadInput, match=r"drive\.parquet.* without a value"):
        read_drive(path)


@pytest.mark.parametrize(("name", "change"), TAMPERED.values(), ids=TAMPERED)
def test_a_run_whose_files_were_changed_is_refused(
    name: str, change: Callable[[Path], object], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = toy.write_run(tmp_path / "run")
    change(run / name)
    command = "report" if name in ("events.jsonl", "tracks.parquet") else "evaluate"
    assert name in refusal(capsys, command, run)
