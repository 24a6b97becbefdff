from __future__ import annotations

import numpy as np
import pytest

from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.shapes.bounds import FAR_M
from tests.helpers.some_of import some_of
from tests.helpers.worlds.boxes import fighting_faces, first_hit, upright_boxes

some_scenarios = pytest.mark.parametrize(
    "name", some_of(sorted(path.stem for path in LIBRARY.glob("*.yaml")), 4)
)


@some_scenarios
def test_no_two_visible_faces_in_a_place_lie_in_one_plane_and_overlap(name: str) -> None:
    boxes = upright_boxes(load_scenario(name).place.fixtures)
    owner = {box.name: box.name.split("#")[0] for box in boxes}
    assert [pair for pair in fighting_faces(boxes) if owner[pair[0]] != owner[pair[1]]] == []


@pytest.mark.slow
@some_scenarios
def test_everything_that_the_robot_sees_from_its_start_is_a_surface(name: str) -> None:
    scenario = load_scenario(name)
    boxes = upright_boxes(scenario.place.fixtures)
    rng = np.random.default_rng(1)
    eye = np.array([*scenario.robot.at_m, 1.2])
    assert all(first_hit(boxes, eye, direction) < FAR_M for direction in rng.normal(size=(40, 3)))


@some_scenarios
def test_temperatures_are_those_of_rooms_and_of_warm_things(name: str) -> None:
    scenario = load_scenario(name)
    fixtures, air_c = scenario.place.fixtures, scenario.spec.place.temperatures.air_c
    low, high = (18.0, 26.0) if air_c is None else (air_c - 9.0, air_c + 5.0)
    materials = {f.name: f.part.material if f.part is not None else f.material for f in fixtures}
    shell = [
        material.temperature_c
        for n, material in materials.items()
        if material and (n in ("floor", "ceiling") or n.startswith("wall_"))
    ]
    assert all(low <= temperature <= high for temperature in shell)
    coldest = 14.0 if air_c is None else air_c - 9.0
    assert all(
        material is not None and coldest <= material.temperature_c <= 80.0 for material in materials.values()
    )


@some_scenarios
def test_every_fixture_has_a_name_of_its_own(name: str) -> None:
    names = [fixture.name for fixture in load_scenario(name).place.fixtures]
    assert len(set(names)) == len(names)
