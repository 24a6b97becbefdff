import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.faults import FaultyTracker, SensorFaults, active
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.observation import Observation
from peopleboy.tracker.frame import Frame, Odometry
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


def observed(time_s, **images):
    return Observation(
        time_s=time_s,
        sonar_m=np.linspace(1.0, 2.5, 16) + time_s,
        odometry=Pose2(time_s, 0.0, 0.0),
        wheel_speeds_m_s=(1.0, 1.0),
        images=images or {"thermal": np.full((40, 60), 10 + round(15 * time_s), np.uint8), "colour": LIT},
    )


LIT = np.random.default_rng(0).integers(1, 255, (40, 60, 3), np.uint8)


def through(kind, frames=6, from_s=2 / 15, **settings):
    """Readings of some frames; the fault starts with the third one."""
    faults = SensorFaults([FaultSpec(kind=kind, from_s=from_s, **settings)], 5.0)
    return [faults.apply(observed(k / 15)) for k in range(frames)]


def greys(readings):
    return [int(one.images["thermal"][0, 0]) for one in readings]


def test_a_fault_concerns_the_named_camera_alone():
    for kind in ("camera_lost", "camera_black", "camera_saturated", "calibration_off", "dead_rows"):
        *_, last = through(kind, camera="colour", strength=None)
        assert greys([last]) == [15], kind
        assert not np.array_equal(last.images["colour"], LIT), kind
    assert np.ptp(through("camera_saturated")[-1].images["thermal"]) <= 1
    assert through("camera_saturated")[-1].images["thermal"].min() >= 254


def test_repeated_late_and_duplicated_images():
    assert greys(through("camera_frozen")) == [10, 11, 11, 11, 11, 11]
    assert greys(through("camera_shutter", frames=10)) == [10, 11, *[11] * 6, 18, 19]
    assert greys(through("frames_late", strength=0.13)) == [10, 11, 10, 11, 12, 13]
    assert greys(through("frames_duplicated")) == [10, 11, 12, 12, 14, 14]
    dropped = greys(through("frames_dropped", frames=60))
    assert 10 < sum(np.diff(dropped) == 0) < 50


def test_noise_comes_in_bursts():
    images = [one.images["colour"] for one in through("noise_bursts", frames=40)]
    spoilt = [not np.array_equal(image, LIT) for image in images]
    assert 5 < sum(spoilt) < 35


def test_one_or_all_sonars_are_dead_or_stuck():
    one, every = through("sonar_maximum", sonar=3)[-1], through("sonar_maximum")[-1]
    assert (one.sonar_m == 5.0).nonzero()[0].tolist() == [3]
    assert (every.sonar_m == 5.0).all()
    readings = through("sonar_stuck", sonar=3)
    assert readings[-1].sonar_m[3] == readings[1].sonar_m[3]
    assert readings[-1].sonar_m[4] > readings[1].sonar_m[4]


def test_slipping_wheels_and_drifting_odometry_overestimate_the_way():
    slip = SensorFaults([FaultSpec(kind="wheel_slip", from_s=0.0, strength=0.5)], 5.0)
    assert slip.slip(1.0) == pytest.approx(0.5)
    x = [slip.apply(observed(k / 15)).odometry.x for k in range(4)]
    assert x == pytest.approx([0.0, 2 / 15, 4 / 15, 6 / 15])
    assert slip.apply(observed(1.0)).wheel_speeds_m_s == pytest.approx((2.0, 2.0))
    drift = through("odometry_drift", strength=0.2)
    assert drift[-1].odometry.x == pytest.approx(1 / 15 + 4 / 15 * 1.2)


def test_an_overloaded_tracker_skips_frames_and_joins_their_motions():
    class Counting:
        cameras = ("thermal",)
        ways: tuple = ()

        def update(self, frame):
            self.ways += (frame.odometry.advance_m,)
            return ()

    tracker = Counting()
    busy = FaultyTracker(
        tracker, [FaultSpec(kind="tracker_overload", from_s=0.0, lasts_s=0.59, strength=2.0)]
    )
    for k in range(9):
        busy.update(Frame(images={}, time_s=k / 10, odometry=Odometry(advance_m=0.1)))
    assert tracker.ways == pytest.approx((0.3, 0.3, 0.1, 0.1, 0.1))


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"kind": "camera_black", "camera": "sonar"}, ("'sonar'", "thermal, colour")),
        ({"kind": "wheel_slip", "camera": "thermal"}, ("camera", "leave it out")),
        ({"kind": "wheel_slip", "sonar": 3}, ("sonar", "leave it out")),
        ({"kind": "camera_black", "strength": 1.0}, ("strength", "leave it out")),
        ({"kind": "wheel_slip", "strength": 2.0}, ("at most 0.9",)),
    ],
)
def test_settings_that_a_fault_does_not_have_are_refused(tmp_path, fault, words):
    with refused("faults", *words):
        parse_scenario(broken(fault | {"from_s": 1.0}), source="test", folder=tmp_path)


def test_faults_work_in_environments(tmp_path):
    file = tmp_path / "broken.yaml"
    file.write_text(json.dumps(broken({"kind": "sonar_maximum", "from_s": 0.1}, physics="kinematic")))
    for env in (
        PeopleBoyEnv(str(file), observation="truth"),
        PeopleBoyVectorEnv(2, scenario=str(file), observation="truth"),
    ):
        shape = env.action_space.shape
        env.reset(seed=1)
        for _ in range(4):
            observation = env.step(np.zeros(shape, np.float32))[0]
        assert (observation["sonar"] == 5.0).all()
        env.close()
