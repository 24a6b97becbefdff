from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.physics.urdf import find_urdf
from peopleboy.sim.places.extent import fixture_extent, urdf_extent
from peopleboy.sim.places.furniture.place_things import build_thing
from peopleboy.sim.places.furniture.thing_config import KINDS, ThingConfig
from peopleboy.sim.places.moving import Stance
from peopleboy.sim.places.pieces import SINK_M
from peopleboy.sim.places.place import Fixture
from tests.helpers.calls.refused import refused
from tests.helpers.worlds.boxes import Box, fighting_faces, piece_boxes

HERE = Stance((0.0, 0.0, 0.0), 0.0)
kinds = pytest.mark.parametrize("kind", KINDS)


def around(fixtures: tuple[Fixture, ...]) -> np.ndarray:
    extents = np.array([fixture_extent(fixture) for fixture in fixtures])
    return np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])


@kinds
def test_a_thing_has_the_size_that_it_is_given(kind: str) -> None:
    size = KINDS[kind].size_m
    low, high = around(build_thing(ThingConfig(kind=kind), HERE, name="x"))
    assert high - low == pytest.approx(size, abs=0.09)
    assert high[2] == pytest.approx(size[2], abs=0.02)


@kinds
def test_what_stands_reaches_into_the_floor_and_what_hangs_into_the_wall(kind: str) -> None:
    low, _ = around(build_thing(ThingConfig(kind=kind), HERE, name="x"))
    if KINDS[kind].is_hung:
        assert -2 * SINK_M <= low[0] <= 0.03
    elif not KINDS[kind].is_from_ceiling:
        assert -2 * SINK_M <= low[2] < 0.0


@kinds
def test_no_two_visible_faces_of_a_thing_lie_in_one_plane_and_overlap(kind: str) -> None:
    boxes = piece_boxes(build_thing(ThingConfig(kind=kind), HERE, name="x"))
    floor = Box("floor", np.array([-9.0, -9.0, -9.0]), np.array([9.0, 9.0, 0.0]))
    wall = Box("wall", np.array([-9.0, -9.0, -9.0]), np.array([0.0, 9.0, 9.0]))
    assert fighting_faces([*boxes, wall if KINDS[kind].is_hung else floor]) == []


@kinds
def test_a_thing_fits_into_bodies_of_sixteen_shapes_with_names_of_their_own(kind: str) -> None:
    fixtures = build_thing(ThingConfig(kind=kind), HERE, name="x")
    assert len({fixture.name for fixture in fixtures}) == len(fixtures)
    for fixture in fixtures:
        assert fixture.part is not None
        assert 1 <= len(fixture.part.shapes) <= 16
        assert fixture.name.split("/")[0] == "x"


@pytest.mark.parametrize(
    ("kind", "low_c", "high_c"),
    [
        ("radiator", 40, 55),
        ("ceiling_lamp", 60, 90),
        ("floor_lamp", 60, 90),
        ("monitor", 32, 38),
        ("robot", 26, 30),
    ],
)
def test_warm_things_are_as_warm_as_such_things_are(kind: str, low_c: float, high_c: float) -> None:
    fixtures = build_thing(ThingConfig(kind=kind), HERE, name="x")
    temperatures = [f.part.material.temperature_c for f in fixtures if f.part is not None]
    assert low_c <= temperatures[0] <= high_c
    assert max(temperatures) <= high_c


@given(
    st.sampled_from(sorted(KINDS)),
    st.floats(-math.pi, math.pi),
    st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)),
)
def test_turning_and_moving_a_thing_moves_the_middle_of_its_front(
    kind: str, facing: float, at: tuple[float, float]
) -> None:
    home = build_thing(ThingConfig(kind=kind), HERE, name="x")
    away = build_thing(ThingConfig(kind=kind), Stance((*at, 0.0), facing), name="x")
    for a, b in zip(home, away, strict=True):
        assert a.part == b.part
        assert b.position[:2] == at
        x, y, z, w = b.orientation
        assert (x, y) == (0.0, 0.0)
        assert math.remainder(2.0 * math.atan2(z, w) - facing, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_the_extent_of_a_urdf_is_that_of_its_table_top_and_legs() -> None:
    low, high = urdf_extent(find_urdf("table/table.urdf"))
    assert low == pytest.approx([-0.75, -0.5, 0.0], abs=0.01)
    assert high == pytest.approx([0.75, 0.5, 0.625], abs=0.01)


def test_furniture_of_many_links_is_measured_in_its_rest_pose() -> None:
    # Clearpath's data sheet of the Husky: 990 x 670 x 390 mm.
    low, high = urdf_extent(find_urdf("husky/husky.urdf"))
    assert high - low == pytest.approx([0.99, 0.67, 0.39], abs=0.06)


def test_a_file_without_shapes_is_no_furniture(tmp_path: Path) -> None:
    path = tmp_path / "bare.urdf"
    path.write_text('<robot name="bare"><link name="base"/></robot>')
    with refused(path):
        urdf_extent(path)
