from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame, Odometry
from peopleboy.tracker.sensors.own_detector import OwnDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.tracking.camera_motion import (
    STANDING,
    CameraMotion,
    FrameMotion,
    rotation_between,
    seen_homography,
)
from peopleboy.tracker.tracking.config import KalmanConfig
from peopleboy.tracker.tracking.measurement import BoxMeasurement
from peopleboy.tracker.tracking.motion_filter import predict
from peopleboy.tracker.tracking.people_tracker import PeopleTracker
from peopleboy.tracker.tracking.viewpoint import Viewpoint

ROWS, COLUMNS = SHAPE = 240, 320
CONFIG = KalmanConfig()
Grey = np.ndarray


def shifted(right: float, down: float) -> np.ndarray:
    return np.array([[1.0, 0.0, right], [0.0, 1.0, down], [0.0, 0.0, 1.0]])


def facade() -> Grey:
    """A wide image with something to follow everywhere."""
    rough = np.random.default_rng(4).integers(0, 256, (40, 160)).astype(np.uint8)
    return np.asarray(cv2.resize(rough, (1280, ROWS), interpolation=cv2.INTER_CUBIC), np.uint8)


@pytest.mark.parametrize(("right", "down"), [(7.0, 0.0), (0.0, -3.0), (-5.0, 2.0)])
def test_boxes_are_predicted_where_the_image_moves_them(right: float, down: float) -> None:
    view = Viewpoint.of(None, SHAPE)
    boxes = np.array([[150.0, 90.0, 20.0, 70.0], [130.0, 80.0, 15.0, 50.0]])
    states = BoxMeasurement(boxes, view, CONFIG).initiate(range(2))
    moved = predict(states, 0.0, rotation_between(shifted(right, down), SHAPE), CONFIG)
    before, after = (view.seen(one.mean[:, :3], one.mean[:, 6]) for one in (states, moved))
    np.testing.assert_allclose(after - before, np.tile([right, down, down], (2, 1)), atol=0.35)


def test_a_camera_that_rolls_turns_the_image_about_its_middle() -> None:
    roll = 0.1
    about = np.vstack([cv2.getRotationMatrix2D((159.5, 119.5), math.degrees(-roll), 1.0), [0, 0, 1]])
    assert rotation_between(about, SHAPE) is STANDING  # the middle stays
    turn = rotation_between(shifted(3.0, 0.0) @ about, SHAPE).turn
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    ahead, right = turn @ [0.0, 0.0, 1.0], turn @ [1.0, 0.0, 0.0]
    assert ahead[0] > 0.0
    assert math.atan2(right[1], right[0]) == pytest.approx(roll, abs=2e-3)


def test_odometry_counts_more_than_images() -> None:
    wide, motion = facade(), CameraMotion()
    frames = [
        Frame(images={THERMAL: wide[:, left : left + COLUMNS]}, time_s=k / 30, odometry=odometry)
        for k, (left, odometry) in enumerate([(0, None), (6, None), (12, Odometry(turn_rad=0.3))])
    ]
    first, second, third = map(motion.update, frames)
    assert first is STANDING
    assert (second.turn @ [0.0, 0.0, 1.0])[0] < 0.0  # what the camera turned away from is to the left
    np.testing.assert_array_equal(third.turn, FrameMotion.of(Odometry(turn_rad=0.3)).turn)


class Panned:
    """Detects one person, who stands on a facade that a camera pans along."""

    def __init__(self) -> None:
        self.left = 500.0

    def detect(self, image: Grey) -> tuple[Grey, Grey]:  # noqa: ARG002
        self.left -= 6.0
        return np.array([[self.left - 300.0, 80.0, 16.0, 60.0]]), np.array([0.99])


def test_a_person_before_a_camera_that_pans_is_one_person() -> None:
    wide = facade()
    tracker = PeopleTracker((ThermalSensor(detector=OwnDetector(Panned())),))
    ids = set()
    for k in range(30):
        left = 300 + 6 * k
        tracks = tracker.update(Frame(images={THERMAL: wide[:, left : left + COLUMNS]}, time_s=k / 30))
        ids |= {track.id for track in tracks}
        if k > 10:
            assert len(tracks) == 1
            assert tracks[0].boxes[THERMAL][0] == pytest.approx(500.0 - 6.0 * (k + 1) - 300.0, abs=2.0)
    assert len(ids) == 1


def speckled() -> Grey:
    rough = np.random.default_rng(4).integers(0, 256, (30, 40)).astype(np.uint8)
    return np.asarray(cv2.resize(rough, (160, 120), interpolation=cv2.INTER_CUBIC), np.uint8)


@pytest.mark.parametrize(
    ("right", "down", "turn_rad"), [(0, 0, 0.0), (6, 0, 0.0), (-4, 2, 0.03), (12, -5, -0.02)]
)
def test_the_motion_of_the_camera_is_seen_though_people_walk(right: int, down: int, turn_rad: float) -> None:
    about = cv2.getRotationMatrix2D((80.0, 60.0), math.degrees(turn_rad), 1.0)
    about[:, 2] += right, down
    now = np.asarray(cv2.warpAffine(speckled(), about, (160, 120)), np.uint8)
    before = speckled()
    before[40:100, 60:80], now[40:100, 63:83] = 240, 240
    found = np.array([[20.0, 20.0, 1.0], [140.0, 100.0, 1.0]]) @ seen_homography(before, now)[:2].T
    expected = np.array([[20.0, 20.0, 1.0], [140.0, 100.0, 1.0]]) @ about.T
    np.testing.assert_allclose(found, expected, atol=0.3)


@pytest.mark.parametrize("other", ["unlike", "flat"])
def test_images_with_nothing_in_common_show_no_motion(other: str) -> None:
    unlike = np.random.default_rng(9).integers(0, 256, (120, 160)).astype(np.uint8)
    flat = np.full_like(unlike, 90)
    after = unlike if other == "unlike" else flat
    np.testing.assert_array_equal(seen_homography(speckled(), after), np.eye(3))
    np.testing.assert_array_equal(seen_homography(flat, after), np.eye(3))


def test_people_who_walk_past_do_not_move_a_standing_camera() -> None:
    before = speckled()
    now = before.copy()
    now[20:, 8:110] = before[20:, :102]  # most of the image walks to the right
    np.testing.assert_array_equal(seen_homography(before, now), np.eye(3))
