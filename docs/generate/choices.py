"""Generate tables of values in scenario files: walls, clothes, colours and objects."""

from __future__ import annotations

from collections.abc import Mapping

from docs.generate.markdown import table
from peopleboy.sim.people.body.clothes import BOTTOMS, HAIR, SHOES, TOPS, Garment
from peopleboy.sim.places.furniture.thing_config import KINDS
from peopleboy.sim.places.pieces import Kind
from peopleboy.sim.places.place_config import (
    CorridorConfig,
    LCorridorConfig,
    PlaceConfig,
    RoomConfig,
    StreetConfig,
    TCorridorConfig,
    lay_out,
)
from peopleboy.sim.shapes.materials import COLOURS, Rgb

_PLACES: Mapping[str, PlaceConfig] = {
    "room": RoomConfig(kind="room", length_m=8.0, width_m=5.0),
    "corridor": CorridorConfig(kind="corridor", length_m=20.0, width_m=2.4),
    "l_corridor": LCorridorConfig(kind="l_corridor", first_m=12.0, second_m=8.0, width_m=2.4),
    "t_corridor": TCorridorConfig(kind="t_corridor", stem_m=12.0, bar_m=16.0, width_m=2.4),
    "street": StreetConfig(kind="street", length_m=30.0, width_m=12.0),
}


def walls() -> str:
    """List the walls of every kind of place."""
    return table(("place", "walls"), [(f"`{name}`", _walls(place)) for name, place in _PLACES.items()])


def garments() -> str:
    """List all garments."""
    kinds = {"top": TOPS, "bottom": BOTTOMS, "shoes": SHOES, "hair": HAIR}
    head = ("key", "garment", "surface", "colour", "thermal pattern")
    return table(
        head, [_garment(key, name, worn) for key, kind in kinds.items() for name, worn in kind.items()]
    )


def colours() -> str:
    """List the named colours."""
    return table(("name", "", "red, green, blue"), [_colour(name, rgb) for name, rgb in COLOURS.items()])


def things() -> str:
    """List all kinds of objects."""
    head = ("kind", "depth, width, height", "temperature", "position")
    return table(head, [_thing(name, kind) for name, kind in KINDS.items()])


def _walls(place: PlaceConfig) -> str:
    return ", ".join(f"`{wall.name}`" for wall in lay_out(place).walls())


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
