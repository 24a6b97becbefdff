"""Random inputs: whatever users write is accepted, or refused soon and in one line."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from datetime import timedelta
from typing import Any

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

fuzzed = settings(
    max_examples=int(os.environ.get("FUZZ_EXAMPLES", "30")),
    deadline=timedelta(seconds=5),
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
