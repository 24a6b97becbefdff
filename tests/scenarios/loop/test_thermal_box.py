from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.thermal_box import thermal_box
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.thermal.whereabouts import standing_box
from tests.helpers.runs.hand_made_tracks import track

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
