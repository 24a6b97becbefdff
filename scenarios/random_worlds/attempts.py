"""Building scenario data bit by bit, with nothing in it that cannot be played."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.sim.shapes.colours import COLOURS

Data = dict[str, Any]

TRIES: Final = 30
"""How often something is drawn again that stands in the way."""


def until_valid(draw: Callable[[], Data], scene: Data) -> Data:
    """Draw parts of a scene again until it can be played."""
    for _ in range(TRIES):
        drawn = draw()
        if is_valid(scene | drawn):
            return drawn
    raise AssertionError(f"{scene['name']}: no start was found for the robot")


def with_one_more(scene: Data, key: str, draw: Callable[[], Data], tries: int = TRIES) -> Data:
    """Add one to a list of a scene; none, if all that are drawn stand in the way."""
    for _ in range(tries):
        fuller = scene | {key: [*scene.get(key, []), draw()]}
        if is_valid(fuller):
            return fuller
    return scene


def is_valid(scene: Data) -> bool:
    """Tell whether a scene can be played."""
    try:
        parse_scenario(scene, source=scene["name"], folder=Path())
    except BadInput:
        return False
    return True


def colour(rng: np.random.Generator) -> str | list[float]:
    """Draw a colour: one with a name, or a grey with a tint."""
    if rng.random() < 0.3:
        return str(rng.choice(list(COLOURS)))
    level = math.exp(rng.uniform(math.log(0.03), math.log(0.75)))
    return [rounded(x) for x in np.clip(level * np.exp(rng.normal(0.0, 0.25, 3)), 0.01, 0.95)]


def rounded(value: float) -> float:
    """Round to a hundredth, as files have it."""
    return round(float(value), 2)
