"""Sample the place and the robot of a random world, and test whether a scene is a valid scenario."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.sim.cameras.camera_config import COLOUR_BASELINE_M, COLOUR_ZOOM
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place_config import PlaceConfig, lay_out
from peopleboy.sim.shapes.materials import COLOURS

Data = dict[str, Any]

TRIES: Final = 30
"""Number of attempts to sample a valid element."""


def until_valid(draw: Callable[[], Data], scene: Data) -> Data:
    """Sample parts of a scene until it is a valid scenario."""
    for _ in range(TRIES):
        drawn = draw()
        if is_valid(scene | drawn):
            return drawn
    raise AssertionError(f"{scene['name']}: found no start position for the robot")


def with_one_more(scene: Data, key: str, draw: Callable[[], Data], tries: int = TRIES) -> Data:
    """Add an element to a list of a scene; add none if no sampled element is valid."""
    for _ in range(tries):
        fuller = scene | {key: [*scene.get(key, []), draw()]}
        if is_valid(fuller):
            return fuller
    return scene


def is_valid(scene: Data) -> bool:
    """Return whether a scene is a valid scenario."""
    try:
        parse_scenario(scene, source=scene["name"], folder=Path())
    except BadInput:
        return False
    return True


def colour(rng: np.random.Generator) -> str | list[float]:
    """Sample a colour: a named one, or a tinted grey."""
    if rng.random() < 0.3:
        return str(rng.choice(list(COLOURS)))
    level = math.exp(rng.uniform(math.log(0.03), math.log(0.75)))
    return [rounded(x) for x in np.clip(level * np.exp(rng.normal(0.0, 0.25, 3)), 0.01, 0.95)]


def rounded(value: float) -> float:
    """Round to a hundredth, as in scenario files."""
    return round(float(value), 2)


_LENGTHS: Final = {
    "room": ("length_m",), "street": ("length_m",), "corridor": ("length_m",),
    "l_corridor": ("first_m", "second_m"), "t_corridor": ("stem_m", "bar_m"),
}  # fmt: skip
_MARGIN_M: Final = 0.4  # distance from walls, so that a robot fits


def draw_place(draws: Draws) -> Data:
    """Sample a place without doors."""
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
    """Sample a door in one of the walls; it may not fit."""
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
    """Return the floor plan of a place."""
    config: PlaceConfig = validated(PlaceConfig, place)  # type: ignore[arg-type]
    return lay_out(config)


def air_of(place: Data) -> float:
    """Return the temperature [degC] of the air."""
    return float(place["temperatures"]["surroundings_c"])


def draw_point(draws: Draws, place: Data) -> list[float]:
    """Sample a point uniformly over the rectangles of the floor, away from walls."""
    areas = [area for _, area in plan_of(place).areas]
    sizes = np.array([(area.max_x - area.min_x) * (area.max_y - area.min_y) for area in areas])
    area = areas[int(draws.rng.choice(len(areas), p=sizes / sizes.sum()))]
    return [
        rounded(draws.rng.uniform(area.min_x + _MARGIN_M, area.max_x - _MARGIN_M)),
        rounded(draws.rng.uniform(area.min_y + _MARGIN_M, area.max_y - _MARGIN_M)),
    ]


_AIMS: Final = 4
_TRIES: Final = 8
_AHEAD_M: Final = 3.0  # free floor ahead of the robot, if possible
_WALL_M: Final = 0.1
_FREE_M, _FREE_RAD = 1.5, math.radians(40.0)


def draw_robot(draws: Draws, place: Data, duration_s: float) -> Data:
    """Sample a robot that faces a distant part of the place."""
    at, heading = _stance(draws, place)
    robot: Data = {"at_m": at, "heading_deg": heading, "cameras": draw_cameras(draws)}
    if draws.one_of("robot") == "drives":
        robot |= {"behaviour": "scripted", "commands": _drive(draws, duration_s)}
    return robot


def draw_cameras(draws: Draws) -> Data:
    """Sample a thermal camera, and next to it a colour camera with a slightly smaller field of view."""
    ahead, _, _ = Pinhole().position_m
    height, pitch, angle = (draws.number(name) for name in ("camera_height", "pitch", "vertical_fov"))
    narrower = 2.0 * math.degrees(math.atan(math.tan(math.radians(angle / 2.0)) / COLOUR_ZOOM))
    thermal: Data = {
        "kind": "thermal",
        "mount_m": [ahead, 0.0, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": angle,
        "blur_px": draws.number("blur"),
        "netd_k": draws.number("netd"),
        "fixed_pattern_k": draws.number("fixed_pattern"),
        "dead_pixels": draws.number("dead_pixels"),
        "column_noise_k": draws.number("column_noise"),
        "vignetting_k": draws.number("vignetting"),
        "offset_drift_k_per_min": draws.number("drift"),
        "sharpening": draws.number("sharpening"),
        "coring_k": draws.number("coring"),
        **_draw_gain(draws),
    }
    if draws.happens("has_shutter"):
        thermal["shutter_every_s"] = draws.number("shutter_every")
    if draws.happens("is_film"):
        thermal["jpeg_quality"] = draws.count("jpeg_quality")
    colour = {
        "kind": "colour",
        "mount_m": [ahead, COLOUR_BASELINE_M, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": rounded(narrower),
    }
    return {"thermal": thermal, "colour": colour}


def _draw_gain(draws: Draws) -> Data:
    """Sample an automatic gain, so that the room is visible at any temperature."""
    gain: Data = {
        "gain": draws.one_of("gain"),
        "gain_follows_s": draws.number("gain_follows"),
        "tail_percent": draws.number("tail"),
        "least_span_k": draws.number("least_span"),
    }
    if gain["gain"] == "plateau":
        gain |= {"plateau_percent": draws.number("plateau"), "linear_share": draws.number("linear_share")}
    return gain


def is_before(robot: Data, at: list[float]) -> bool:
    """Return whether a point is so close in front of the robot that an object there would fill its view."""
    ahead, aside = at[0] - robot["at_m"][0], at[1] - robot["at_m"][1]
    off = math.remainder(math.atan2(aside, ahead) - math.radians(robot["heading_deg"]), math.tau)
    return math.hypot(ahead, aside) < _FREE_M and abs(off) < _FREE_RAD


def _stance(draws: Draws, place: Data) -> tuple[list[float], float]:
    """Sample a point, and a heading [deg] towards the farthest of four others, mostly with floor ahead."""
    areas = [area.grown(-_WALL_M) for _, area in plan_of(place).areas]
    for _ in range(_TRIES):
        at = draw_point(draws, place)
        x, y = max((draw_point(draws, place) for _ in range(_AIMS)), key=lambda aim: math.dist(at, aim))
        heading = math.degrees(math.atan2(y - at[1], x - at[0])) + draws.number("heading_off")
        cos, sin = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        if any(area.contains(at[0] + _AHEAD_M * cos, at[1] + _AHEAD_M * sin) for area in areas):
            break
    return at, rounded(heading)


def _drive(draws: Draws, duration_s: float) -> list[Data]:
    """Sample commands: straight drives, curves, turns on the spot, and stops."""
    commands: list[Data] = []
    at = 0.0
    while at < duration_s:
        way = draws.one_of("command")
        linear = draws.number("drive_speed") if way in ("straight", "curve") else 0.0
        turn = draws.number("drive_turn") if way in ("turn", "curve") else 0.0
        commands.append({"from_s": rounded(at), "linear_m_s": linear, "angular_deg_s": turn})
        at += draws.number("drive_lasts")
    return commands
