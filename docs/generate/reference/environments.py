"""Generate the tables of gymnasium environments: registration ids, and observation spaces."""

from __future__ import annotations

from typing import cast

import numpy as np
from gymnasium import spaces

from docs.generate.markdown import table
from peopleboy.registration import ENVIRONMENTS
from peopleboy.scenarios.environments.observations import (
    COLUMNS,
    MOST_TRACKS,
    Arrays,
    Normaliser,
    observation_space,
)
from peopleboy.scenarios.files.load import load_scenario

TRACKED_COLUMNS = {
    "id": "track id, from 1; 0 for an empty row",
    "x": "column of the box centre: -1 at the left image border, 1 at the right one",
    "height": "height of the box [image heights]",
    "top": "top edge of the box, measured from the top of the image [image heights]",
    "bottom": "bottom edge of the box, measured from the top of the image [image heights]",
    "confidence": "confidence of the track",
    "is_visible": "0 while the person is totally occluded, otherwise 1",
}


def environment_ids() -> str:
    """List the registered environments."""
    rows = [
        (f"`{name}`", f"`{kwargs['scenario']}`", f"`{kwargs['task']}`")
        for name, kwargs in ENVIRONMENTS.items()
    ]
    return table(("id", "scenario", "task"), rows)


def environment_spaces() -> str:
    """List the boxes of the observation spaces, with and without `normalise=True`."""
    robot = load_scenario("single_follow").world(0).robot
    normaliser = Normaliser(robot)
    rows = []
    for kind, keys in (
        ("tracks", ("sonar", "odometry", "goal", "tracks")),
        ("pixels", ("thermal", "colour")),
    ):
        space = observation_space(kind, robot, tuple(robot.cameras), has_goal=True)
        scaled = normaliser.space(space)
        rows += [(f"`{key}`", *_box(space, key), _limits(scaled, key)) for key in keys]
    return table(("key", "shape", "dtype", "low, high", "low, high with `normalise=True`"), rows)


def environment_tracks() -> str:
    """List the columns of `tracks`."""
    robot = load_scenario("single_follow").world(0).robot
    space = observation_space("tracks", robot, ())
    scaled = Normaliser(robot).space(space)
    rows = [
        (str(index), f"`{name}`", TRACKED_COLUMNS[name], _at(space, index), _at(scaled, index))
        for index, name in enumerate(COLUMNS)
    ]
    return table(("index", "name", "meaning", "low, high", "with `normalise=True`"), rows)


def _box(space: spaces.Space[Arrays], key: str) -> tuple[str, str, str]:
    box = _of(space, key)
    return str(box.shape), str(box.dtype), _limits(space, key)


def _limits(space: spaces.Space[Arrays], key: str) -> str:
    if key == "tracks":
        return "by column, see below"
    box = _of(space, key)
    pairs = dict.fromkeys(zip(box.low.ravel().tolist(), box.high.ravel().tolist(), strict=True))
    return "; ".join(f"{low:g}, {high:g}" for low, high in pairs)


def _at(space: spaces.Space[Arrays], column: int) -> str:
    box = _of(space, "tracks")
    low, high = (np.reshape(bound, (MOST_TRACKS, -1))[0, column] for bound in (box.low, box.high))
    return f"{low:g}, {high:g}"


def _of(space: spaces.Space[Arrays], key: str) -> spaces.Box:
    return cast(spaces.Box, cast(spaces.Dict, space)[key])
