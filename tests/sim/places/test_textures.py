from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.sim.places.place import Place
from peopleboy.sim.places.textures.sunlight import _shade
from peopleboy.sim.places.textures.surface_texture import draw_clouds
from peopleboy.sim.places.textures.texture_place import paint_place
from peopleboy.sim.shapes.materials import Painting
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.calls.refused import refused

ROOM: dict[str, Any] = {
    "name": "room",
    "description": "A room.",
    "duration_s": 1.0,
    "detail": "full",
    "place": {"kind": "room", "length_m": 6.0, "width_m": 5.0},
    "things": [
        {"kind": "window", "name": "pane", "wall": "north", "along_m": 3.0, "size_m": [0.05, 1.4, 1.2]}
    ],
    "robot": {"at_m": [0.6, 0.0]},
}


def place(tmp_path: Any, **changes: Any) -> Place:
    return parse_scenario(ROOM | changes, source="room.yaml", folder=tmp_path).place


def same(a: Painting, b: Painting) -> bool:
    return np.array_equal(a.kelvin, b.kelvin) and np.array_equal(a.light, b.light)


def at(painting: Painting, across: float, up: float) -> tuple[float, float]:
    """What a painting adds [K], and its light, at a point of the part's frame [m]."""
    column, row = (
        round((x - o) / painting.texel_m) for x, o in zip((across, up), painting.origin_m, strict=True)
    )
    return float(painting.kelvin[row, column]), float(painting.light[row, column])


def test_clouds_have_deviation_one_and_meet_themselves_at_the_seam() -> None:
    square = draw_clouds(np.random.default_rng(1)).square
    assert square.std() == pytest.approx(1.0)
    seam, inside = np.abs(square[:, 0] - square[:, -1]).mean(), np.abs(np.diff(square, axis=1)).mean()
    assert seam < 1.5 * inside


def test_the_same_seed_paints_the_same_place_and_another_seed_another(tmp_path: Any) -> None:
    first, again, other = (paint_place(place(tmp_path), seed) for seed in (1, 1, 2))
    assert all(same(first[name], again[name]) for name in first)
    assert not any(same(first[name], other[name]) for name in first)


def test_a_thing_more_changes_no_wall_that_it_is_far_from(tmp_path: Any) -> None:
    radiator = {"kind": "radiator", "wall": "east", "along_m": 0.0}
    without = paint_place(place(tmp_path), 1)
    with_one = paint_place(place(tmp_path, things=[*ROOM["things"], radiator]), 1)
    changed = {name for name in without if not same(without[name], with_one[name])}
    assert "wall_east/3" in changed
    assert not changed & {"wall_north/1", "wall_south/2", "wall_west/4"}


def test_a_radiator_warms_the_wall_above_it_more_than_beside_it(tmp_path: Any) -> None:
    radiator = {"kind": "radiator", "wall": "east", "along_m": 0.0}
    without = paint_place(place(tmp_path), 1)["wall_east/3"].kelvin
    more = paint_place(place(tmp_path, things=[*ROOM["things"], radiator]), 1)["wall_east/3"].kelvin - without
    assert more.max() > 2.0
    middle = more.shape[1] // 2
    plume = more[:, middle]
    assert plume[60] > plume[90] > 0.0  # about 1.5 m and 2.2 m above the floor
    assert abs(more[60, 4]) < 0.01


def test_the_sun_lights_the_floor_where_rays_through_the_pane_meet_it(tmp_path: Any) -> None:
    sun = {"azimuth_deg": 90.0, "elevation_deg": 45.0, "warms_k": 10.0, "brightens": 1.0}
    dark = paint_place(place(tmp_path), 1)["floor"]
    lit = paint_place(place(tmp_path, place=ROOM["place"] | {"sun": sun}), 1)["floor"]
    # The pane reaches from 0.95 to 2.15 m above the floor in the wall at y = 2.5: 45 degrees put that
    # between y = 1.55 and y = 0.35; the floor's own frame has its origin at x = 3.
    for y, is_lit in ((2.2, False), (1.4, True), (0.95, True), (0.5, True), (0.1, False)):
        kelvin = at(lit, 0.3, y)[0] - at(dark, 0.3, y)[0]
        light = at(lit, 0.3, y)[1] / at(dark, 0.3, y)[1]
        assert light == pytest.approx(2.0 if is_lit else 1.0, abs=0.01)
        assert (kelvin > 5.0) == is_lit
    assert at(lit, 1.5, 0.95)[1] / at(dark, 1.5, 0.95)[1] == pytest.approx(1.0, abs=0.01)


def test_what_stands_in_the_sun_casts_a_shadow(tmp_path: Any) -> None:
    sun = {"azimuth_deg": 90.0, "elevation_deg": 45.0}
    block = {"kind": "block", "at_m": [3.3, 1.5], "size_m": [0.4, 0.2, 0.6]}
    inside = ROOM["place"] | {"sun": sun}
    free = paint_place(place(tmp_path, place=inside), 1)["floor"]
    shaded = paint_place(place(tmp_path, place=inside, things=[*ROOM["things"], block]), 1)["floor"]
    assert at(shaded, 0.3, 1.1)[1] == pytest.approx(at(free, 0.3, 1.1)[1] / 1.9, rel=0.01)


@pytest.mark.slow
def test_the_sky_over_a_street_is_colder_the_steeper_one_looks() -> None:
    paintings = paint_place(load_scenario("street_evening").place, 3)
    horizon, overhead = paintings["wall_horizon/south"].kelvin, paintings["ceiling"].kelvin
    assert np.median(horizon[len(horizon) // 2]) > np.median(overhead) + 2.0
    assert np.median(horizon[:10]) > np.median(horizon[-10:])  # trees and houses are as warm as the air


def test_a_plain_world_has_no_paintings(tmp_path: Any) -> None:
    scenario = parse_scenario(ROOM | {"detail": "plain"}, source="room.yaml", folder=tmp_path)
    with SimulatedWorld(scenario.world(0)) as world:
        assert world.materials.paint_texels.size == 0


def test_what_is_not_heated_follows_the_air(tmp_path: Any) -> None:
    things = [{"kind": "table", "at_m": [3.0, 0.0]}, {"kind": "radiator", "wall": "east", "along_m": 0.0}]
    temperatures = {"temperatures": {"air_c": 11.0, "walls_c": 9.0}}
    warm = place(tmp_path, things=things)
    cold = place(tmp_path, things=things, place=ROOM["place"] | temperatures)

    def celsius(of: Place) -> dict[str, float]:
        return {f.name: f.part.material.temperature_c for f in of.fixtures if f.part is not None}

    assert celsius(cold)["table_1/top"] == celsius(warm)["table_1/top"] - 10.0
    assert celsius(cold)["radiator_1"] == celsius(warm)["radiator_1"]
    assert celsius(cold)["floor"] == 10.0
    assert celsius(cold)["wall_east/3"] == 9.0
    assert cold.surroundings_c == 11.0


@pytest.mark.parametrize(
    ("place_keys", "words"),
    [
        ({"sun": {"azimuth_deg": 0.0, "elevation_deg": 2.0}}, ("place.sun.elevation_deg",)),
        ({"temperatures": {"air_c": "warm"}}, ("place.temperatures.air_c",)),
        ({"temperatures": {"air_c": 900.0}}, ("place.temperatures.air_c",)),
        ({"kind": "street", "houses": "north", "doors": [{"wall": "south", "along_m": 3.0}]}, ("no house",)),
        ({"kind": "street", "sky_c": -90.0}, ("sky_c",)),
        ({"kind": "street", "length_m": 90.0}, ("length_m",)),
    ],
)
def test_places_that_cannot_be_are_refused(tmp_path: Any, place_keys: Any, words: tuple[str, ...]) -> None:
    with refused("room.yaml", *words):
        place(tmp_path, place=ROOM["place"] | place_keys)


def test_angles_of_the_sun_are_taken_as_written(tmp_path: Any) -> None:
    sun = place(tmp_path, place=ROOM["place"] | {"sun": {"azimuth_deg": 90.0, "elevation_deg": 30.0}}).sun
    assert sun is not None
    assert (sun.azimuth_rad, sun.elevation_rad) == pytest.approx((math.pi / 2.0, math.pi / 6.0))


def test_a_point_is_in_the_shade_of_a_box_that_its_ray_enters() -> None:
    rng = np.random.default_rng(0)
    points, way = rng.uniform(-2.0, 2.0, (20, 15, 3)), np.array([0.3, -0.5, 0.8])
    low = rng.uniform(-2.0, 2.0, (6, 3))
    boxes = np.stack([low, low + rng.uniform(0.5, 1.5, (6, 3))], axis=1)
    lit = np.ones((20, 15), bool)
    lit[0] = False  # where it was dark before
    _shade(lit, points, way, boxes)
    along = points[..., None, :] + np.linspace(0.02, 8.0, 3000)[:, None] * way
    shaded = np.zeros((20, 15), bool)
    for box in boxes:
        shaded |= ((along > box[0]) & (along < box[1])).all(axis=-1).any(axis=-1)
    assert 30 < shaded[1:].sum() < 240
    assert (lit[1:] == ~shaded[1:]).mean() > 0.99  # of which some steps are longer than what a ray cuts off
    assert not lit[1:][shaded[1:]].any()
    assert not lit[0].any()
