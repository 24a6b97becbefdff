"""Scenes to learn from: places, things, people and drives drawn at random, as scenario data."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.sim.people.body.clothes import COLOURS

Draw = np.random.Generator
Data = dict[str, Any]

IMAGES: Final = {3: 60, 5: 60, 15: 90}
"""How many images a scene has, by how many the camera takes a second."""

_STANDING: Final = (
    "cabinet", "table", "chair", "block", "pillar", "round_pillar", "plant", "floor_lamp", "robot",
)  # fmt: skip
_HANGING: Final = ("radiator", "poster", "window", "pipe")
_TRIES: Final = 30


def random_scene(seed: int, camera: str = "panorama") -> Data:
    """Draw a scene: the data of a scenario file, the same for the same seed.

    Every other scene's robot drives; one to four people walk or stand about.

    Args:
        seed: draws all.
        camera: kind of the camera that it is filmed with.
    """
    rng = np.random.default_rng((seed, 2003))
    rate = int(rng.choice(list(IMAGES), p=[0.3, 0.2, 0.5]))
    duration_s = IMAGES[rate] / rate
    scene: Data = {
        "name": f"scene_{seed}",
        "description": "A scene drawn at random, to learn from.",
        "duration_s": duration_s,
        "clothes_differ": bool(rng.random() < 0.5),
        "lights": [{"at_s": 0.0, "level": _rounded(rng.uniform(0.55, 1.1))}],
    }
    scene |= _until_valid(lambda: _stage(rng, camera, rate, duration_s), scene)
    place = scene["place"]
    for _ in range(rng.integers(0, 9)):
        scene = _with_one_more(scene, "things", lambda: _thing(rng, place))
    for number in range(rng.integers(1, 5)):
        scene = _with_one_more(scene, "people", partial(_person, rng, place, f"p{number}", duration_s))
    return scene


def _until_valid(draw: Callable[[], Data], scene: Data) -> Data:
    """Draw again until the scene can be played."""
    for _ in range(_TRIES):
        drawn = draw()
        if _is_valid(scene | drawn):
            return drawn
    raise AssertionError(f"{scene['name']}: no start was found for the robot")


def _with_one_more(scene: Data, key: str, draw: Callable[[], Data]) -> Data:
    """Add a thing or person; none, if all that are drawn stand in the way."""
    for _ in range(_TRIES):
        fuller = scene | {key: [*scene.get(key, []), draw()]}
        if _is_valid(fuller):
            return fuller
    return scene


def _is_valid(scene: Data) -> bool:
    try:
        parse_scenario(scene, source=scene["name"], folder=Path())
    except BadInput:
        return False
    return True


def _stage(rng: Draw, camera: str, rate: int, duration_s: float) -> Data:
    """Draw a place, and a robot in it that stands, or drives as it likes."""
    place = _place(rng)
    robot: Data = {
        "at_m": _point(rng, place),
        "heading_deg": _rounded(rng.uniform(-180.0, 180.0)),
        "cameras": {camera: {"kind": camera, "rate_hz": rate}},
    }
    if rng.random() < 0.65:
        robot |= {"behaviour": "scripted", "commands": _drive(rng, duration_s)}
    return {"place": place, "robot": robot}


def _place(rng: Draw) -> Data:
    kind = str(rng.choice(["room", "corridor", "l_corridor", "t_corridor"], p=[0.7, 0.1, 0.1, 0.1]))
    is_room = kind == "room"
    long, across = (
        (rng.uniform(4.0, 14.0), rng.uniform(3.5, 12.0))
        if is_room
        else (
            rng.uniform(8.0, 16.0),
            rng.uniform(2.2, 3.8),
        )
    )
    lengths = {
        "room": ("length_m",), "corridor": ("length_m",),
        "l_corridor": ("first_m", "second_m"), "t_corridor": ("stem_m", "bar_m"),
    }  # fmt: skip
    colours = {part: _colour(rng) for part in ("floor", "walls", "doors") if rng.random() < 0.8}
    sizes = {name: _rounded(long) for name in lengths[kind]}
    return {"kind": kind, "width_m": _rounded(across), **sizes, "colours": colours}


def _drive(rng: Draw, duration_s: float) -> list[Data]:
    """Draw commands: straight on, turning on the spot, curves, and stops."""
    commands, at = [], float(rng.uniform(0.0, 1.0))
    while at < duration_s:
        ways = rng.choice(["straight", "turn", "curve", "stop"], p=[0.3, 0.2, 0.4, 0.1])
        linear = rng.uniform(-0.3, 0.8) if ways in ("straight", "curve") else 0.0
        turn = rng.uniform(-45.0, 45.0) if ways in ("turn", "curve") else 0.0
        commands.append(
            {"from_s": _rounded(at), "linear_m_s": _rounded(linear), "angular_deg_s": _rounded(turn)}
        )
        at += float(rng.uniform(0.8, 4.0))
    return commands


def _thing(rng: Draw, place: Data) -> Data:
    colour = {"colour": _colour(rng)} if rng.random() < 0.5 else {}
    if rng.random() < 0.3 and place["kind"] == "room":
        wall = str(rng.choice(["north", "south", "east", "west"]))
        reach = place["length_m"] if wall in ("north", "south") else place["width_m"]
        middle = reach / 2.0 if wall in ("north", "south") else 0.0
        along = _rounded(middle + rng.uniform(-0.4, 0.4) * reach)
        return {"kind": str(rng.choice(_HANGING)), "wall": wall, "along_m": along, **colour}
    facing = _rounded(rng.uniform(-180.0, 180.0))
    return {"kind": str(rng.choice(_STANDING)), "at_m": _point(rng, place), "facing_deg": facing, **colour}


def _person(rng: Draw, place: Data, name: str, duration_s: float) -> Data:
    path: list[Data] = [
        _waypoint(rng, place) for _ in range(rng.choice([1, 3, 4, 5], p=[0.1, 0.3, 0.3, 0.3]))
    ]
    person: Data = {"name": name, "yields": bool(rng.random() < 0.5), "path": path}
    if rng.random() < 0.3:
        person["enter_s"] = _rounded(rng.uniform(0.0, 0.6) * duration_s)
    elif rng.random() < 0.2:
        person["leave_s"] = _rounded(rng.uniform(0.3, 0.9) * duration_s)
    if rng.random() < 0.5:
        person["clothes"] = {"bottom_colour": _colour(rng)}
    return person


def _waypoint(rng: Draw, place: Data) -> Data:
    waypoint: Data = {"at_m": _point(rng, place), "speed_m_s": _rounded(rng.uniform(0.5, 1.5))}
    if rng.random() < 0.2:
        waypoint["pause_s"] = _rounded(rng.uniform(0.5, 5.0))
        waypoint["posture"] = str(rng.choice(["standing", "bending", "arms_crossed"], p=[0.7, 0.2, 0.1]))
    return waypoint


def _point(rng: Draw, place: Data) -> list[float]:
    """Draw a point of the rectangle round the place; whether it is floor, who reads the scene says."""
    long = sum(place.get(key, 0.0) for key in ("length_m", "first_m", "stem_m"))
    side = max(place["width_m"], place.get("second_m", 0.0), place.get("bar_m", 0.0))
    return [_rounded(rng.uniform(0.3, long - 0.3)), _rounded((rng.random() - 0.5) * side)]


def _colour(rng: Draw) -> str | list[float]:
    """Draw a colour: one with a name, or a grey with a tint."""
    if rng.random() < 0.3:
        return str(rng.choice(list(COLOURS)))
    level = math.exp(rng.uniform(math.log(0.03), math.log(0.75)))
    return [_rounded(x) for x in np.clip(level * np.exp(rng.normal(0.0, 0.25, 3)), 0.01, 0.95)]


def _rounded(value: float) -> float:
    return round(float(value), 2)
