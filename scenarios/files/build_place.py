"""From what a scenario file says about a place to the place itself."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from peopleboy.bad_input import BadInput, Key, found_in
from peopleboy.scenarios.files.moves.move_things import make_movers
from peopleboy.scenarios.files.place_things import make_things, resolve_colour
from peopleboy.scenarios.files.schema.place import (
    CorridorSpec,
    DoorSpec,
    LCorridorSpec,
    PlaceSpec,
    RoomSpec,
    StreetSpec,
    SunSpec,
    TemperaturesSpec,
)
from peopleboy.scenarios.files.schema.scenario_file import ScenarioSpec
from peopleboy.scenarios.files.schema.values import Colour
from peopleboy.scenarios.files.schema_errors import hint
from peopleboy.sim.places.floor_plan import Door, FloorPlan, check_doors
from peopleboy.sim.places.place import Fixture, Place, Sun
from peopleboy.sim.places.rooms import Surfaces, build_place, l_corridor, straight_corridor, t_corridor
from peopleboy.sim.places.street import StreetLook, street_shell
from peopleboy.sim.shapes.materials import Material


def make_floor_plan(spec: PlaceSpec) -> FloorPlan:
    """Lay out the floor of a place, with its doors.

    Raises:
        BadInput: an unknown wall, or a door that does not fit.
    """
    plan = _areas(spec)
    for index, door in enumerate(spec.doors):
        check_wall(plan, ("place", "doors", index, "wall"), door.wall)
        if door.height_m > spec.height_m - 0.1:
            raise BadInput(
                f"{door.height_m:g} is too high; the ceiling is at {spec.height_m:g} m "
                "and a lintel needs 0.1 m",
                key=("place", "doors", index, "height_m"),
            )
    plan = replace(plan, doors=tuple(_door(door) for door in spec.doors))
    with found_in("place"):
        check_doors(plan)
    return plan


def make_place(spec: ScenarioSpec, folder: Path) -> Place:
    """Build the whole place of a scenario.

    Args:
        spec: the scenario.
        folder: where the scenario file lies, for its own URDF files.

    Raises:
        BadInput: something does not fit; with its key.
    """
    plan = make_floor_plan(spec.place)
    built = make_things(spec, plan, folder)
    surfaces = _surfaces(spec.place, plan)
    return build_place(
        plan,
        height_m=spec.place.height_m,
        surfaces=surfaces,
        shell=_street(spec.place, plan, surfaces) if isinstance(spec.place, StreetSpec) else None,
        things=tuple(f for fixtures in built.values() for f in fixtures),
        surroundings_c=spec.place.temperatures.surroundings_c,
        light=tuple((step.at_s, step.level) for step in spec.lights) or ((0.0, 1.0),),
        movers=make_movers(spec, plan, built),
        sun=None if spec.place.sun is None else _sun(spec.place.sun),
    )


def check_wall(plan: FloorPlan, key: Key, name: str) -> None:
    """Refuse the name of a wall that the plan lacks.

    Raises:
        BadInput: with the key and the walls that there are.
    """
    known = [wall.name for wall in plan.walls()]
    if name not in known:
        raise BadInput(f"unknown wall {name!r}; {hint(name, known)}", key=key)


def _areas(spec: PlaceSpec) -> FloorPlan:
    if isinstance(spec, RoomSpec | CorridorSpec | StreetSpec):
        return straight_corridor(spec.length_m, spec.width_m)
    if isinstance(spec, LCorridorSpec):
        _check_longer(spec.first_m, "first_m", spec.width_m)
        return l_corridor(spec.first_m, spec.second_m, spec.width_m, spec.turn)
    _check_longer(spec.bar_m, "bar_m", spec.width_m)
    return t_corridor(spec.stem_m, spec.bar_m, spec.width_m)


def _check_longer(length_m: float, key: str, width_m: float) -> None:
    if length_m <= width_m:
        raise BadInput(
            f"{length_m:g} must be more than the corridor's width of {width_m:g} m", key=("place", key)
        )


def _door(spec: DoorSpec) -> Door:
    return Door(
        wall=spec.wall,
        along_m=spec.along_m,
        width_m=spec.width_m,
        height_m=spec.height_m,
        is_open=spec.open,
        lobby_m=spec.lobby_m,
    )


def _street(spec: StreetSpec, plan: FloorPlan, surfaces: Surfaces) -> tuple[Fixture, ...]:
    """The shell of a street.

    Raises:
        BadInput: a door where no house is.
    """
    houses = {"both": ("north", "south"), "none": ()}.get(spec.houses, (spec.houses,))
    for index, door in enumerate(spec.doors):
        if door.wall not in houses:
            raise BadInput(
                f"there is no house in the {door.wall}; houses is {spec.houses!r}",
                key=("place", "doors", index, "wall"),
            )
    look = StreetLook(houses=frozenset(houses), house_m=spec.house_m, sky_c=spec.sky_c)
    return street_shell(plan, look, surfaces)


def _sun(spec: SunSpec) -> Sun:
    return Sun(
        azimuth_rad=math.radians(spec.azimuth_deg),
        elevation_rad=math.radians(spec.elevation_deg),
        warms_k=spec.warms_k,
        brightens=spec.brightens,
    )


def _surfaces(spec: PlaceSpec, plan: FloorPlan) -> Surfaces:
    usual, temperatures, colours = Surfaces(), spec.temperatures, spec.colours
    walls = _material(usual.walls, temperatures.walls_c, colours.walls)
    for name in temperatures.single_walls_c:
        check_wall(plan, ("place", "temperatures", "single_walls_c"), name)
    return Surfaces(
        floor=replace(_material(usual.floor, temperatures.floor_c, colours.floor), shine=spec.floor_shine),
        ceiling=_material(usual.ceiling, temperatures.ceiling_c, colours.ceiling),
        walls=walls,
        door=_material(usual.door, _door_c(temperatures), colours.doors),
        named={
            name: replace(walls, temperature_c=temperature)
            for name, temperature in temperatures.single_walls_c.items()
        },
    )


def _door_c(temperatures: TemperaturesSpec) -> float:
    """How warm closed doors are: as the air [degC]."""
    return 21.0 if temperatures.air_c is None else temperatures.air_c


def _material(usual: Material, temperature_c: float, colour: Colour | None) -> Material:
    if colour is None:
        return replace(usual, temperature_c=temperature_c)
    rgb = resolve_colour(colour)
    darker = (0.85 * rgb[0], 0.85 * rgb[1], 0.85 * rgb[2])
    return replace(usual, temperature_c=temperature_c, rgb=rgb, second_rgb=darker)
