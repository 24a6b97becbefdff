"""Placement of a scenario's things: on the floor, at or on a wall, under the ceiling, on a thing."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath

import numpy as np

from peopleboy.bad_input import BadInput, found_in
from peopleboy.sim.physics.urdf import find_urdf, is_in_data
from peopleboy.sim.places.extent import Extent, fixture_extent, urdf_extent
from peopleboy.sim.places.floor_plan import FloorPlan, Wall
from peopleboy.sim.places.furniture.thing_config import KINDS, ThingConfig
from peopleboy.sim.places.moving import Stance
from peopleboy.sim.places.pieces import Kind, Piece
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material, Pattern, PatternKind, rgb_of
from peopleboy.sim.shapes.shapes import Part, Vector
from peopleboy.wording import hint

_USUAL_AIR_C = 21.0  # air temperature for which the kinds' temperatures are given
_SHADE = 0.45  # brightness of a pattern's second colour, as a share of the first


def build_thing(
    config: ThingConfig,
    stance: Stance,
    *,
    name: str | None = None,
    size_m: Vector | None = None,
    air_c: float | None = None,
    urdf: str | None = None,
) -> tuple[Fixture, ...]:
    """Build a thing as fixtures named "name/piece", or just "name" for a single piece.

    Args:
        config: its kind, and the appearance of its main surface.
        stance: its pose.
        name: unique name in the place; None for the name in the settings.
        size_m: [m] depth, width, height; None for the kind's usual size.
        air_c: [degC] air temperature of the place, which unheated things follow; None for the usual one.
        urdf: file of a thing of kind "urdf", as PyBullet finds it.
    """
    name = config.name or config.kind if name is None else name
    if config.kind == "urdf":
        material = Material(
            temperature_c=_given(config.temperature_c, _USUAL_AIR_C),
            emissivity=config.emissivity,
            shine=_given(config.shine, 0.0),
        )
        return (
            Fixture(
                name=name,
                urdf=urdf,
                material=material,
                scale=config.scale,
                position=stance.position_m,
                orientation=stance.orientation,
            ),
        )
    pieces = _pieces(config, KINDS[config.kind], size_m, air_c)
    return tuple(
        Fixture(
            name=f"{name}/{piece.name}" if len(pieces) > 1 else name,
            part=Part(name=piece.name, shapes=piece.shapes, material=_material(piece)),
            position=stance.position_m,
            orientation=stance.orientation,
            is_solid=piece.is_solid,
        )
        for piece in pieces
    )


def _pieces(config: ThingConfig, kind: Kind, size_m: Vector | None, air_c: float | None) -> tuple[Piece, ...]:
    """Return the pieces of a thing; emissivity, shine and pattern apply to the first, main piece."""
    rgb = kind.rgb if config.colour is None else rgb_of(config.colour)
    warmer_k = 0.0 if air_c is None else air_c - _USUAL_AIR_C
    usual_c = kind.temperature_c if kind.is_heated else kind.temperature_c + warmer_k
    size = kind.size_m if size_m is None else size_m
    main, *others = kind.build(size, _given(config.temperature_c, usual_c), rgb)
    if kind.is_heated:
        others = [replace(piece, temperature_c=piece.temperature_c + warmer_k) for piece in others]
    pattern = Pattern(kind=PatternKind[config.pattern.kind.upper()], period_m=config.pattern.period_m)
    shine = _given(config.shine, main.shine)
    return (replace(main, emissivity=config.emissivity, shine=shine, pattern=pattern), *others)


def _given(value: float | None, default: float) -> float:
    return default if value is None else value


def _material(piece: Piece) -> Material:
    red, green, blue = (_SHADE * part for part in piece.rgb)
    return Material(
        temperature_c=piece.temperature_c,
        emissivity=piece.emissivity,
        variation_k=piece.variation_k,
        variation_m=0.5,
        rgb=piece.rgb,
        second_rgb=(red, green, blue),
        colour_pattern=piece.pattern,
        glow=piece.glow,
        shine=piece.shine,
        covering=piece.covering,
        gradient_k_per_m=piece.gradient_k_per_m,
        uneven_k=piece.uneven_k,
        is_clear=piece.is_clear,
    )


_GAP_M = 0.01  # gap between a wall and a thing that stands against it
_SINK_M = 0.005  # furniture from a file sinks this far into the surface below


def name_things(things: Sequence[ThingConfig]) -> tuple[str, ...]:
    """Name every thing; the default name is the kind with a number.

    Raises:
        BadInput: two things have the same name.
    """
    names: list[str] = []
    for index, thing in enumerate(things):
        number = sum(other.kind == thing.kind for other in things[: index + 1])
        name = thing.name if thing.name is not None else f"{thing.kind}_{number}"
        if name in names:
            raise BadInput(
                f"{name!r} is also the name of things[{names.index(name)}]; names must be unique",
                key=("things", index, "name"),
            )
        names.append(name)
    return tuple(names)


@dataclass(frozen=True, slots=True)
class Furnishing:
    """A floor on which things are placed in order.

    Attributes:
        plan: the floor plan.
        ceiling_m: height of the ceiling.
        air_c: [degC] air temperature; None for the usual one.
        folder: folder of the scenario's own URDF files.
        placed: fixtures of the things so far, by name, in order.
    """

    plan: FloorPlan
    ceiling_m: float
    air_c: float | None
    folder: Path
    placed: dict[str, tuple[Fixture, ...]] = field(default_factory=dict)

    def place(self, things: Sequence[ThingConfig]) -> Mapping[str, tuple[Fixture, ...]]:
        """Build all things at their positions.

        Raises:
            BadInput: a wall or thing is unknown, the position is missing or ambiguous, or a URDF is unusable.
        """
        for index, (name, thing) in enumerate(zip(name_things(things), things, strict=True)):
            with found_in("things", index):
                self.placed[name] = self._build(name, thing)
        return self.placed

    def _build(self, name: str, thing: ThingConfig) -> tuple[Fixture, ...]:
        urdf = _find_urdf(thing, self.folder)
        extent = self._usual_extent(thing) if urdf is None else _urdf_extent(urdf) * thing.scale
        stance = self._stance(thing, extent)
        x, y, _ = stance.position_m
        if not any(area.grown(_GAP_M).contains(x, y) for area in self.plan.walkable()):
            raise BadInput(f"({x:g}, {y:g}) is outside the floor; {self.plan.describe()}", key=("at_m",))
        depth, width, height = (float(side) for side in extent[1] - extent[0])
        size = None if urdf is not None else (depth, width, height)
        return build_thing(thing, stance, name=name, size_m=size, air_c=self.air_c, urdf=urdf)

    def _usual_extent(self, thing: ThingConfig) -> Extent:
        """Return the box around a thing of a known kind, in its frame; a wall-mounted one starts at x = 0."""
        kind = KINDS[thing.kind]
        depth, width, height = kind.size_m if thing.size_m is None else thing.size_m
        if kind.is_to_ceiling and thing.size_m is None:
            height = self.ceiling_m + _GAP_M
        back = 0.0 if kind.is_hung else -depth / 2.0
        return np.array([[back, -width / 2.0, 0.0], [back + depth, width / 2.0, height]])

    def _stance(self, thing: ThingConfig, extent: Extent) -> Stance:
        x, y, facing = self._on_floor(thing, extent)
        return Stance((x, y, self._base(thing, extent)), facing)

    def _on_floor(self, thing: ThingConfig, extent: Extent) -> tuple[float, float, float]:
        """Return (x, y) [m] on the floor, and the heading of the front [rad]."""
        facing = math.radians(thing.facing_deg)
        if thing.wall is not None:
            return self._at_wall(thing, extent)
        if thing.along_m is not None:
            raise BadInput("missing key 'wall', which this kind requires", key=("along_m",))
        if thing.at_m is not None:
            return *thing.at_m, facing
        if thing.on_top_of is not None:
            x, y, _ = extent_of(self._below(thing.on_top_of)).mean(axis=0)
            return float(x), float(y), facing
        raise BadInput("missing key 'at_m'; or give 'wall' and 'along_m', or 'on_top_of'")

    def _at_wall(self, thing: ThingConfig, extent: Extent) -> tuple[float, float, float]:
        wall = self._find_wall(str(thing.wall))
        if thing.at_m is not None or thing.on_top_of is not None:
            raise BadInput("give either 'wall' with 'along_m', or 'at_m', or 'on_top_of'", key=("wall",))
        if thing.along_m is None:
            raise BadInput("missing key 'along_m', which 'wall' needs")
        low, high = wall.side.span(wall.area)
        half = float(extent[1, 1] - extent[0, 1]) / 2.0
        if not low + half <= thing.along_m <= high - half:
            raise BadInput(
                f"{thing.along_m:g} is beyond the end of wall {wall.name!r}, "
                f"which reaches from {low:g} to {high:g} m",
                key=("along_m",),
            )
        x, y = wall.side.at(wall.area, thing.along_m)
        is_hung = thing.kind in KINDS and KINDS[thing.kind].is_hung
        offset = 0.0 if is_hung else _GAP_M - float(extent[0, 0])
        return x - wall.side.value[0] * offset, y - wall.side.value[1] * offset, wall.side.inward_rad

    def _find_wall(self, name: str) -> Wall:
        walls = {wall.name: wall for wall in self.plan.walls()}
        if name not in walls:
            raise BadInput(f"unknown wall {name!r}; {hint(name, walls)}", key=("wall",))
        return walls[name]

    def _base(self, thing: ThingConfig, extent: Extent) -> float:
        """Return the height of a thing's foot [m]."""
        if thing.base_m is not None:
            return thing.base_m
        if thing.on_top_of is not None:
            return float(extent_of(self._below(thing.on_top_of))[1, 2])
        if thing.kind not in KINDS:
            return -float(extent[0, 2]) - _SINK_M
        kind = KINDS[thing.kind]
        return self.ceiling_m - float(extent[1, 2]) if kind.is_from_ceiling else kind.base_m

    def _below(self, name: str) -> tuple[Fixture, ...]:
        if name not in self.placed:
            known = f"; {hint(name, self.placed)}" if self.placed else ""
            raise BadInput(
                f"unknown thing {name!r} (it must come earlier in the file){known}", key=("on_top_of",)
            )
        return self.placed[name]


def extent_of(fixtures: Sequence[Fixture]) -> Extent:
    """Return the box around all fixtures of a thing."""
    extents = np.array([fixture_extent(fixture) for fixture in fixtures])
    return np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])


def _urdf_extent(urdf: str) -> Extent:
    with found_in("urdf"):
        return urdf_extent(find_urdf(urdf))


def _find_urdf(thing: ThingConfig, folder: Path) -> str | None:
    """Return the path for PyBullet of a file in pybullet_data or in the scenario's folder."""
    if thing.kind != "urdf":
        if thing.urdf is not None:
            raise BadInput("only a thing of kind 'urdf' uses it", key=("urdf",))
        return None
    if thing.urdf is None:
        raise BadInput("missing key 'urdf': a file such as 'table/table.urdf'")
    name = PurePosixPath(thing.urdf)
    if name.is_absolute() or ".." in name.parts or "\\" in thing.urdf or "\0" in thing.urdf:
        raise BadInput(
            f"{thing.urdf!r} must be a file of pybullet_data or of the scenario's own folder: "
            "no '..', no absolute path",
            key=("urdf",),
        )
    own = folder / name
    if is_in_data(thing.urdf):
        return thing.urdf
    if own.is_file() and own.resolve().is_relative_to(folder.resolve()):
        return str(own.resolve())
    raise BadInput(
        f"{thing.urdf!r} is neither in pybullet_data nor in the scenario's own folder", key=("urdf",)
    )
