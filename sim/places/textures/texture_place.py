"""Texture a whole place: every surface by its covering, then the effects of objects and the sun."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from peopleboy.random_streams import stream
from peopleboy.sim.places.extent import Extent, fixture_extent
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.places.textures.coverings import (
    paint_ceiling,
    paint_facade,
    paint_flooring,
    paint_leaves,
    paint_plaster,
    paint_sky,
    paint_skyline,
    paint_street,
)
from peopleboy.sim.places.textures.sunlight import frame_doors, shine_on, warm_by
from peopleboy.sim.places.textures.surface_texture import Clouds, SurfaceTexture, begin, draw_clouds
from peopleboy.sim.shapes.materials import Covering, Material, Painting

# Temperature structure of objects: warmer above than below, and uneven.


def paint_thing(texture: SurfaceTexture, material: Material) -> None:
    """Add the gradient and the unevenness of an object."""
    texture.kelvin += material.gradient_k_per_m * (texture.up - 0.5 * texture.size[1])
    scale = min(max(0.3 * max(texture.size), 0.1), 1.5)
    texture.kelvin += max(material.uneven_k, 0.25) * texture.cloudy(scale)
    texture.light *= 1.0 + 0.03 * texture.cloudy(scale)


_PAINTERS: Mapping[Covering, Callable[[SurfaceTexture], None]] = {
    Covering.PLASTER: paint_plaster,
    Covering.FLOORING: paint_flooring,
    Covering.CEILING: paint_ceiling,
    Covering.STREET: paint_street,
    Covering.FACADE: paint_facade,
    Covering.SKY: paint_sky,
    Covering.SKYLINE: paint_skyline,
    Covering.LEAVES: paint_leaves,
}
_VARIATION = 0.4  # standard deviation of the smooth variation of a material with amplitude 1
_OFFSET_K = 0.9  # standard deviation of the mean temperature of a surface, by construction and use
_SHELL = (Covering.PLASTER, Covering.FLOORING, Covering.CEILING, Covering.STREET, Covering.FACADE)
_FLAT = (*_SHELL, Covering.SKY, Covering.SKYLINE)


def paint_place(place: Place, seed: int) -> dict[str, Painting]:
    """Return the textures of all fixtures of a place that have parts, by the fixture's name.

    Each has a separate random stream, so that adding an object does not change the walls.
    """
    clouds = draw_clouds(stream(seed, "painting.clouds"))
    parts = [(f, f.part.material) for f in place.fixtures if f.part is not None]
    moved = {mover.name for mover in place.movers}
    things = [
        (fixture, material)
        for fixture, material in parts
        if material.covering not in _FLAT and fixture.name.split("/")[0] not in moved
    ]
    return {
        fixture.name: _paint(fixture, material, place, things, clouds, seed) for fixture, material in parts
    }


def _paint(
    fixture: Fixture,
    material: Material,
    place: Place,
    things: Sequence[tuple[Fixture, Material]],
    clouds: Clouds,
    seed: int,
) -> Painting:
    rng = stream(seed, f"painting.{fixture.name}")
    texture = begin(
        fixture,
        clouds,
        rng,
        is_shell=material.covering in _FLAT,
        is_leafy=material.covering is Covering.LEAVES,
        air_k=place.surroundings_c - material.temperature_c,
    )
    painter = _PAINTERS.get(material.covering)
    if painter is None:
        paint_thing(texture, material)
    else:
        painter(texture)
    texture.kelvin += _OFFSET_K * rng.standard_normal()
    if material.covering in _SHELL:
        frame_doors(texture, _doorways(place))
        extents = [(fixture_extent(thing), other.temperature_c) for thing, other in things]
        warm_by(texture, material.temperature_c, extents)
        if place.sun is not None and material.covering is not Covering.CEILING:
            shine_on(texture, place.sun, *_sun_ways(place, things))
    if material.variation_k > 0.0:
        texture.kelvin += _VARIATION * material.variation_k * texture.cloudy(material.variation_m)
    return texture.painting()


def _doorways(place: Place) -> list[Extent]:
    """Return the boxes of all doors, from the floor to the top of the leaf or the opening."""
    found = []
    for fixture in place.fixtures:
        if fixture.name.endswith(("/leaf", "/lintel")) and fixture.name.startswith("door_"):
            low, high = fixture_extent(fixture)
            top = high[2] if fixture.name.endswith("/leaf") else low[2]
            found.append(np.array([[low[0], low[1], 0.0], [high[0], high[1], top]]))
    return found


def _sun_ways(place: Place, things: Sequence[tuple[Fixture, Material]]) -> tuple[list[Extent], list[Extent]]:
    """Return the panes through which the sun shines, and the boxes that block it."""
    panes = [
        fixture_extent(f) for f, m in things if m.covering is Covering.GLASS and f.name.endswith("/pane")
    ]
    is_open = any(m.covering is Covering.STREET for m in _materials(place))
    walls = [fixture_extent(f) for f in place.fixtures if is_open and f.name.startswith("wall_")]
    walls = [wall for wall in walls if _is_thin(wall)] if is_open else []
    others = [
        fixture_extent(f)
        for f, m in things
        if m.covering is not Covering.GLASS and not f.name.endswith("/frame")
    ]
    return ([] if is_open else panes), [*others, *walls]


def _materials(place: Place) -> list[Material]:
    return [fixture.part.material for fixture in place.fixtures if fixture.part is not None]


def _is_thin(extent: Extent) -> bool:
    return bool(np.prod((extent[1] - extent[0])[:2]) < 500.0)
