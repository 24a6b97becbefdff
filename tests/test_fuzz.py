"""Random inputs: whatever users write is accepted, or refused soon and in one line."""

from __future__ import annotations

import io
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from datetime import timedelta
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.sim.physics.urdf import read_urdf
from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth
from peopleboy.tracker.footage.footage_truth import load_truth
from peopleboy.tracker.footage.read_picture import read_pages, read_picture
from peopleboy.tracker.networks.weights_archive import ArraySpec, WeightsArchive
from tests.helpers.calls.command_line import run_cli
from tests.helpers.runs import toy_runs as toy

fuzzed = settings(
    max_examples=int(os.environ.get("FUZZ_EXAMPLES", "30")),
    deadline=timedelta(seconds=60),
    derandomize="FUZZ_EXAMPLES" not in os.environ,
    suppress_health_check=list(HealthCheck),
    database=None,
)
MODELS = sorted(LIBRARY.glob("*.yaml"))
ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**20), 10**20),
    st.floats(),
    st.sampled_from([-0.0, 1e308, -1e-308, 10**400, "", "nan", "../x", "a" * 3000, "\0", "é"]),
    st.text(max_size=20),
    st.lists(st.integers(), max_size=3),
    st.dictionaries(st.text(max_size=5), st.integers(), max_size=2),
)


def places(data: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the steps to every value of nested data."""
    for step, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*at, step)
        if isinstance(value, dict | list):
            yield from places(value, (*at, step))


def mutated(data: st.DataObject, content: bytes) -> bytes:
    """Change, cut out and insert bytes."""
    changed = bytearray(content)
    for _ in range(data.draw(st.integers(0, 6))):
        at = data.draw(st.integers(0, len(changed)))
        changed[at : at + data.draw(st.sampled_from([0, 1, 1, 4, 400]))] = data.draw(st.binary(max_size=4))
    return bytes(changed)


def check_refusal(error: BadInput) -> None:
    assert "\n" not in str(error)
    assert len(str(error)) < 1000


@fuzzed
@given(st.data())
def test_scenarios(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    scenario: Any = read_yaml(data.draw(st.sampled_from(MODELS)))
    for _ in range(data.draw(st.integers(1, 3))):
        *steps, last = data.draw(st.sampled_from(list(places(scenario))))
        inner = scenario
        for step in steps:
            inner = inner[step]
        inner[last] = data.draw(ODD)
    try:
        parse_scenario(scenario, source="x.yaml", folder=tmp_path_factory.getbasetemp()).world(0)
    except BadInput as error:
        check_refusal(error)


@fuzzed
@given(st.data())
def test_texts_of_boxes(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.getbasetemp() / "boxes.txt"
    number = st.one_of(st.integers(-2, 30), st.floats(), st.sampled_from(["", "x", "1e400", "-0"]))
    lines = data.draw(st.lists(st.lists(number, min_size=5, max_size=11), max_size=5))
    path.write_text("\n".join(",".join(map(str, line)) for line in lines))
    for read in (read_truth, read_tracks):
        try:
            read(path)
        except BadInput as error:
            check_refusal(error)


@fuzzed
@given(st.data())
def test_urdf(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.mktemp("urdf") / "x.urdf"
    words = st.one_of(st.floats(), st.sampled_from(["", "1", "1 1 1", "-1 0 1", "x", "1e400", "nan inf 1"]))
    shape = data.draw(st.sampled_from(["box", "sphere", "cylinder", "capsule", "mesh", "plane", "x"]))
    keys = data.draw(
        st.lists(st.sampled_from(["size", "radius", "length", "scale", "filename"]), unique=True)
    )
    attributes = " ".join(f'{key}="{data.draw(words)}"' for key in keys)
    origin = f'<origin xyz="{data.draw(words)}" rpy="{data.draw(words)}"/>'
    visual = f"<visual>{origin}<geometry><{shape} {attributes}/></geometry></visual>"
    joint = f'<joint><parent link="{data.draw(st.sampled_from("abc"))}"/><child link="a"/>{origin}</joint>'
    path.write_text(f'<robot name="r"><link name="a">{visual}</link>{joint}</robot>')
    try:
        read_urdf(path)
    except BadInput as error:
        check_refusal(error)


@fuzzed
@given(st.data())
def test_boxes_of_one_person(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.getbasetemp() / "groundtruth.txt"
    number = st.one_of(st.integers(-2, 30), st.floats(), st.sampled_from(["", "x", "1e400", "-0", "\0"]))
    lines = data.draw(st.lists(st.lists(number, min_size=3, max_size=9), max_size=4))
    separator = data.draw(st.sampled_from([",", " ", "\t", ";"]))
    path.write_text("\n".join(separator.join(map(str, line)) for line in lines))
    try:
        load_truth(path, data.draw(st.one_of(st.none(), st.integers(0, 5))))
    except BadInput as error:
        check_refusal(error)


@pytest.mark.filterwarnings("ignore::UserWarning")  # of Pillow, about damaged metadata
@fuzzed
@given(st.data(), st.sampled_from([".png", ".jpg", ".tiff", ".bmp"]), st.sampled_from([np.uint8, np.uint16]))
def test_images(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, suffix: str, depth: type[np.generic]
) -> None:
    path = tmp_path_factory.getbasetemp() / f"picture{suffix}"
    grey = np.arange(48).reshape(6, 8).astype(depth if suffix in (".png", ".tiff") else np.uint8)
    path.write_bytes(mutated(data, cv2.imencode(suffix, grey)[1].tobytes()))
    try:
        list(read_pages(path, [])) if suffix == ".tiff" else read_picture(path, [])
    except BadInput as error:
        check_refusal(error)


@fuzzed
@given(st.data())
def test_weights(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.getbasetemp() / "weights.npz"
    WeightsArchive({"a": np.zeros((2, 3), np.float32)}, {"x": "1"}).save(path)
    path.write_bytes(mutated(data, path.read_bytes()))
    try:
        WeightsArchive.load(path, "places", {"a": ArraySpec((2, 3))})
    except BadInput as error:
        check_refusal(error)


WORDS = ["show", "run", "evaluate", "report", "export", "view", "sweep", "render", "track", "--seed", "--out"]
NOWHERE = [
    "nan",
    "-1",
    "",
    "x.yaml",
    "a:b",
    "--tracker",
    "--seeds",
    "--",
    "-",
    "--json",
    "é",
    "\udcff",
    "a" * 300,
]


@fuzzed
@given(st.lists(st.sampled_from([*WORDS, *NOWHERE]), min_size=1, max_size=6))
def test_command_lines(words: list[str]) -> None:
    # None of them names a scenario, so that nothing is run.
    errors = io.StringIO()
    with redirect_stderr(errors), redirect_stdout(io.StringIO()):
        assert run_cli(*words) in (0, 2)
    assert "Traceback" not in errors.getvalue()


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return toy.write_run(tmp_path_factory.mktemp("whole") / "run")


@fuzzed
@given(st.data())
def test_run_folders(whole_run: Path, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    run = tmp_path_factory.getbasetemp() / "changed_run"
    shutil.rmtree(run, ignore_errors=True)
    shutil.copytree(whole_run, run)
    names = sorted(str(path.relative_to(run)) for path in run.rglob("*") if path.is_file())
    path = run / data.draw(st.sampled_from(names))
    content = mutated(data, path.read_bytes())
    path.write_bytes(
        content[: data.draw(st.integers(0, len(content)))] if data.draw(st.booleans()) else content
    )
    errors = io.StringIO()
    with redirect_stderr(errors), redirect_stdout(io.StringIO()):
        assert run_cli("evaluate", run) in (0, 2)
    assert "Traceback" not in errors.getvalue()


@fuzzed
@given(st.dictionaries(st.sampled_from(["frame", "time_s", "kind", "who", "other", "why", "move"]), ODD))
def test_lines_of_event_logs(line: dict[str, Any]) -> None:
    try:
        found = LogLine.from_json(line)
    except TypeError:
        return
    json.dumps(found.to_json())


@fuzzed
@given(st.lists(st.tuples(st.sampled_from(["step", "reset", "seed"]), ODD), max_size=5))
def test_calls_of_an_environment(calls: list[tuple[str, Any]]) -> None:
    env = PeopleBoyEnv("single_follow", observation="truth", physics="kinematic")
    env.reset(seed=0)
    for call, value in calls:
        try:
            if call == "step":
                env.step(value)
            elif call == "seed":
                env.reset(seed=value)
            else:
                env.reset(options=value)
        except BadInput as error:
            check_refusal(error)
    env.close()
