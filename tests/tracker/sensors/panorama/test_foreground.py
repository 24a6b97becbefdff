"""The network that comes with the tracker, on rendered people whose pixels are known."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.studies.training.foreground import MaskScores, score_masks, segment
from peopleboy.studies.training.panorama_sequences import render_panoramas
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.sensors.panorama.people_foreground import Foreground, shipped_foreground
from tests.helpers.calls.refused import refused

ROOM = {
    "name": "two_walk",
    "description": "Two people walk round a robot.",
    "duration_s": 6.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 8.0},
    "people": [
        {"name": "anna", "path": [{"at_m": [6.5, -2.0]}, {"at_m": [6.5, 3.0]}, {"at_m": [3.0, 3.0]}]},
        {"name": "bert", "path": [{"at_m": [1.5, 2.5]}, {"at_m": [1.5, -2.5]}, {"at_m": [5.0, -2.5]}]},
    ],
    "robot": {"at_m": [4.0, 0.0], "cameras": {"panorama": {"kind": "panorama", "rate_hz": 5}}},
}
DRIVE = {"behaviour": "scripted", "commands": [{"from_s": 0.5, "linear_m_s": 0.3, "angular_deg_s": 12.0}]}


def filmed(folder, **robot):
    path = folder / "two_walk.yaml"
    path.write_text(yaml.safe_dump(ROOM | {"robot": ROOM["robot"] | robot}), encoding="utf-8")
    scenario = load_scenario(path)
    return render_panoramas(scenario, 0), calibrations_of(scenario.world(0).robot.cameras)["panorama"]


@pytest.fixture(scope="module")
def standing(tmp_path_factory):
    return filmed(tmp_path_factory.mktemp("standing"))


@pytest.fixture(scope="module")
def driving(tmp_path_factory):
    return filmed(tmp_path_factory.mktemp("driving"), **DRIVE)


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["standing", "driving"])
def test_people_are_told_from_background(robot, request):
    film, calibration = request.getfixturevalue(robot)
    assert film.is_driven == (robot == "driving")
    judgement = MaskScores()
    score_masks(film, segment(film, shipped_foreground(), calibration), judgement)
    assert np.mean(judgement.found) > 0.9
    assert np.median(np.abs(judgement.foot_px)) <= 1.0
    assert np.mean(np.abs(judgement.column_px)) < 1.0
    assert judgement.false_px < 10 * judgement.images


def test_images_rolled_by_whole_squares_give_the_same_answers_rolled(standing):
    film, calibration = standing
    eyes, rolled = Foreground(), Foreground()
    for k in range(5):
        image, at = film.images[k], float(film.time_s[k])
        stood = None if k == 0 else Odometry()
        reported = eyes.update(image, at, stood, calibration)
        again = rolled.update(np.ascontiguousarray(np.roll(image, 100, axis=1)), at, stood, calibration)
        assert np.array_equal(again, np.roll(reported, 100, axis=1))


def test_the_same_images_give_the_same_answers(driving):
    film, calibration = driving
    one, two = (list(segment(film, shipped_foreground(), calibration)) for _ in range(2))
    assert np.array_equal(one, two)
    assert one[0].shape == (120, 480)
    assert one[0].dtype == np.float32
    assert 0.0 <= np.min(one) <= np.max(one) <= 1.0


def test_an_unknown_movement_makes_all_begin_anew(driving):
    film, calibration = driving
    eyes, fresh = Foreground(), Foreground()
    for k in range(3):
        eyes.update(film.images[k], float(film.time_s[k]), film.odometry(k), calibration)
    assert np.array_equal(
        eyes.update(film.images[3], 1.0, None, calibration),
        fresh.update(film.images[3], 1.0, None, calibration),
    )


def test_the_background_begins_with_the_first_image_of_which_nothing_is_new(standing):
    film, calibration = standing
    eyes = Foreground()
    assert eyes.background.shape == film.images[0].shape
    assert not eyes.background.any()
    eyes.update(film.images[0], 0.0, None, calibration)
    assert np.array_equal(eyes.background, film.images[0])
    assert not eyes.novelty.any()


def test_people_are_new_and_the_background_lacks_them(standing):
    film, calibration = standing
    eyes = Foreground()
    for k, image in enumerate(film.images):
        eyes.update(image, float(film.time_s[k]), film.odometry(k), calibration)
    people = film.person[-1] > 0
    assert eyes.novelty[people].mean() > 5 * eyes.novelty[~people].mean()
    # Where somebody is now, it shows what was seen there before anybody came.
    came = people & (film.person[0] == 0)
    empty = film.images[0][came].astype(float)
    assert np.abs(eyes.background[came] - empty).mean() < 0.3 * np.abs(film.images[-1][came] - empty).mean()


def test_another_mirror_or_size_is_refused(standing):
    film, calibration = standing
    with refused("480x100", "480x120", "other network"):
        Foreground().update(film.images[0][:100], 0.0, None, calibration)
    with refused("deg down", "other network"):
        Foreground().update(film.images[0], 0.0, None, replace(calibration, axis_rad=0.6))
