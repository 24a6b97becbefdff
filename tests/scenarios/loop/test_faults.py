import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import get_args

import numpy as np
import pyarrow.parquet as pq
import pytest

from peopleboy.behaviours.safety_limits import SafetyConfig
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario_file import Failure, FaultSpec
from peopleboy.scenarios.loop.faults import FaultySensors, FaultyTracker, SensorFaults, active
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.run_events import RunEvents
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.observation import Observation
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import Frame, Odometry
from peopleboy.tracker.trackers import make_tracker
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
    return request.param, pq.read_table(folder / "robot.parquet").to_pydict(), events, scores.drive.following


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
    assert speed[time_s >= FROM_S + 0.3].max() < 0.1  # the hull swings back, but the robot stays in its place
    place = np.stack([robot["x_m"], robot["y_m"]], axis=1)[time_s >= FROM_S + 0.3]
    assert np.hypot(*(place - place[0]).T).max() < 0.005
    assert speed[time_s >= FROM_S + 0.6].max() < 0.02
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
    assert scores.drive.following is not None
    assert scores.drive.following.followed_to_end
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


class Robot:
    """A robot in a world without walls."""

    def __init__(self):
        self.where = Pose2()

    def pose(self):
        return self.where

    def push(self, ahead_m, left_m):
        self.where = self.where.compose(Pose2(ahead_m, left_m))

    def put(self, pose):
        self.where = pose


def test_slipping_wheels_and_drifting_odometry_overestimate_the_way():
    slip = SensorFaults([FaultSpec(kind="wheel_slip", from_s=0.0, strength=0.5)], 5.0)
    assert slip.disturb(Robot(), 1.0) == pytest.approx(0.5)
    x = [slip.apply(observed(k / 15)).odometry.x for k in range(4)]
    assert x == pytest.approx([0.0, 2 / 15, 4 / 15, 6 / 15])
    assert slip.apply(observed(1.0)).wheel_speeds_m_s == pytest.approx((2.0, 2.0))
    drift = through("odometry_drift", strength=0.2)
    assert drift[-1].odometry.x == pytest.approx(1 / 15 + 4 / 15 * 1.2)


def test_a_pushed_robot_moves_to_its_left_as_long_as_it_is_pushed():
    robot, push = Robot(), SensorFaults([FaultSpec(kind="robot_pushed", from_s=1.0, lasts_s=1.0)], 5.0)
    robot.where = Pose2(heading=math.radians(90.0))
    assert [push.disturb(robot, k / 15) for k in range(45)] == [1.0] * 45
    assert (robot.where.x, robot.where.y) == pytest.approx((-0.2, 0.0))


@pytest.mark.parametrize(("distance_m", "x"), [(0.25, 0.6), (9.0, 0.0)])
def test_a_lifted_robot_is_put_down_where_it_was_and_held_there(distance_m, x):
    fault = FaultSpec(kind="robot_lifted", from_s=0.85, lasts_s=0.3, strength=distance_m)
    robot, lift, shares = Robot(), SensorFaults([fault], 5.0), []
    for k in range(14):
        share = lift.disturb(robot, k / 10)
        robot.push(0.1 * share, 0.0)
        shares.append(share)
    assert shares == [1.0] * 9 + [0.0] * 3 + [1.0] * 2
    assert robot.where.x == pytest.approx(x)
    assert (robot.where.y, robot.where.heading) == pytest.approx((0.2, math.pi / 2.0))


@pytest.mark.parametrize("physics", ["bullet", "kinematic"])
def test_wheels_do_not_notice_pushes_and_lifts(physics):
    faults = [
        {"kind": "robot_pushed", "from_s": 2.0, "lasts_s": 1.0},
        {"kind": "robot_lifted", "from_s": 4.0, "lasts_s": 1.0, "strength": 1.0},
    ]
    scenario = parse_scenario(broken(*faults, physics=physics, people=[]), source="test", folder=Path())
    found = {}
    with SimulatedWorld(scenario.world(0)) as world:
        stage = FaultySensors(world, scenario.spec.faults)
        for k in range(75):
            found[k / 15] = world.robot.pose(), world.robot.odometry, world.robot.velocity()[0]
            stage.step(0.4, 0.0)
    pose, odometry, speed_m_s = found[3.0]
    assert (pose.x, pose.y, speed_m_s) == pytest.approx((odometry.x, 0.2, 0.4), abs=0.02)
    assert odometry.y == pytest.approx(0.0, abs=0.02)
    (before, _, _), (after, odometry, speed_m_s) = found[4.0], found[74 / 15]
    assert after.x == pytest.approx(before.x - 1.0, abs=0.05)
    assert after.heading == pytest.approx(math.pi / 2.0, abs=0.02)
    assert speed_m_s == pytest.approx(0.0, abs=0.01)
    assert odometry.x == pytest.approx(before.x, abs=0.03)


@pytest.mark.parametrize("camera", ["thermal", "panorama"])
def test_a_camera_that_looks_too_low_shows_everything_higher(camera):
    config = RobotConfig().cameras["thermal"] if camera == "thermal" else PanoramaConfig()
    calibration = config.camera.calibration
    # Ring of a panorama's centres of projection, of no radius for a flat camera.
    start = calibration.position_m + np.array([getattr(calibration, "ring_radius_m", 0.0), 0.0, 0.0])
    points = [
        start + 6.0 * np.array([[math.cos(down), 0.0, -math.sin(down)]]) for down in np.radians([14.0, 17.0])
    ]
    (u, v), (_, low) = (np.rint(calibration.project(each)[0]).astype(int) for each in points)
    image = np.zeros((config.camera.height, config.camera.width), np.uint8)
    image[low - 1 : low + 2] = 200
    seen = replace(observed(0.0, **{camera: image}), calibrations={camera: calibration})
    faults = SensorFaults([FaultSpec(kind="calibration_turned", from_s=0.0)], 5.0)
    assert faults.apply(seen).images[camera][v, u] == 200
    assert seen.images[camera][v, u] == 0


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


STOPS = {
    "camera_lost": "the image is black", "camera_frozen": "no new image", "camera_black": "image is black",
    "camera_saturated": "the image is saturated", "sonar_maximum": "no echoes", "sonar_stuck": "they repeat",
    "tracker_raises": "the tracker failed",
}  # fmt: skip
"""Faults in which the robot rests, with a part of the reason."""
SLOWS = ("camera_shutter", "frames_dropped", "frames_duplicated")
"""Faults in which the robot brakes at each image that repeats, and waits for several new ones in a row."""
GOES_ON = (
    "frames_late", "dead_rows", "noise_bursts", "calibration_off", "calibration_turned", "wheel_slip",
    "odometry_jumps", "odometry_drift", "robot_pushed", "tracker_overload",
)  # fmt: skip
ONE_GOES_ON = (
    {"kind": "camera_black", "camera": "colour"},
    {"kind": "sonar_maximum", "sonar": 3},
    {"kind": "sonar_stuck", "sonar": 3},
)


def test_the_reaction_to_each_kind_of_fault_is_tested():
    assert {*STOPS, *SLOWS, *GOES_ON, "robot_lifted"} == set(get_args(Failure))


def drive_through(fault, duration_s=9.0):
    """Speeds, modes, followed tracks and events of a drive with the default tracker and a fault of 2 s."""
    data = broken(
        {"from_s": FROM_S, "lasts_s": 2.0} | fault,
        duration_s=duration_s,
        physics="kinematic",
        robot=SCENE["robot"] | {"cameras": {}},
    )
    scenario = parse_scenario(data, source="test", folder=Path())
    tracker, faults, events = make_tracker("detection"), scenario.spec.faults, RunEvents(scenario.spec.faults)
    with SimulatedWorld(scenario.world(0)) as world:
        stage, eyes = FaultySensors(world, faults), FaultyTracker(tracker, faults)
        ticks = list(closed_loop(stage, eyes, scenario.make_behaviour(), round(15 * duration_s)))
    assert not any(tick.truth.contacts for tick in ticks)
    lines = [line for tick in ticks for line in events.update(tick)]
    marks = [(line.kind, line.time_s) for line in lines if line.kind.startswith("fault")]
    assert marks == [("fault starts", pytest.approx(FROM_S)), ("fault ends", pytest.approx(FROM_S + 2.0))]
    during = [tick for tick in ticks if FROM_S + 0.01 < tick.truth.time_s < FROM_S + 2.0]
    assert speeds(ticks)[round(15 * FROM_S) - 1] > 0.5
    return ticks, during, lines


def speeds(ticks):
    return np.abs([tick.truth.robot_velocity[0] for tick in ticks])


def assert_follows_again(ticks):
    assert ticks[-1].mode == "follow"
    assert ticks[-1].following is not None
    assert speeds(ticks[-30:]).max() > 0.3


@pytest.mark.slow
@pytest.mark.parametrize("kind", STOPS)
def test_the_robot_rests_gives_a_reason_and_follows_again(kind):
    ticks, during, lines = drive_through({"kind": kind})
    assert speeds(during)[8:].max() < 0.02
    assert {tick.mode for tick in during[8:]} == {"stop"}
    assert STOPS[kind] in during[8].reason
    assert [line.other for line in lines if line.kind == "mode" and line.time_s > FROM_S - 0.1] == [
        "stop",
        "follow",
    ]
    assert_follows_again(ticks)


@pytest.mark.slow
@pytest.mark.parametrize("kind", SLOWS)
def test_the_robot_brakes_at_images_that_repeat_and_does_not_toggle(kind):
    ticks, during, _ = drive_through({"kind": kind})
    modes = [tick.mode for tick in during]
    assert set(modes) <= {"stop", "follow"}
    assert "stop" in modes
    changes = sum(mode != before for before, mode in pairwise(modes))
    assert changes <= 2 * len(modes) // (1 + SafetyConfig().resume_images)  # a repeated image, and new ones
    assert speeds(during).mean() < 0.6
    assert_follows_again(ticks)


@pytest.mark.slow
@pytest.mark.parametrize("fault", [*({"kind": kind} for kind in GOES_ON), *ONE_GOES_ON], ids=str)
def test_the_robot_goes_on_following(fault):
    ticks, during, lines = drive_through(fault, duration_s=8.0)
    assert {tick.mode for tick in during} == {"follow"}
    assert speeds(during).min() > 0.3
    reported = [line.who for line in lines if line.kind == "camera fails"]
    assert reported == ([fault["camera"]] if "camera" in fault else [])
    assert_follows_again(ticks)


@pytest.mark.slow
def test_a_robot_put_down_elsewhere_searches_the_lost_person():
    ticks, during, lines = drive_through({"kind": "robot_lifted"})
    assert speeds(during).max() == 0.0
    assert any(line.kind == "lost" for line in lines)
    assert {tick.mode for tick in ticks[-30:]} <= {"wait", "recover", "search", "follow"}
    assert speeds(ticks[-30:]).max() > 0.1


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"kind": "camera_black", "camera": "sonar"}, ("'sonar'", "thermal, colour")),
        ({"kind": "wheel_slip", "camera": "thermal"}, ("camera", "leave it out")),
        ({"kind": "wheel_slip", "sonar": 3}, ("sonar", "leave it out")),
        ({"kind": "camera_black", "strength": 1.0}, ("strength", "leave it out")),
        ({"kind": "wheel_slip", "strength": 2.0}, ("at most 0.9",)),
        ({"kind": "robot_lifted", "camera": "thermal"}, ("camera", "leave it out")),
        ({"kind": "calibration_turned", "strength": 30.0}, ("at most 20",)),
    ],
)
def test_settings_that_a_fault_does_not_have_are_refused(tmp_path, fault, words):
    with refused("faults", *words):
        parse_scenario(broken(fault | {"from_s": 1.0}), source="test", folder=tmp_path)


def test_faults_work_in_environments(tmp_path):
    file = tmp_path / "broken.yaml"
    file.write_text(json.dumps(broken({"kind": "sonar_maximum", "from_s": 0.1}, physics="kinematic")))
    for env in both_environments(file):
        shape = env.action_space.shape
        env.reset(seed=1)
        for _ in range(4):
            observation = env.step(np.zeros(shape, np.float32))[0]
        assert (observation["sonar"] == 5.0).all()
        env.close()


def both_environments(file):
    return (
        PeopleBoyEnv(str(file), observation="truth"),
        PeopleBoyVectorEnv(2, scenario=str(file), observation="truth"),
    )


def test_environments_push_and_lift_robots(tmp_path):
    file = tmp_path / "pushed.yaml"
    push = {"kind": "robot_pushed", "from_s": 0.0, "lasts_s": 0.5, "strength": 0.6}
    lift = {"kind": "robot_lifted", "from_s": 0.6, "lasts_s": 0.2}
    file.write_text(json.dumps(broken(push, lift, physics="kinematic")))
    single, vector = both_environments(file)
    single.reset(seed=1)
    vector.reset(seed=[1, 2])
    poses = []
    for _ in range(12):
        single.step(np.zeros(2, np.float32))
        vector.step(np.zeros((2, 2), np.float32))
        poses.append(single.world.robot.pose())
        assert vector.envs[0].world.robot.pose() == poses[-1]
    assert poses[7].y == pytest.approx(0.6 * 8 / 15)
    assert poses[-1].heading == pytest.approx(math.pi / 2.0)
    single.close()
    vector.close()
