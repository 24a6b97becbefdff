"""Build a place from its settings: its shell, its things, and their movers."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import found_in
from peopleboy.sim.places.extent import fixture_extent
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.furniture.make_movers import make_movers
from peopleboy.sim.places.furniture.place_things import Furnishing
from peopleboy.sim.places.furniture.thing_config import KINDS, ThingConfig
from peopleboy.sim.places.moving import Mover
from peopleboy.sim.places.place import Fixture, Place, Sun, is_in_the_way
from peopleboy.sim.places.place_config import PlaceConfig, StreetConfig, Temperatures
from peopleboy.sim.places.shells import StreetLook, Surfaces, room_shell, street_shell
from peopleboy.sim.shapes.materials import Colour, Material, rgb_of

_SECOND_SHADE = 0.85  # brightness of a patterned surface's second colour, as a share of the first
_USUAL_AIR_C = 21.0


def make_place(
    config: PlaceConfig,
    plan: FloorPlan,
    things: Sequence[ThingConfig] = (),
    *,
    lights: Sequence[tuple[float, float]] = (),
    people: Sequence[str] = (),
    duration_s: float = 0.0,
    folder: Path = Path(),
) -> Place:
    """Build a whole place.

    Args:
        config: settings of the place without its things.
        plan: its floor plan, as returned by `lay_out`.
        things: settings of its things.
        lights: time [s] and level of each step of its light; empty for full light.
        people: names of all people, who can move things.
        duration_s: [s] duration of a run.
        folder: folder of the scenario's own URDF files.

    Raises:
        BadInput: a setting does not fit; with its key.
    """
    placed = Furnishing(plan, config.height_m, config.temperatures.air_c, folder).place(things)
    surfaces = _surfaces(config)
    shell = None
    if isinstance(config, StreetConfig):
        with found_in("place"):
            look = StreetLook(houses=config.house_walls(), house_m=config.house_m, sky_c=config.sky_c)
        shell = street_shell(plan, look, surfaces)
    built = build_place(
        plan,
        height_m=config.height_m,
        surfaces=surfaces,
        shell=shell,
        things=tuple(fixture for fixtures in placed.values() for fixture in fixtures),
        surroundings_c=config.temperatures.surroundings_c,
        light=tuple(lights) or ((0.0, 1.0),),
        movers=make_movers(things, placed, plan, people, duration_s),
        sun=config.sun,
    )
    kinds = zip(placed, (KINDS.get(thing.kind) for thing in things), strict=True)
    seats = frozenset(name for name, kind in kinds if kind is not None and kind.is_seat)
    return replace(built, things=tuple(placed), seats=seats)


def build_place(
    plan: FloorPlan,
    *,
    height_m: float = 2.7,
    surfaces: Surfaces | None = None,
    shell: tuple[Fixture, ...] | None = None,
    things: tuple[Fixture, ...] = (),
    surroundings_c: float = 21.0,
    light: tuple[tuple[float, float], ...] = ((0.0, 1.0),),
    movers: tuple[Mover, ...] = (),
    sun: Sun | None = None,
) -> Place:
    """Build the shell of a place, unless one is given, and add static and moving things."""
    materials = Surfaces() if surfaces is None else surfaces
    fixtures = (*(room_shell(plan, height_m, materials) if shell is None else shell), *things)
    moved = {mover.name for mover in movers}
    names, boxes = obstacles(tuple(f for f in fixtures if f.name.split("/")[0] not in moved))
    bounds = plan.bounds()
    return Place(
        fixtures=fixtures,
        obstacles=boxes,
        obstacle_names=names,
        bounds=(bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y),
        surroundings_c=surroundings_c,
        light=light,
        movers=movers,
        sun=sun,
    )


def obstacles(fixtures: tuple[Fixture, ...]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """List all solid obstacles to walking people.

    Returns:
        The K names, and (K, 4) [m] min x, min y, max x, max y.
    """
    blocking = [
        (fixture.name.split("/")[0], extent[:, :2].ravel())
        for fixture in fixtures
        if fixture.is_solid
        for extent in [fixture_extent(fixture)]
        if is_in_the_way(extent[0, 2], extent[1, 2])
    ]
    boxes = np.array([box for _, box in blocking], float).reshape(-1, 4)
    boxes.setflags(write=False)
    return tuple(name for name, _ in blocking), boxes


def _surfaces(config: PlaceConfig) -> Surfaces:
    usual, temperatures, colours = Surfaces(), config.temperatures, config.colours
    walls = _material(usual.walls, temperatures.walls_c, colours.walls)
    return Surfaces(
        floor=replace(_material(usual.floor, temperatures.floor_c, colours.floor), shine=config.floor_shine),
        ceiling=_material(usual.ceiling, temperatures.ceiling_c, colours.ceiling),
        walls=walls,
        door=_material(usual.door, _door_c(temperatures), colours.doors),
        named={
            name: replace(walls, temperature_c=temperature)
            for name, temperature in temperatures.single_walls_c.items()
        },
    )


def _door_c(temperatures: Temperatures) -> float:
    """Return the temperature of closed doors: that of the air [degC]."""
    return _USUAL_AIR_C if temperatures.air_c is None else temperatures.air_c


def _material(usual: Material, temperature_c: float, colour: Colour | None) -> Material:
    if colour is None:
        return replace(usual, temperature_c=temperature_c)
    rgb = rgb_of(colour)
    darker = (_SECOND_SHADE * rgb[0], _SECOND_SHADE * rgb[1], _SECOND_SHADE * rgb[2])
    return replace(usual, temperature_c=temperature_c, rgb=rgb, second_rgb=darker)
