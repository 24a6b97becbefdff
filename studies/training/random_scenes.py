"""Training scenes: random places, objects, people and drives, as scenario data."""

from functools import partial
from typing import Final

import numpy as np

from peopleboy.scenarios.random_worlds.draw_scene import (
    Data,
    colour,
    rounded,
    until_valid,
    with_one_more,
)

Draw = np.random.Generator

FIRST_SEED: Final = 100
"""First seed of the training scenes; the validation split has the seeds below it."""

IMAGES: Final = {3: 60, 5: 60, 15: 90}
"""Number of images of a scene; the duration depends on the camera's rate [Hz]."""

_STANDING: Final = (
    "cabinet", "table", "chair", "block", "pillar", "round_pillar", "plant", "floor_lamp", "robot",
)  # fmt: skip
_HANGING: Final = ("radiator", "poster", "window", "pipe")
_LENGTHS: Final = {
    "room": ("length_m",), "corridor": ("length_m",),
    "l_corridor": ("first_m", "second_m"), "t_corridor": ("stem_m", "bar_m"),
}  # fmt: skip


def random_scene(seed: int, camera: str = "panorama", own: Data | None = None) -> Data:
    """Draw a scene, the data of a scenario file. Equal seeds give equal scenes.

    The robot drives in every other scene; one to four people walk or stand.

    Args:
        seed: seed of everything that is drawn.
        camera: kind of the camera that renders the scene.
        own: further keys of that camera.
    """
    rng = np.random.default_rng((seed, 2003))
    rate = int(rng.choice(list(IMAGES), p=[0.3, 0.2, 0.5]))
    duration_s = IMAGES[rate] / rate
    scene: Data = {
        "name": f"scene_{seed}",
        "description": "A random scene for training.",
        "duration_s": duration_s,
        "clothes_differ": bool(rng.random() < 0.5),
        "lights": [{"at_s": 0.0, "level": rounded(rng.uniform(0.55, 1.1))}],
    }
    mounted = {"kind": camera, "rate_hz": rate} | (own or {})
    scene |= until_valid(lambda: _stage(rng, mounted, duration_s), scene)
    place = scene["place"]
    for _ in range(rng.integers(0, 9)):
        scene = with_one_more(scene, "things", lambda: _thing(rng, place))
    for number in range(rng.integers(1, 5)):
        scene = with_one_more(scene, "people", partial(_person, rng, place, f"p{number}", duration_s))
    return scene


def _stage(rng: Draw, camera: Data, duration_s: float) -> Data:
    """Draw a place with a robot that stands, or drives at random."""
    place = _place(rng)
    robot: Data = {
        "at_m": _point(rng, place),
        "heading_deg": rounded(rng.uniform(-180.0, 180.0)),
        "cameras": {camera["kind"]: camera},
    }
    if rng.random() < 0.65:
        robot |= {"behaviour": "scripted", "commands": _drive(rng, duration_s)}
    return {"place": place, "robot": robot}


def _place(rng: Draw) -> Data:
    kind = str(rng.choice(list(_LENGTHS), p=[0.7, 0.1, 0.1, 0.1]))
    limits = ((4.0, 14.0), (3.5, 12.0)) if kind == "room" else ((8.0, 16.0), (2.2, 3.8))
    long, across = (rng.uniform(*each) for each in limits)
    colours = {part: colour(rng) for part in ("floor", "walls", "doors") if rng.random() < 0.8}
    sizes = {name: rounded(long) for name in _LENGTHS[kind]}
    return {"kind": kind, "width_m": rounded(across), **sizes, "colours": colours}


def _drive(rng: Draw, duration_s: float) -> list[Data]:
    """Draw commands: straight motion, turns on the spot, curves, and stops."""
    commands, at = [], float(rng.uniform(0.0, 1.0))
    while at < duration_s:
        ways = rng.choice(["straight", "turn", "curve", "stop"], p=[0.3, 0.2, 0.4, 0.1])
        linear = rng.uniform(-0.3, 0.8) if ways in ("straight", "curve") else 0.0
        turn = rng.uniform(-45.0, 45.0) if ways in ("turn", "curve") else 0.0
        commands.append(
            {"from_s": rounded(at), "linear_m_s": rounded(linear), "angular_deg_s": rounded(turn)}
        )
        at += float(rng.uniform(0.8, 4.0))
    return commands


def _thing(rng: Draw, place: Data) -> Data:
    own = {"colour": colour(rng)} if rng.random() < 0.5 else {}
    if rng.random() < 0.3 and place["kind"] == "room":
        wall = str(rng.choice(["north", "south", "east", "west"]))
        reach = place["length_m"] if wall in ("north", "south") else place["width_m"]
        middle = reach / 2.0 if wall in ("north", "south") else 0.0
        along = rounded(middle + rng.uniform(-0.4, 0.4) * reach)
        return {"kind": str(rng.choice(_HANGING)), "wall": wall, "along_m": along, **own}
    facing = rounded(rng.uniform(-180.0, 180.0))
    return {"kind": str(rng.choice(_STANDING)), "at_m": _point(rng, place), "facing_deg": facing, **own}


def _person(rng: Draw, place: Data, name: str, duration_s: float) -> Data:
    path: list[Data] = [
        _waypoint(rng, place) for _ in range(rng.choice([1, 3, 4, 5], p=[0.1, 0.3, 0.3, 0.3]))
    ]
    person: Data = {"name": name, "yields": bool(rng.random() < 0.5), "path": path}
    if rng.random() < 0.3:
        person["enter_s"] = rounded(rng.uniform(0.0, 0.6) * duration_s)
    elif rng.random() < 0.2:
        person["leave_s"] = rounded(rng.uniform(0.3, 0.9) * duration_s)
    if rng.random() < 0.5:
        person["clothes"] = {"bottom_colour": colour(rng)}
    return person


def _waypoint(rng: Draw, place: Data) -> Data:
    waypoint: Data = {"at_m": _point(rng, place), "speed_m_s": rounded(rng.uniform(0.5, 1.5))}
    if rng.random() < 0.2:
        waypoint["pause_s"] = rounded(rng.uniform(0.5, 5.0))
        waypoint["posture"] = str(rng.choice(["standing", "bending", "arms_crossed"], p=[0.7, 0.2, 0.1]))
    return waypoint


def _point(rng: Draw, place: Data) -> list[float]:
    """Draw a point in the bounding rectangle of the place; parsing the scene checks whether it is floor."""
    long = sum(place.get(key, 0.0) for key in ("length_m", "first_m", "stem_m"))
    side = max(place["width_m"], place.get("second_m", 0.0), place.get("bar_m", 0.0))
    return [rounded(rng.uniform(0.3, long - 0.3)), rounded((rng.random() - 0.5) * side)]
