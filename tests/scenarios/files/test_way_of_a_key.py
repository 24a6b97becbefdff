"""How many modules a key's value goes through from the file to the built world."""

from __future__ import annotations

import copy
import re
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.runs.exported import SCENE

MOST = 6
_BODY = re.compile(r"\.people\.(body|motion)\.")
MARK = 1.612345678
"""A value that nothing else has."""


def holds(thing: object) -> bool:
    """Whether something is the mark, or a plain container of it."""
    if isinstance(thing, dict):
        return MARK in [value for value in thing.values() if isinstance(value, float)]
    if isinstance(thing, list | tuple):
        return MARK in [value for value in thing if isinstance(value, float)]
    return isinstance(thing, float) and thing == MARK


def modules_on_the_way(path: Path) -> set[str]:
    """Name our modules in which a function has the mark in hand while a scenario becomes a world."""
    names = set()

    def note(frame: Any, event: str, given: object) -> None:
        name = frame.f_globals.get("__name__", "")
        if name.startswith("peopleboy.") and event in ("call", "return"):
            in_hand = [*frame.f_locals.values(), *([given] if event == "return" else [])]
            if any(holds(thing) for thing in in_hand):
                names.add(name)

    sys.setprofile(note)
    try:
        world = SimulatedWorld(load_scenario(path).world(0))
    finally:
        sys.setprofile(None)
    world.close()
    # The limits of all settings are checked in one module, whichever the setting is.
    names.discard("peopleboy.settings")
    # A body and its gait are made of its height in several modules, which all are the place where it is used.
    return {"body" if _BODY.search(name) else name for name in names}


@pytest.mark.parametrize(
    "keys",
    [
        ("robot", "cameras", "thermal", "netd_k"),
        ("robot", "cameras", "thermal", "blur_px"),
        ("robot", "heading_deg"),
        ("place", "length_m"),
        ("people", 0, "height_m"),
        ("people", 0, "path", 1, "speed_m_s"),
    ],
    ids=lambda keys: ".".join(map(str, keys)),
)
def test_a_key_s_value_goes_through_few_modules(tmp_path: Path, keys: tuple[str | int, ...]) -> None:
    scene: Any = copy.deepcopy(SCENE)
    if keys[0] == "place":
        scene |= {"place": {"kind": "room", "width_m": 4.0}, "things": [], "people": []}
        scene["robot"]["at_m"] = [0.6, 0.0]
    part = scene
    for key in keys[:-1]:
        part = part[key]
    part[keys[-1]] = MARK
    path = tmp_path / "marked.yaml"
    path.write_text(yaml.safe_dump(scene), encoding="utf-8")
    on_the_way = modules_on_the_way(path)
    assert 1 <= len(on_the_way) <= MOST, on_the_way
