import math

import numpy as np
import pytest

from benchmarks.prediction.prediction_metrics import (
    ELLIPSE_95,
    TIMES_S,
    score_predictions,
    squared_mahalanobis,
)
from peopleboy.tracker.prediction import Floats, Forecast, predict_positions
from peopleboy.tracker.track import FloorPlace

AFTER_S = np.array([0.2, 1.0, 2.5, 5.0])


def place(at_m: Floats, velocity_m_s: Floats) -> FloorPlace:
    return FloorPlace(
        position_m=(at_m[0], at_m[1]),
        covariance_m2=(0.02, 0.0, 0.02),
        velocity_m_s=(velocity_m_s[0], velocity_m_s[1]),
        velocity_covariance_m2_s2=(0.01, 0.0, 0.01),
    )


def walking(turn_rad: float = 0.0) -> list[FloorPlace]:
    """Return people who walk in two directions, turned about the robot."""
    turn = rotation(turn_rad)
    return [
        place(turn @ (4.0, -0.1), turn @ (-1.0, 0.0)),
        place(turn @ (3.0, 0.1), turn @ (0.6, 0.8)),
    ]


def rotation(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def test_people_walk_straight_on() -> None:
    found = predict_positions(walking(), AFTER_S)
    assert found.mean_m[1] == pytest.approx(np.array([3.0, 0.1]) + np.outer(AFTER_S, (0.6, 0.8)))


def test_predictions_do_not_depend_on_the_direction_of_the_robot() -> None:
    turn = rotation(0.7)
    straight, turned = (predict_positions(walking(angle), AFTER_S) for angle in (0.0, 0.7))
    assert turned.mean_m == pytest.approx(straight.mean_m @ turn.T)
    assert turned.covariance_m2 == pytest.approx(turn @ straight.covariance_m2 @ turn.T)


def test_covariances_begin_with_that_of_the_track_and_grow_most_along_the_path() -> None:
    found = predict_positions(walking(), np.array([1e-9, 1.0, 5.0])).covariance_m2[0]
    assert found[0] == pytest.approx(0.02 * np.eye(2))
    assert (np.linalg.eigvalsh(np.diff(found, axis=0)) > 0.0).all()
    assert found[1, 0, 0] > found[1, 1, 1]


def test_a_person_without_a_velocity_stands_but_less_surely() -> None:
    unknown = FloorPlace(position_m=(4.0, 1.0), covariance_m2=(0.02, 0.0, 0.02))
    known = place(np.array([4.0, 1.0]), np.zeros(2))
    found, sure = predict_positions([unknown], AFTER_S), predict_positions([known], AFTER_S)
    assert found.mean_m == pytest.approx(sure.mean_m)
    assert (np.linalg.eigvalsh(found.covariance_m2 - sure.covariance_m2) > 0.0).all()


def test_a_scene_without_people_has_no_predictions() -> None:
    found = predict_positions([], AFTER_S)
    assert found.mean_m.shape == (0, len(AFTER_S), 2)
    assert found.covariance_m2.shape == (0, len(AFTER_S), 2, 2)


def test_scores_of_known_errors() -> None:
    error_m = np.repeat([[0.5], [3.0]], len(TIMES_S), axis=1)
    error_m[1, 10:] = np.nan  # the second person leaves after 2 s
    scores = score_predictions(error_m, np.where(error_m < 1.0, 1.0, 2.0 * ELLIPSE_95))
    assert tuple(scores[2.0]) == pytest.approx((2, 1.75, 1.75, 0.5, 0.5))
    assert tuple(scores[5.0]) == pytest.approx((1, 0.5, 0.5, 0.0, 1.0))


def test_mahalanobis_distances() -> None:
    forecast = Forecast(np.zeros((1, 1, 2)), np.array([[[[4.0, 0.0], [0.0, 1.0]]]]))
    assert squared_mahalanobis(forecast, np.array([[[2.0, 1.0]]])) == pytest.approx(2.0)
