"""What there is to choose from in scenario files: walls, clothes, colours, things, and more."""

from __future__ import annotations

from collections.abc import Mapping
from typing import get_args

from docs.generate.markdown import sentence, table
from peopleboy.scenarios.files.build_place import make_floor_plan
from peopleboy.scenarios.files.schema import (
    CorridorSpec,
    FaultSpec,
    LCorridorSpec,
    PlaceSpec,
    RobotSpec,
    RoomSpec,
    TCorridorSpec,
    WaypointSpec,
)
from peopleboy.sim.people.body.clothes import BOTTOMS, COLOURS, HAIR, SHOES, TOPS, Garment
from peopleboy.sim.places.things import KINDS, Kind
from peopleboy.sim.shapes.materials import Rgb

BEHAVIOURS = {
    "stand": "the robot stands",
    "follow_person": "finds a person and follows, up to where that one looks as tall as `keep_height` says",
    "follow_corridor": "keeps to the middle of a corridor, turns at its end, and waits for people in the way",
    "patrol": "follows a corridor until somebody turns up, follows that person for a while, and returns",
    "scripted": "drives as `commands` says",
}
POSTURES = {
    "standing": "upright, arms at the sides",
    "sitting": "as on a chair, which may stand at that point",
    "bending": "bent forward",
    "arms_raised": "both arms up",
    "arms_crossed": "arms in front of the chest",
}
FAULTS = {
    "camera_frozen": "the cameras give the last images again and again",
    "camera_black": "the cameras give black images",
    "tracker_raises": "the tracker fails at every image",
    "sonar_maximum": "all sonars say that there is nothing",
    "odometry_jumps": "the odometry's pose jumps at once, and again every second",
}

_PLACES: Mapping[str, PlaceSpec] = {
    "room": RoomSpec(kind="room", length_m=8.0, width_m=5.0),
    "corridor": CorridorSpec(kind="corridor", length_m=20.0, width_m=2.4),
    "l_corridor": LCorridorSpec(kind="l_corridor", first_m=12.0, second_m=8.0, width_m=2.4),
    "t_corridor": TCorridorSpec(kind="t_corridor", stem_m=12.0, bar_m=16.0, width_m=2.4),
}


def walls() -> str:
    """Name the walls of every kind of place."""
    return table(("place", "its walls"), [(f"`{name}`", _walls(place)) for name, place in _PLACES.items()])


def garments() -> str:
    """List everything to wear."""
    kinds = {"top": TOPS, "bottom": BOTTOMS, "shoes": SHOES, "hair": HAIR}
    head = ("key", "garment", "surface", "colour", "seen in heat")
    return table(
        head, [_garment(key, name, worn) for key, kind in kinds.items() for name, worn in kind.items()]
    )


def colours() -> str:
    """List the colours that have names."""
    return table(("name", "", "red, green, blue"), [_colour(name, rgb) for name, rgb in COLOURS.items()])


def things() -> str:
    """List every kind of thing."""
    head = ("kind", "depth, width, height", "temperature", "where")
    return table(head, [_thing(name, kind) for name, kind in KINDS.items()])


def postures() -> str:
    """List what people do while they pause."""
    return _described(POSTURES, get_args(WaypointSpec.model_fields["posture"].annotation))


def behaviours() -> str:
    """List what may drive the robot."""
    return _described(BEHAVIOURS, get_args(RobotSpec.model_fields["behaviour"].annotation))


def faults() -> str:
    """List what may break."""
    return _described(FAULTS, get_args(FaultSpec.model_fields["kind"].annotation))


def _walls(place: PlaceSpec) -> str:
    return ", ".join(f"`{wall.name}`" for wall in make_floor_plan(place).walls())


def _garment(key: str, name: str, worn: Garment) -> tuple[str, ...]:
    pattern = f"{worn.thermal_pattern.kind.name.lower()}, {worn.contrast_k:+g} K" if worn.contrast_k else ""
    return f"`{key}`", f"`{name}`", f"{worn.temperature_c:g} °C", worn.colour, pattern


def _colour(name: str, rgb: Rgb) -> tuple[str, ...]:
    screen = ", ".join(str(round(255 * part ** (1 / 2.2))) for part in rgb)
    swatch = f'<span class="swatch" style="background: rgb({screen})"></span>'
    return f"`{name}`", swatch, ", ".join(f"{part:g}" for part in rgb)


def _thing(name: str, kind: Kind) -> tuple[str, ...]:
    size = " x ".join(f"{length:g}" for length in kind.size_m)
    where = "on a wall" if kind.is_hung else "under the ceiling" if kind.is_from_ceiling else "on the floor"
    if kind.is_to_ceiling:
        where += ", up to the ceiling"
    return f"`{name}`", f"{size} m", f"{kind.temperature_c:g} °C", where


def _described(meanings: Mapping[str, str], names: tuple[str, ...]) -> str:
    return table(("name", "what it is"), [(f"`{name}`", sentence(meanings[name])) for name in names])
