from dataclasses import replace

import pytest

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.faults import FaultySensors
from peopleboy.scenarios.loop.loop import Perception, closed_loop, see_person, thermal_box
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.box_interaction import standing_box
from peopleboy.tracker.track import FloorPlace
from tests.helpers.runs.hand_made_tracks import track

EMPTY = {
    "name": "empty",
    "description": "Nobody is in a room that is colder than the thermal camera's span.",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 14.0, "width_m": 7.0},
    "robot": {"at_m": [1.0, 0.0]},
}


class Counter:
    """A tracker that counts the images it is given."""

    cameras = ("thermal",)

    def __init__(self):
        self.images = 0

    def update(self, frame):  # noqa: ARG002
        self.images += 1
        return ()


def test_images_of_a_cold_wall_are_new_ones_though_all_of_them_are_black(tmp_path):
    scenario = parse_scenario(EMPTY, source="test", folder=tmp_path)
    tracker = Counter()
    with SimulatedWorld(scenario.world(0)) as world:
        perception = Perception(tracker, world.cameras)
        for _ in range(3):
            observation = world.observe()
            assert not observation.images["thermal"].any()
            assert perception.perceive(observation).image_age_s == 0.0
            world.step(0.0, 0.0)
    assert tracker.images == 3


CAMERA = calibrations_of(RobotConfig().cameras)[THERMAL]


def test_a_box_of_its_own_counts_before_the_place() -> None:
    box = (10.0, 20.0, 30.0, 90.0)
    assert thermal_box(track(1, boxes={THERMAL: box, "panorama": (0.0, 0.0, 1.0, 1.0)}), CAMERA) == box


def test_who_is_known_on_the_floor_alone_has_the_box_of_somebody_who_stands_there() -> None:
    known = track(1, (4.0, -0.5), boxes={"panorama": (0.0, 0.0, 1.0, 1.0)})
    assert known.place is not None
    assert thermal_box(known, CAMERA) == standing_box(known.place, CAMERA)


def test_who_has_neither_has_none() -> None:
    assert thermal_box(track(1, None), CAMERA) is None


def test_behaviours_get_positions_and_velocities_on_the_floor() -> None:
    place = FloorPlace(position_m=(4.0, -0.5), covariance_m2=(0.01, 0.0, 0.01), velocity_m_s=(-1.0, 0.2))
    seen = see_person(replace(track(1), place=place), (10.0, 20.0, 30.0, 90.0), 320, 240)
    assert (seen.position_m, seen.velocity_m_s) == (place.position_m, place.velocity_m_s)
    unknown = see_person(track(1, None), (10.0, 20.0, 30.0, 90.0), 320, 240)
    assert (unknown.position_m, unknown.velocity_m_s) == (None, None)


class Cautious:
    """A tracker that needs the thermal image and uses the colour image if there is one."""

    cameras = ("thermal", "colour")

    def __init__(self):
        self.seen = []

    def update(self, frame):
        frame.grey("thermal")
        self.seen.append("colour" in frame.images)
        return ()


@pytest.mark.parametrize(("camera", "stops"), [("colour", False), ("thermal", True), (None, True)])
def test_a_tracker_goes_on_without_a_failed_camera_if_it_can(tmp_path, camera, stops):
    data = EMPTY | {"people": [{"name": "anna", "path": [{"at_m": [5.0, 0.0]}]}], "physics": "kinematic"}
    scenario = parse_scenario(data, source="test", folder=tmp_path)
    faults = [FaultSpec(kind="camera_saturated", from_s=0.1, lasts_s=0.2, camera=camera)]
    tracker = Cautious()
    with SimulatedWorld(scenario.world(0)) as world:
        stage = FaultySensors(world, faults)
        ticks = list(closed_loop(stage, tracker, "stand", 8))
    failed = {name for tick in ticks for name in tick.failed}
    assert failed == ({camera} if camera else {"thermal", "colour"})
    assert {tick.mode == "stop" for tick in ticks if tick.failed} == {stops}
    assert not ticks[-1].failed
    assert ticks[-1].mode != "stop"
    assert tracker.seen == [True] * (5 if stops else 2) + ([] if stops else [False] * 3 + [True] * 3)
