"""Tests of floor positions as measurements of the motion filter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.tracking.config import STATURE_M, KalmanConfig
from peopleboy.tracker.tracking.measurement import FloorMeasurement

CONFIG = KalmanConfig()
FLOOR_M = 1.2
SENSOR_M = np.array([0.1, -0.05])


def measured(
    x_m: float,
    z_m: float,
    head_m: float = STATURE_M,
    deviations: tuple[float, float, float] = (0.05, 0.1, 0.08),
) -> FloorMeasurement:
    return FloorMeasurement(
        np.array([[x_m, z_m]]), np.array([head_m]), np.array([deviations]), SENSOR_M, FLOOR_M, CONFIG
    )


@given(st.floats(-3.0, 3.0), st.floats(1.0, 9.0))
def test_a_new_state_lies_where_it_was_measured_and_is_least_certain_along_the_line_of_sight(
    x_m: float, z_m: float
) -> None:
    states = measured(x_m, z_m).initiate([0])
    assert states.mean[0, :3] == pytest.approx([x_m, FLOOR_M, z_m])
    sight = np.array([x_m, z_m]) - SENSOR_M
    sight /= np.hypot(*sight)
    spread = states.covariance[0][np.ix_((0, 2), (0, 2))]
    assert sight @ spread @ sight == pytest.approx(0.1**2)
    assert np.linalg.eigvalsh(spread) == pytest.approx([0.05**2, 0.1**2])


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.1, 0.1))
def test_a_state_is_updated_as_by_a_kalman_filter(right_m: float, ahead_m: float, taller_m: float) -> None:
    states = measured(0.5, 5.0).initiate([0])
    seen = measured(0.5 + right_m, 5.0 + ahead_m, STATURE_M + taller_m)
    away = seen.places_m[0] - SENSOR_M
    sight = away / np.hypot(*away)
    across = np.array([sight[1], -sight[0]])
    slope = np.zeros((4, 7))
    slope[0, (0, 2)], slope[1, (0, 2)] = across, sight
    stature = STATURE_M * math.exp(states.mean[0, 6])
    slope[2, 1], slope[2, 6], slope[3, 1] = 1.0, -stature, 1.0
    expected = slope @ states.mean[0]
    expected[2] = states.mean[0, 1] - stature
    values = np.array(
        [across @ seen.places_m[0], sight @ seen.places_m[0], FLOOR_M - seen.heads_m[0], FLOOR_M]
    )
    noise = np.diag(np.square([0.05, 0.1, 0.08, CONFIG.floor_m]))
    covariance = states.covariance[0]
    gain = covariance @ slope.T @ np.linalg.inv(slope @ covariance @ slope.T + noise)
    later = seen.update(states, [0])
    assert later.mean[0] == pytest.approx(states.mean[0] + gain @ (values - expected), abs=1e-6)
    assert later.covariance[0] == pytest.approx((np.eye(7) - gain @ slope) @ covariance, abs=1e-6)


def test_the_farther_off_a_position_is_the_greater_is_its_distance() -> None:
    states = measured(0.0, 5.0).initiate([0])
    own, aside, behind = (measured(x, z).distances(states)[0, 0] for x, z in ((0, 5), (0.3, 5), (0, 5.3)))
    assert own == pytest.approx(0.0, abs=0.05)
    assert own < behind < aside
