import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.prediction.motion_network import MotionNetwork
from peopleboy.tracker.prediction.prediction_metrics import (
    ELLIPSE_95,
    TIMES_S,
    score_predictions,
    squared_mahalanobis,
)
from peopleboy.tracker.prediction.predictors import PREDICTORS, make_predictor
from peopleboy.tracker.prediction.tracked_people import STEPS, Floats, Forecast, PathMemory, TrackedPeople
from peopleboy.tracker.track import FloorPlace, Status, Track

AFTER_S = np.array([0.2, 1.0, 2.5, 5.0])
ALL = tuple(PREDICTORS)


def track(
    key: int,
    at_m: tuple[float, float],
    velocity_m_s: tuple[float, float] | None = None,
    status: Status = Status.TRACKED,
) -> Track:
    spread = None if velocity_m_s is None else (0.01, 0.0, 0.01)
    place = FloorPlace(
        position_m=at_m,
        covariance_m2=(0.02, 0.0, 0.02),
        velocity_m_s=velocity_m_s,
        velocity_covariance_m2_s2=spread,
    )
    return Track(id=key, place=place, confidence=1.0, age_s=1.0, status=status)


def walking(turn_rad: float = 0.0, *, aside_m: float = 0.0) -> TrackedPeople:
    """Return two people after 2 s of walking with 1 m/s in opposite directions, turned about the robot."""
    memory, turn = PathMemory(), rotation(turn_rad)
    for frame in range(31):
        now = frame / 15.0
        ways = ((6.0 - now, -0.1 + aside_m), (-1.0, 0.0)), ((1.0 + now, 0.1), (1.0, 0.0))
        tracks = [
            track(key, tuple(turn @ at), tuple(turn @ velocity)) for key, (at, velocity) in enumerate(ways, 1)
        ]
        people = memory.update(tracks, now, None)
    return people


def rotation(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def test_paths_stand_still_on_the_floor_while_the_robot_drives_and_turns() -> None:
    memory, step = PathMemory(), Odometry(advance_m=0.05, aside_m=0.01, turn_rad=0.03)
    pose = Odometry().motion
    for frame in range(40):
        moved = None if frame == 0 else step
        pose = pose if frame == 0 else pose.integrate(step.motion)
        people = memory.update([track(7, pose.to_local((4.0, 1.0)))], frame / 15.0, moved)
    assert np.abs(people.path_m - people.position_m[:, None]).max() < 0.02  # of a circle between two instants
    assert np.hypot(*people.velocity_m_s[0]) < 0.02
    assert people.robot_m_s == pytest.approx((0.75, 0.15))


def test_a_velocity_that_is_not_reported_is_that_of_the_path() -> None:
    memory = PathMemory()
    for frame in range(31):
        people = memory.update([track(1, (1.0 + frame / 15.0, 2.0))], frame / 15.0, None)
    assert people.velocity_m_s == pytest.approx(np.array([[1.0, 0.0]]))
    assert np.isfinite(people.path_m).all()


def test_a_new_track_has_no_past_and_tentative_ones_are_left_out() -> None:
    tracks = [track(1, (1.0, 0.0)), track(2, (2.0, 0.0), status=Status.TENTATIVE)]
    people = PathMemory().update(tracks, 0.0, None)
    assert people.ids.tolist() == [1]
    assert np.isfinite(people.path_m).sum() == 2
    assert people.path_m.shape == (1, STEPS, 2)


@pytest.mark.parametrize("name", ALL)
def test_predictions_do_not_depend_on_the_direction_of_the_robot(name: str) -> None:
    model, turn = make_predictor(name), rotation(0.7)
    straight, turned = (model.predict(walking(angle), AFTER_S) for angle in (0.0, 0.7))
    assert turned.mean_m == pytest.approx(straight.mean_m @ turn.T, abs=1e-4)
    assert turned.covariance_m2 == pytest.approx(turn @ straight.covariance_m2 @ turn.T, rel=1e-3, abs=1e-4)


@pytest.mark.parametrize("name", ALL)
def test_covariances_are_valid_and_grow(name: str) -> None:
    found = make_predictor(name).predict(walking(), AFTER_S)
    areas = np.linalg.det(found.covariance_m2)
    assert (np.linalg.eigvalsh(found.covariance_m2) > 0.0).all()
    assert (areas[:, -1] > areas[:, 1]).all()


@pytest.mark.parametrize("name", ALL)
def test_a_scene_without_people_has_no_predictions(name: str) -> None:
    found = make_predictor(name).predict(PathMemory().update([], 0.0, None), AFTER_S)
    assert found.mean_m.shape == (0, len(AFTER_S), 2)
    assert found.covariance_m2.shape == (0, len(AFTER_S), 2, 2)


def test_constant_velocity_goes_straight_on() -> None:
    people = walking()
    found = make_predictor("constant-velocity").predict(people, AFTER_S)
    assert found.mean_m[0] == pytest.approx(people.position_m[0] + np.outer(AFTER_S, (-1.0, 0.0)))


def test_people_on_a_collision_course_give_way_by_social_force_and_others_do_not() -> None:
    def aside_m(gap_m: float) -> float:
        found = make_predictor("social-force").predict(walking(aside_m=gap_m), TIMES_S)
        return float(np.abs(found.mean_m[0, :, 1] - (gap_m - 0.1)).max())

    assert aside_m(0.0) > 0.1
    assert aside_m(9.0) < 0.01


def test_an_unknown_predictor_is_refused() -> None:
    with pytest.raises(BadInput, match=r"unknown predictor 'learnt'.*learned"):
        make_predictor("learnt")


def test_weights_are_small_and_foreign_ones_are_refused(tmp_path: Path) -> None:
    MotionNetwork.load().save(tmp_path / "motion.npz")
    assert (tmp_path / "motion.npz").stat().st_size < 100_000
    np.savez(tmp_path / "other.npz", first=np.zeros(3))
    with pytest.raises(BadInput, match="peopleboy train motion"):
        MotionNetwork.load(tmp_path / "other.npz")


def test_scores_of_known_errors() -> None:
    error_m = np.repeat([[0.5], [3.0]], len(TIMES_S), axis=1)
    error_m[1, 10:] = np.nan  # the second person leaves after 2 s
    scores = score_predictions(error_m, np.where(error_m < 1.0, 1.0, 2.0 * ELLIPSE_95))
    assert tuple(scores[2.0]) == pytest.approx((2, 1.75, 1.75, 0.5, 0.5))
    assert tuple(scores[5.0]) == pytest.approx((1, 0.5, 0.5, 0.0, 1.0))


def test_mahalanobis_distances() -> None:
    forecast = Forecast(np.zeros((1, 1, 2)), np.array([[[[4.0, 0.0], [0.0, 1.0]]]]))
    assert squared_mahalanobis(forecast, np.array([[[2.0, 1.0]]])) == pytest.approx(2.0)
