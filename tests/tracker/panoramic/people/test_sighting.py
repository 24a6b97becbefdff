import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.panoramic.people.floor_motion import FloorMotion
from peopleboy.tracker.panoramic.people.panoramic_config import SightingConfig
from peopleboy.tracker.panoramic.people.panoramic_observation import Onlooker
from tests.helpers.images.cardboard import Cardboard, CardboardModel, scene_of

POSE = Pose2().integrate(Pose2(2.0, -1.0, 0.7))
BEARINGS, DISTANCES = st.floats(-math.pi, math.pi), st.floats(1.5, 5.0)


def onlooker(**config):
    return Onlooker(CardboardModel(), POSE, SightingConfig(**config))


def motion_at(distance, bearing, deviation=0.2):
    return FloorMotion.begin(POSE.transform_polar(distance, bearing), deviation**2 * np.eye(2))


@settings(max_examples=30)
@given(BEARINGS, DISTANCES, st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
def test_who_is_expected_nearby_is_seen_where_it_stands(bearing, distance, along, across):
    expected = motion_at(distance + along, bearing + across / distance)
    seen = onlooker().expected(expected, scene_of([Cardboard(distance, bearing)]))
    assert seen is not None
    assert np.linalg.norm(seen.place_m - POSE.transform_polar(distance, bearing)) < 0.15
    # All ways of telling the place say the same.
    np.testing.assert_allclose(seen.place_m, POSE.transform_polar(seen.distance_m, seen.bearing_rad))
    away = seen.place_m - (POSE.x, POSE.y)
    along, across = away / np.linalg.norm(away), np.array([-away[1], away[0]]) / np.linalg.norm(away)
    assert along @ seen.error_m2 @ across == pytest.approx(0.0, abs=1e-6)
    believed = along @ seen.error_m2 @ along, across @ seen.error_m2 @ across
    assert believed[0] / believed[1] == pytest.approx((0.08 / 0.05) ** 2, rel=1e-4)


@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0))
def test_bearing_and_distance_lead_back_to_the_place(x, y):
    bearing, distance = onlooker().polar(np.array([x, y]))
    if distance > 0.5:
        np.testing.assert_allclose(POSE.transform_polar(distance, bearing), [x, y], atol=1e-9)
    assert distance >= 0.5


def test_nobody_is_seen_where_nobody_is():
    assert onlooker().expected(motion_at(3.0, 0.5), scene_of([])) is None
    assert onlooker().at(scene_of([Cardboard(3.0, -2.0)]), np.array([[0.5, 3.0]])) is None


def test_who_is_seen_too_far_from_where_somebody_was_expected_is_somebody_else():
    scene = scene_of([Cardboard(3.0, 0.5)])
    near = motion_at(3.0, 0.5 + 0.25 / 3.0, deviation=0.02)
    assert onlooker(gate=1e9).expected(near, scene) is not None
    assert onlooker(gate=16.0).expected(near, scene) is None


def test_who_may_be_anywhere_nearby_is_looked_for_round_about():
    scene = scene_of([Cardboard(3.0, 0.5)])
    beside = motion_at(3.0, 0.5 + 0.5 / 3.0, deviation=0.5)
    assert onlooker().expected(beside, scene) is not None


def test_too_little_evidence_is_nobody():
    scene, polar = scene_of([Cardboard(3.0, 0.5)]), np.array([[0.5, 3.0]])
    seen = onlooker().at(scene, polar)
    assert seen is not None
    assert onlooker(least_evidence=seen.evidence + 0.1).at(scene, polar) is None


@pytest.mark.parametrize("distance", [2.0, 4.0])
def test_of_two_who_stand_behind_each_other_each_is_seen_at_its_own_place(distance):
    people = [Cardboard(distance, 1.0), Cardboard(distance + 1.5, 1.0 + 0.45 / distance)]
    scene = scene_of(people)
    for one in people:
        seen = onlooker().expected(motion_at(one.distance_m, one.bearing_rad), scene)
        assert seen is not None
        assert seen.distance_m == pytest.approx(one.distance_m, abs=0.25)
        scene.cover(seen.bearing_rad, seen.distance_m)
