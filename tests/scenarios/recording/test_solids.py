from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from peopleboy.scenarios.recording.solids import (
    body_capsules,
    fixture_solids,
    group_fixtures,
    turn_z_to,
    urdf_solids,
)
from peopleboy.sim.places.extent import fixture_extent
from peopleboy.sim.robot.robot_body import URDF
from peopleboy.sim.shapes.shapes import ShapeKind
from tests.helpers.runs import synthetic_ticks as made


@given(arrays(np.float64, (5, 3), elements=st.floats(-2.0, 2.0)))
def test_the_turn_takes_z_to_the_axis(axis: np.ndarray) -> None:
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    long = length[:, 0] > 1e-6
    turned = Rotation.from_quat(turn_z_to(axis)).apply([0.0, 0.0, 1.0])
    assert turned[long] == pytest.approx((axis / np.maximum(length, 1e-6))[long], abs=1e-4)


def test_a_body_is_as_tall_and_as_wide_as_a_person() -> None:
    body = body_capsules(made.joints(4.0, 1.0))
    ends = body.start + Rotation.from_quat(body.quaternion).apply([0.0, 0.0, 1.0]) * body.length[:, None]
    points = np.concatenate([body.start, ends])
    radius = np.concatenate([body.radius, body.radius])[:, None]
    low, high = (points - radius).min(axis=0), (points + radius).max(axis=0)
    assert 1.7 < high[2] < 1.9
    assert -0.1 < low[2] < 0.08
    assert 0.4 < high[1] - low[1] < 0.7


def test_the_robot_is_as_high_and_wide_as_its_urdf_says() -> None:
    solids = urdf_solids(URDF)
    boxes = [solid for solid in solids if solid.kind is ShapeKind.BOX]
    assert max(solid.position[2] + solid.size[2] / 2.0 for solid in boxes) == pytest.approx(1.22)
    wheels = [solid for solid in solids if solid.kind is ShapeKind.CYLINDER]
    assert sorted(wheel.position[1] for wheel in wheels) == pytest.approx([-0.1665, 0.1665])
    assert {wheel.size[1] for wheel in wheels} == {0.0825}
    for wheel in wheels:
        axis = Rotation.from_quat(wheel.orientation).apply([0.0, 0.0, 1.0])
        assert abs(axis[1]) == pytest.approx(1.0)


def test_walls_floor_and_ceiling_fill_the_extents_of_their_fixtures() -> None:
    for fixture in made.config().place.fixtures:
        (solid,) = fixture_solids(fixture)
        low, high = fixture_extent(fixture)
        assert np.subtract(solid.position, np.divide(solid.size, 2.0)) == pytest.approx(low)
        assert np.add(solid.position, np.divide(solid.size, 2.0)) == pytest.approx(high)


def test_fixtures_are_grouped_by_what_they_are() -> None:
    groups = group_fixtures(made.config().place.fixtures)
    assert set(groups) == {"floor", "ceiling", "walls"}
    assert len(groups["walls"]) == 4
