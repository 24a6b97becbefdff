from __future__ import annotations

import json
from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.run import is_finished
from peopleboy.scenarios.running.run_options import RunOptions
from tests.helpers.runs import toy_runs as toy

SCENARIO = load_scenario("crossing_2")


@pytest.fixture
def options(tmp_path: Path) -> RunOptions:
    folder = toy.write_run(tmp_path / "run", scenario=SCENARIO.resolved(0, versions()))
    return RunOptions(seed=0, out=folder)


def say(options: RunOptions, **values: object) -> None:
    path = options.out / "run.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def test_a_run_of_the_same_scenario_and_options_is_finished_unless_images_are_wanted(
    options: RunOptions, tmp_path: Path
) -> None:
    assert is_finished(SCENARIO, options)
    for other in ({"frames": True}, {"overwrite": True}, {"out": tmp_path / "nothing"}):
        assert not is_finished(SCENARIO, RunOptions(**{"seed": 0, "out": options.out} | other))
    say(options, images=True)
    assert is_finished(SCENARIO, RunOptions(seed=0, out=options.out, frames=True))


@pytest.mark.parametrize("content", ["", "[]", '{"status": "running"}', '{"status": "cut off", "frames": 9}'])
def test_a_run_that_was_cut_off_is_not_finished(options: RunOptions, content: str) -> None:
    (options.out / "run.json").write_text(content)
    assert not is_finished(SCENARIO, options)


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ({"tracker": "thesis"}, "was run with tracker 'thesis'"),
        ({"boxes": "whole"}, "was run with --boxes whole"),
        ({"renderer": "bullet"}, "is a run of another scenario"),
        ({"tracker": None}, r"run\.json: tracker: "),
        ({"footage": "clip"}, "is a run of footage"),
    ],
)
def test_another_complete_run_is_refused_rather_than_replaced(
    options: RunOptions, said: dict[str, object], why: str
) -> None:
    say(options, **said)
    with pytest.raises(BadInput, match=why) as refusal:
        is_finished(SCENARIO, options)
    assert "\n" not in str(refusal.value)


def test_a_complete_run_that_lost_its_scenario_is_refused_by_the_file_s_name(options: RunOptions) -> None:
    (options.out / "scenario.yaml").unlink()
    with pytest.raises(BadInput, match=r"scenario\.yaml: file not found"):
        is_finished(SCENARIO, options)
