"""A whole world drawn at random, as the data of a scenario file."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Final

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.attempts import Data, is_valid, with_one_more
from peopleboy.scenarios.random_worlds.distribution import Distribution, Draws
from peopleboy.scenarios.random_worlds.draw_people import draw_person
from peopleboy.scenarios.random_worlds.draw_place import draw_door, draw_place
from peopleboy.scenarios.random_worlds.draw_robot import draw_robot
from peopleboy.scenarios.random_worlds.draw_things import draw_thing
from peopleboy.sim.random_streams import stream

LASTS_S: Final = 8.0
"""[s] Length of a random world's run, unless another is asked for."""

_TRIES: Final = 3


def random_world(seed: int, duration_s: float = LASTS_S, distribution: Distribution | None = None) -> Data:
    """Draw a world from `peopleboy.scenarios.random_worlds.distribution`; the same seed gives the same data.

    What people look like is left to be drawn by the run's seed, which should be the same.

    Args:
        seed: 0 or more; draws all.
        duration_s: [s] how long a run lasts.
        distribution: what else to draw from.
    """
    draws = Draws(stream(seed, "random_world"), distribution)
    scene: Data = {
        "name": f"world_{seed}",
        "description": "A world drawn at random.",
        "duration_s": duration_s,
        "detail": "full",
        "clothes_differ": draws.one_of("clothes") == "all different",
        "lights": _lights(draws, duration_s),
    }
    place = draw_place(draws)
    scene |= {"place": place, "robot": draw_robot(draws, place, duration_s)}
    for _ in range(draws.count("doors")):
        scene = _with_door(draws, scene)
    for _ in range(draws.count("things")):
        things = scene.get("things", [])
        scene = with_one_more(
            scene, "things", partial(draw_thing, draws, place, scene["robot"], things), _TRIES
        )
    ground = parse_scenario(scene, source=scene["name"], folder=Path()).ground
    for number in range(draws.count("people")):
        scene = with_one_more(
            scene, "people", partial(draw_person, draws, scene, ground, f"p{number}"), _TRIES
        )
    return scene


def random_scenario(
    seed: int, duration_s: float = LASTS_S, distribution: Distribution | None = None
) -> Scenario:
    """Draw a world, ready to be played."""
    return parse_scenario(random_world(seed, duration_s, distribution), source=f"world_{seed}", folder=Path())


def _with_door(draws: Draws, scene: Data) -> Data:
    """Add a door; none, if all that are drawn do not fit."""
    place = scene["place"]
    for _ in range(_TRIES):
        doors = [*place.get("doors", []), draw_door(draws, place)]
        if is_valid(fuller := scene | {"place": place | {"doors": doors}}):
            return fuller
    return scene


def _lights(draws: Draws, duration_s: float) -> list[Data]:
    steps: list[Data] = [{"at_s": 0.0, "level": draws.number("light")}]
    if draws.one_of("light_changes") == "once":
        steps.append({"at_s": round(duration_s / 2.0, 2), "level": draws.number("light")})
    return steps
