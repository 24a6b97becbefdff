import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.studies.blind_drive import blind_drive
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import THERMAL, Odometry
from peopleboy.tracker.proposals.detector import PeopleDetector
from peopleboy.tracker.thermal.mount import Mount, mount_of

Grey = NDArray[np.uint8]


def moments(scenario: str, seed: int, seconds: float) -> tuple[list[tuple[Grey, float]], NDArray[np.float64]]:
    """Images of a run until a time, and the boxes (P, 4) of everybody in plain view at the last one."""
    images, boxes = [], np.empty((0, 4))
    for world, observation in blind_drive(load_scenario(scenario), seed):
        images.append((observation.images[THERMAL].copy(), observation.time_s))
        if observation.time_s >= seconds:
            seen = [person.box for person in world.truth().people if person.visible_fraction > 0.8]
            boxes = np.array(seen, np.float64).reshape(-1, 4)
            break
    return images, boxes


@pytest.fixture(scope="module")
def crossing() -> tuple[list[tuple[Grey, float]], NDArray[np.float64]]:
    return moments("crossing_2", 0, 2.0)


def test_people_of_the_library_are_found(
    crossing: tuple[list[tuple[Grey, float]], NDArray[np.float64]],
) -> None:
    images, boxes = crossing
    detector = PeopleDetector()
    for image, time_s in images:
        found = detector.update(image, time_s)
    assert len(boxes)
    assert (iou(boxes[:, None], found.box[None]).max(axis=1) > 0.5).all()


def test_people_of_random_worlds_are_found() -> None:
    people = hits = 0
    for seed in (2, 5, 9):
        scenario = random_scenario(seed, 2.0)
        calibration = calibrations_of(scenario.world(seed).robot.cameras).get(THERMAL)
        detector = PeopleDetector()
        for world, observation in blind_drive(scenario, seed):
            grey = observation.images[THERMAL]
            mount = mount_of(calibration, grey.shape[0])
            found = detector.update(grey, observation.time_s, None, mount)
            if observation.time_s >= 1.5:
                seen = [
                    person.box
                    for person in world.truth().people
                    if person.visible_fraction > 0.8
                    and person.box is not None
                    and 30.0 < person.box[3] < 150.0
                ]
                boxes = np.array(seen, np.float64).reshape(-1, 4)
                people += len(boxes)
                hits += int((iou(boxes[:, None], found.box[None]) > 0.5).any(axis=1).sum())
                break
    assert people >= 3
    assert hits >= 0.6 * people


def test_a_mirrored_image_has_mirrored_people(
    crossing: tuple[list[tuple[Grey, float]], NDArray[np.float64]],
) -> None:
    # Trees are not symmetric; those who are surely there are found on either side.
    image, boxes = crossing[0][-1][0], crossing[1]
    mirrored = PeopleDetector().update(np.ascontiguousarray(image[:, ::-1]), 0.0)
    back = mirrored.box.copy()
    back[:, 0] = image.shape[1] - 1.0 - (back[:, 0] + back[:, 2])
    assert (iou(boxes[:, None], back[None]).max(axis=1) > 0.5).all()


@pytest.mark.parametrize(("gain", "offset"), [(0.8, 0.0), (1.0, -20.0), (0.7, 60.0)])
def test_gain_and_offset_hardly_matter(gain: float, offset: float) -> None:
    (image, _), *_ = moments("single_stationary", 1, 0.0)[0]
    # Greys as an image of automatic gain has them: nothing at either end.
    image = (40.0 + 0.6 * image).astype(np.uint8)
    other = np.clip(gain * image + offset, 0.0, 255.0).round().astype(np.uint8)
    found, again = (PeopleDetector(least_score=1.0).update(one, 0.0) for one in (image, other))
    assert len(found.score)
    assert iou(found.box[:1], again.box[:1])[0] > 0.7
    assert again.score[0] == pytest.approx(found.score[0], abs=1.5)


def test_scores_fall_and_nobody_below_the_least_is_told(
    crossing: tuple[list[tuple[Grey, float]], NDArray[np.float64]],
) -> None:
    image = crossing[0][-1][0]
    found = PeopleDetector(least_score=0.5).update(image, 0.0)
    assert (np.diff(found.score) <= 0.0).all()
    assert (found.score >= 0.5).all()
    assert len(PeopleDetector(least_score=np.inf).update(image, 0.0).score) == 0


def plain(value: int) -> Grey:
    return np.full((120, 160), value, np.uint8)


def test_the_image_of_about_a_fifth_of_a_second_ago_tells_what_moves() -> None:
    detector, odometry, mount = PeopleDetector(), Odometry(), Mount(59.5, 150.0, 1.2)
    changes = [detector._change(plain(10 * k), k / 15.0, odometry, mount).max() for k in range(8)]
    assert changes == [0, 10, 20, 30, 30, 30, 30, 30]


def test_what_is_older_than_twice_that_tells_nothing() -> None:
    detector = PeopleDetector()
    detector._change(plain(0), 0.0, None, None)
    assert not detector._change(plain(90), 1.0, None, None).any()


def test_time_that_goes_back_and_an_image_of_another_size_begin_anew() -> None:
    detector = PeopleDetector()
    for k in range(3):
        detector._change(plain(0), 5.0 + k / 15.0, None, None)
    assert not detector._change(plain(90), 0.0, None, None).any()
    assert not detector._change(np.full((60, 80), 90, np.uint8), 0.1, None, None).any()


def test_the_turn_of_a_robot_with_odometry_is_no_motion() -> None:
    rng, mount = np.random.default_rng(0), Mount(59.5, 150.0, 1.2)
    wide = np.kron(rng.integers(0, 256, (30, 60)), np.ones((4, 4))).astype(np.uint8)
    step = Odometry(turn_rad=4.0 / 150.0)  # 4 px in the middle of the image
    known = PeopleDetector()
    for k in range(4):
        start = 40 - 4 * k
        change = known._change(wide[:, start : start + 160].copy(), k / 15.0, step, mount)
    still = PeopleDetector()
    for k in range(4):
        start = 40 - 4 * k
        other = still._change(wide[:, start : start + 160].copy(), k / 15.0, Odometry(), mount)
    assert change[20:100, 40:120].mean() < 0.5 * other[20:100, 40:120].mean()
