import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.faults import active
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from tests.helpers.calls.refused import refused

FROM_S = 5.0
SMALL = {kind: {"kind": kind, "width_px": 80, "height_px": 60} for kind in ("thermal", "colour")}
SCENE = {
    "name": "broken",
    "description": "Somebody walks ahead of a robot in which something breaks.",
    "duration_s": 9.0,
    "place": {"kind": "room", "length_m": 14.0, "width_m": 7.0},
    "people": [
        {"name": "anna", "path": [{"at_m": [5.0, 0.0]}, {"at_m": [12.5, 0.3], "speed_m_s": 0.7}]},
    ],
    "robot": {"at_m": [1.0, 0.0], "behaviour": "follow_person", "cameras": SMALL},
}  # fmt: skip
KINDS = ("camera_frozen", "camera_black", "tracker_raises", "sonar_maximum", "odometry_jumps")


def broken(*faults, **changes):
    return SCENE | {"faults": list(faults)} | changes


@pytest.fixture(scope="module", params=KINDS)
def finished(request, tmp_path_factory):
    """Robot table, events and scores of a run in which one thing breaks."""
    folder = tmp_path_factory.mktemp(request.param) / "run"
    scenario = parse_scenario(
        broken({"kind": request.param, "from_s": FROM_S}), source="test", folder=folder.parent
    )
    scores = run(scenario, RunOptions(seed=0, out=folder, tracker="truth", record=False), lambda *_: None)
    events = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    return request.param, pq.read_table(folder / "robot.parquet").to_pydict(), events, scores.following


@pytest.mark.slow
def test_nothing_is_touched_whatever_breaks(finished):
    kind, _, _, following = finished
    assert following.collisions == 0, kind


def test_the_log_says_when_something_breaks(finished):
    kind, _, events, _ = finished
    told = [(event["kind"], event["who"], event["time_s"]) for event in events if "fault" in event["kind"]]
    assert told == [("fault starts", kind, pytest.approx(FROM_S))]


def test_the_robot_brakes_at_once_without_images_or_tracker_and_rests(finished):
    kind, robot, events, _ = finished
    if kind not in ("camera_frozen", "camera_black", "tracker_raises"):
        pytest.skip("the robot may go on")
    time_s, speed = np.array(robot["time_s"]), np.abs(np.array(robot["linear_m_s"]))
    assert speed[(time_s > FROM_S - 1.0) & (time_s < FROM_S)].min() > 0.4
    assert speed[time_s >= FROM_S + 0.3].max() < 0.15
    assert speed[time_s >= FROM_S + 0.4].max() < 0.02
    stop = next(event for event in events if event["other"] == "stop")
    assert stop["why"]


def test_deaf_sonars_stop_the_robot_and_the_reason_is_in_the_log(finished):
    kind, robot, events, _ = finished
    if kind != "sonar_maximum":
        pytest.skip("the sonars work")
    # Three readings are looked at together, lest a drop-out stop the robot.
    assert np.abs(np.array(robot["linear_m_s"])[np.array(robot["time_s"]) > FROM_S + 0.6]).max() < 0.02
    assert any("sonars have failed" in event.get("why", "") for event in events)


def test_a_jumping_odometry_does_not_end_the_following(finished):
    kind, robot, _, following = finished
    if kind != "odometry_jumps":
        pytest.skip("the odometry is sound")
    away = np.hypot(
        np.array(robot["odometry_x_m"]) - robot["x_m"], np.array(robot["odometry_y_m"]) - robot["y_m"]
    )
    assert away[-1] > 3.0
    assert following.followed_to_end


@pytest.mark.slow
def test_a_robot_goes_on_when_the_images_come_back(tmp_path):
    scenario = parse_scenario(
        broken({"kind": "camera_frozen", "from_s": 5.0, "lasts_s": 0.6}), source="test", folder=tmp_path
    )
    options = RunOptions(seed=1, out=tmp_path / "run", tracker="truth", record=False)
    scores = run(scenario, options, lambda *_: None)
    assert scores.following is not None
    assert scores.following.followed_to_end
    lines = [json.loads(line) for line in (tmp_path / "run" / "events.jsonl").read_text().splitlines()]
    told = [(line["kind"], line["time_s"]) for line in lines if line["who"] == "camera_frozen"]
    assert told == [("fault starts", pytest.approx(5.0)), ("fault ends", pytest.approx(5.6, abs=0.1))]


def test_faults_last_as_long_as_they_should():
    faults = [
        FaultSpec(kind="camera_black", from_s=1.0, lasts_s=2.0),
        FaultSpec(kind="tracker_raises", from_s=2.5),
    ]
    assert active(faults, 0.9) == {}
    assert active(faults, 2.75) == {"camera_black": 1.75, "tracker_raises": 0.25}
    assert active(faults, 3.0) == {"tracker_raises": 0.5}


def test_an_unknown_fault_is_refused_with_those_there_are(tmp_path):
    with refused("'fire'", "camera_frozen"):
        parse_scenario(broken({"kind": "fire", "from_s": 1.0}), source="test", folder=tmp_path)
    assert load_scenario("single_follow").spec.faults == ()
