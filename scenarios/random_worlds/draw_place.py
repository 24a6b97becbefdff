"""Draw the place of a random world: floor plan, doors, temperatures and colours."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.random_worlds.attempts import Data, colour, rounded
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place_config import PlaceConfig, lay_out

_LENGTHS: Final = {
    "room": ("length_m",), "street": ("length_m",), "corridor": ("length_m",),
    "l_corridor": ("first_m", "second_m"), "t_corridor": ("stem_m", "bar_m"),
}  # fmt: skip
_MARGIN_M: Final = 0.4  # from walls, so that a robot has room


def draw_place(draws: Draws) -> Data:
    """Draw a place without doors."""
    kind = draws.one_of("place")
    size = kind if kind in ("room", "street") else "corridor"
    air = draws.number("air")
    place: Data = {
        "kind": kind,
        "width_m": draws.number(f"{size}_width"),
        **{key: draws.number(f"{size}_length") for key in _LENGTHS[kind]},
        "height_m": draws.number("ceiling"),
        "colours": {
            part: colour(draws.rng)
            for part in ("floor", "ceiling", "walls", "doors")
            if draws.happens("coloured")
        },
    }
    if kind == "l_corridor":
        place["turn"] = str(draws.rng.choice(["left", "right"]))
    if kind == "street":
        place |= {"houses": draws.one_of("houses"), "sky_c": rounded(air + draws.number("sky"))}
    if draws.happens("has_sun"):
        place["sun"] = {
            "azimuth_deg": draws.number("sun_azimuth"),
            "elevation_deg": draws.number("sun_elevation"),
            "warms_k": draws.number("sun_warms"),
        }
    place["temperatures"] = {
        "air_c": air,
        "surroundings_c": air,
        **{
            f"{part}_c": rounded(air + draws.number(f"{part}_over_air"))
            for part in ("floor", "walls", "ceiling")
        },
    }
    names = [wall.name for wall in plan_of(place).walls() if draws.happens("wall_differs")]
    walls = place["temperatures"]["walls_c"]
    place["temperatures"]["single_walls_c"] = {
        name: rounded(walls + draws.number("wall_over_others")) for name in names
    }
    return place


def draw_door(draws: Draws, place: Data) -> Data:
    """Draw a door in one of the walls; it may not fit."""
    walls = plan_of(place).walls()
    wall = walls[int(draws.rng.integers(len(walls)))]
    low, high = wall.side.span(wall.area)
    return {
        "wall": wall.name,
        "along_m": rounded(draws.rng.uniform(low, high)),
        "width_m": draws.number("door_width"),
        "open": draws.one_of("door") == "open",
    }


def plan_of(place: Data) -> FloorPlan:
    """Lay out the floor of a place."""
    config: PlaceConfig = validated(PlaceConfig, place)  # type: ignore[arg-type]
    return lay_out(config)


def air_of(place: Data) -> float:
    """Tell the temperature [degC] of the air."""
    return float(place["temperatures"]["surroundings_c"])


def draw_point(draws: Draws, place: Data) -> list[float]:
    """Draw a point of the floor, away from walls, evenly over its rectangles."""
    areas = [area for _, area in plan_of(place).areas]
    sizes = np.array([(area.max_x - area.min_x) * (area.max_y - area.min_y) for area in areas])
    area = areas[int(draws.rng.choice(len(areas), p=sizes / sizes.sum()))]
    return [
        rounded(draws.rng.uniform(area.min_x + _MARGIN_M, area.max_x - _MARGIN_M)),
        rounded(draws.rng.uniform(area.min_y + _MARGIN_M, area.max_y - _MARGIN_M)),
    ]
