"""Where the things of a scenario stand: on the floor, against or on a wall, under the ceiling, on a thing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.schema.scenario_file import ScenarioSpec
from peopleboy.scenarios.files.schema.things import ThingSpec
from peopleboy.scenarios.files.schema.values import Colour
from peopleboy.scenarios.files.schema_errors import hint
from peopleboy.sim.people.body.clothes import COLOURS
from peopleboy.sim.physics.model_files import is_in_data
from peopleboy.sim.physics.urdf import find_urdf
from peopleboy.sim.places.extent import Extent, fixture_extent, urdf_extent
from peopleboy.sim.places.floor_plan import FloorPlan, Wall
from peopleboy.sim.places.furniture.build_thing import Thing, build_thing
from peopleboy.sim.places.furniture.thing_kinds import KINDS
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Pattern, PatternKind, Rgb

_GAP_M = 0.01  # between a wall and what stands against it
_SINK_M = 0.005  # furniture from a file reaches so far into what it stands on
Built = Mapping[str, tuple[Fixture, ...]]


@dataclass(frozen=True, slots=True)
class _Stance:
    """Where a thing stands: [m] on the floor, and heading of its front [rad]."""

    x: float
    y: float
    facing: float


def resolve_colour(colour: Colour) -> Rgb:
    """A colour by its name or as it is: linear reflectances."""
    return COLOURS[colour] if isinstance(colour, str) else colour


def name_things(things: Sequence[ThingSpec]) -> tuple[str, ...]:
    """Name every thing; one without a name is called by its kind and its number among its kind.

    Raises:
        BadInput: two things have one name.
    """
    names: list[str] = []
    for index, thing in enumerate(things):
        number = sum(other.kind == thing.kind for other in things[: index + 1])
        name = thing.name if thing.name is not None else f"{thing.kind}_{number}"
        if name in names:
            raise BadInput(
                f"{name!r} is also things[{names.index(name)}]; give each its own",
                key=("things", index, "name"),
            )
        names.append(name)
    return tuple(names)


def make_things(spec: ScenarioSpec, plan: FloorPlan, folder: Path) -> Built:
    """Build all things of a scenario, each where it belongs.

    Returns:
        Fixtures by the name of their thing, in the order of the file.

    Raises:
        BadInput: an unknown wall or thing, no place or two, or a URDF that cannot be used.
    """
    built: dict[str, tuple[Fixture, ...]] = {}
    for index, (name, thing) in enumerate(zip(name_things(spec.things), spec.things, strict=True)):
        with found_in("things", index):
            built[name] = _make_thing(
                name, thing, spec.place.height_m, spec.place.temperatures.air_c, plan, built, folder
            )
    return built


def extent_of(fixtures: Sequence[Fixture]) -> Extent:
    """The box around all fixtures of a thing."""
    extents = np.array([fixture_extent(fixture) for fixture in fixtures])
    return np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])


def _make_thing(
    name: str,
    spec: ThingSpec,
    ceiling_m: float,
    air_c: float | None,
    plan: FloorPlan,
    built: Built,
    folder: Path,
) -> tuple[Fixture, ...]:
    urdf = _find_urdf(spec, folder)
    extent = _usual_extent(spec, ceiling_m) if urdf is None else _urdf_extent(urdf) * spec.scale
    stance = _stand(spec, plan, built, extent)
    if not any(area.grown(_GAP_M).contains(stance.x, stance.y) for area in plan.walkable()):
        raise BadInput(
            f"({stance.x:g}, {stance.y:g}) is outside the floor; {describe_floor(plan)}", key=("at_m",)
        )
    depth, width, height = (float(side) for side in extent[1] - extent[0])
    return build_thing(
        Thing(
            name=name,
            kind=spec.kind,
            at_m=(stance.x, stance.y),
            base_m=_base(spec, ceiling_m, built, extent),
            facing_rad=stance.facing,
            size_m=None if urdf is not None else (depth, width, height),
            temperature_c=spec.temperature_c,
            air_c=air_c,
            emissivity=spec.emissivity,
            shine=spec.shine,
            rgb=None if spec.colour is None else resolve_colour(spec.colour),
            pattern=Pattern(kind=PatternKind[spec.pattern.kind.upper()], period_m=spec.pattern.period_m),
            urdf=urdf,
            scale=spec.scale,
        )
    )


def describe_floor(plan: FloorPlan) -> str:
    """Say where the floor is, for messages."""
    parts = (
        f"{f'{name} has ' if name else ''}x {a.min_x:g} to {a.max_x:g} and y {a.min_y:g} to {a.max_y:g}"
        for name, a in plan.areas
    )
    return f"the floor: {', '.join(parts)}"


def _usual_extent(spec: ThingSpec, ceiling_m: float) -> Extent:
    """The box around a thing of a known kind, in its own frame: the back of a hung one is at x = 0."""
    kind = KINDS[spec.kind]
    depth, width, height = kind.size_m if spec.size_m is None else spec.size_m
    if kind.is_to_ceiling and spec.size_m is None:
        height = ceiling_m + _GAP_M
    back = 0.0 if kind.is_hung else -depth / 2.0
    return np.array([[back, -width / 2.0, 0.0], [back + depth, width / 2.0, height]])


def _urdf_extent(urdf: str) -> Extent:
    with found_in("urdf"):
        return urdf_extent(find_urdf(urdf))


def _stand(spec: ThingSpec, plan: FloorPlan, built: Built, extent: Extent) -> _Stance:
    facing = math.radians(spec.facing_deg)
    if spec.wall is not None:
        return _stand_at_wall(spec, plan, extent)
    if spec.along_m is not None:
        raise BadInput("it needs the key 'wall' beside it", key=("along_m",))
    if spec.at_m is not None:
        return _Stance(*spec.at_m, facing)
    if spec.on_top_of is not None:
        below = extent_of(_below(spec.on_top_of, built))
        x, y, _ = below.mean(axis=0)
        return _Stance(float(x), float(y), facing)
    raise BadInput("missing key 'at_m'; or give 'wall' and 'along_m', or 'on_top_of'")


def _stand_at_wall(spec: ThingSpec, plan: FloorPlan, extent: Extent) -> _Stance:
    wall = _find_wall(plan, str(spec.wall))
    if spec.at_m is not None or spec.on_top_of is not None:
        raise BadInput("give either 'wall' with 'along_m', or 'at_m', or 'on_top_of'", key=("wall",))
    if spec.along_m is None:
        raise BadInput("missing key 'along_m' beside 'wall'")
    low, high = wall.side.span(wall.area)
    half = float(extent[1, 1] - extent[0, 1]) / 2.0
    if not low + half <= spec.along_m <= high - half:
        raise BadInput(
            f"{spec.along_m:g} puts it beyond the end of wall {wall.name!r}, "
            f"which reaches from {low:g} to {high:g} m",
            key=("along_m",),
        )
    x, y = wall.side.at(wall.area, spec.along_m)
    is_hung = spec.kind in KINDS and KINDS[spec.kind].is_hung
    offset = 0.0 if is_hung else _GAP_M - float(extent[0, 0])
    return _Stance(x - wall.side.value[0] * offset, y - wall.side.value[1] * offset, wall.side.inward_rad)


def _find_wall(plan: FloorPlan, name: str) -> Wall:
    walls = {wall.name: wall for wall in plan.walls()}
    if name not in walls:
        raise BadInput(f"unknown wall {name!r}; {hint(name, walls)}", key=("wall",))
    return walls[name]


def _base(spec: ThingSpec, ceiling_m: float, built: Built, extent: Extent) -> float:
    if spec.base_m is not None:
        return spec.base_m
    if spec.on_top_of is not None:
        return float(extent_of(_below(spec.on_top_of, built))[1, 2])
    if spec.kind not in KINDS:
        return -float(extent[0, 2]) - _SINK_M
    kind = KINDS[spec.kind]
    return ceiling_m - float(extent[1, 2]) if kind.is_from_ceiling else kind.base_m


def _below(name: str, built: Built) -> tuple[Fixture, ...]:
    if name not in built:
        known = f"; {hint(name, built)}" if built else ""
        raise BadInput(
            f"unknown thing {name!r} (it must come earlier in the file){known}", key=("on_top_of",)
        )
    return built[name]


def _find_urdf(spec: ThingSpec, folder: Path) -> str | None:
    """The name by which PyBullet finds the file: inside pybullet_data, or in the scenario's own folder."""
    if spec.kind != "urdf":
        if spec.urdf is not None:
            raise BadInput("only a thing of kind 'urdf' takes it", key=("urdf",))
        return None
    if spec.urdf is None:
        raise BadInput("missing key 'urdf': a file such as 'table/table.urdf'")
    name = PurePosixPath(spec.urdf)
    if name.is_absolute() or ".." in name.parts or "\\" in spec.urdf or "\0" in spec.urdf:
        raise BadInput(
            f"{spec.urdf!r} must be a file of pybullet_data or of the scenario's own folder: "
            "no '..', no absolute path",
            key=("urdf",),
        )
    own = folder / name
    if is_in_data(spec.urdf):
        return spec.urdf
    if own.is_file() and own.resolve().is_relative_to(folder.resolve()):
        return str(own.resolve())
    raise BadInput(
        f"{spec.urdf!r} is neither in pybullet_data nor in the scenario's own folder", key=("urdf",)
    )
