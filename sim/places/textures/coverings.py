"""Thermal textures of walls, floors, streets, facades, leaves and the sky for `detail: full`.

The apparent temperature of a clear sky is far below the air's overhead, and close to it at the horizon. Glass
reflects the sky, and stone that was in the sun stays warm in the evening.
"""

import numpy as np

from peopleboy.sim.places.textures.surface_texture import Array, SurfaceTexture

_STOREY_M = 3.1
_SKY_K = 15.0  # apparent temperature of the sky at the horizon minus overhead


def paint_street(texture: SurfaceTexture) -> None:
    """Texture a road between two pavements along x: slabs, kerbs, patches, tracks, markings, manholes."""
    rng, (_, width) = texture.rng, texture.size
    off = np.abs(texture.world[..., 1])
    road_m = min(3.5, 0.16 * width)
    is_road = off < road_m
    slab = rng.choice([0.4, 0.5, 0.8])
    joints = np.maximum(texture.lines(texture.across, slab, 0.02), texture.lines(texture.up, slab, 0.02))
    slabs = 0.4 * texture.cells(slab, slab) - 1.2 * joints
    asphalt = rng.uniform(0.4, 2.0) + 0.25 * texture.cloudy(0.12)
    asphalt = asphalt + 0.9 * texture.strip(np.abs(off - 0.5 * road_m) - 0.75, 0.15, 0.3)
    texture.kelvin += (
        np.where(is_road, asphalt, slabs) + 0.5 * texture.cloudy(4.0) + 0.2 * texture.cloudy(0.7)
    )
    kerb = texture.strip(off - road_m - 0.08, 0.08, 0.02)
    mark = texture.strip(off, 0.06, 0.01) * ((texture.world[..., 0] % 6.0) < 3.0)
    texture.kelvin += 1.2 * kerb - 1.4 * mark
    texture.light *= np.where(is_road, 0.55, 1.0 + 0.05 * slabs) * (1.0 + 0.06 * texture.cloudy(2.0))
    texture.light *= (1.0 + 0.5 * kerb) * (1.0 + 2.5 * mark)
    for _ in range(rng.poisson(0.02 * texture.size[0] * 2.0 * road_m)):
        _mend(texture, road_m)
    for _ in range(rng.poisson(0.01 * texture.size[0] * 2.0 * road_m)):
        _manhole(texture, road_m)


def _mend(texture: SurfaceTexture, road_m: float) -> None:
    """Add a patch of newer asphalt."""
    rng = texture.rng
    x, y = rng.uniform(texture.world[..., 0].min(), texture.world[..., 0].max()), rng.uniform(-road_m, road_m)
    across, up = rng.uniform(0.4, 2.5, 2)
    inside = texture.strip(texture.world[..., 0] - x, across, 0.03) * texture.strip(
        texture.world[..., 1] - y, 0.4 * up, 0.03
    )
    texture.kelvin += rng.normal(0.0, 0.9) * inside
    texture.light *= 1.0 - rng.uniform(0.0, 0.35) * inside


def _manhole(texture: SurfaceTexture, road_m: float) -> None:
    """Add a lid over a warm sewer."""
    rng = texture.rng
    x, y = rng.uniform(texture.world[..., 0].min(), texture.world[..., 0].max()), rng.uniform(-road_m, road_m)
    lid = texture.strip(np.hypot(texture.world[..., 0] - x, texture.world[..., 1] - y), 0.3, 0.03)
    texture.kelvin += rng.uniform(1.0, 4.0) * lid
    texture.light *= 1.0 - 0.4 * lid


def paint_facade(texture: SurfaceTexture) -> None:
    """Texture a facade: storeys of windows that reflect the cold sky, some lit; shop windows; stone."""
    rng, width = texture.rng, texture.size[0]
    pitch = width / max(round(width / rng.uniform(1.9, 3.2)), 1)
    storey = np.floor(texture.up / _STOREY_M)
    wide = np.where(storey < 1.0, rng.uniform(0.8, 0.9), rng.uniform(0.45, 0.62)) * pitch
    u, v = texture.across % pitch - 0.5 * pitch, texture.up % _STOREY_M
    sill = np.where(storey < 1.0, 0.5, 0.95)
    pane = texture.strip(u, 0.5 * wide, 0.02) * texture.strip(
        v - 0.5 * (sill + 2.55), 0.5 * (2.55 - sill), 0.02
    )
    frame = np.maximum(
        texture.lines(u + 0.25 * wide, 0.5 * wide.max(), 0.06),
        texture.lines(v, rng.choice([0.55, 0.8, 1.6]), 0.05),
    )
    each, other = texture.cells(pitch, _STOREY_M), texture.cells(pitch, _STOREY_M)
    glass = -5.0 - 0.9 * (texture.up / _STOREY_M) + 1.2 * each + 1.1 * texture.cloudy(1.5)
    glass = np.where(other > 1.2, 3.0 + each, glass)
    bricks = 0.18 * texture.cells(0.25, 0.08) - 0.3 * texture.lines(
        texture.up, 0.08 * rng.integers(1, 6), 0.015
    )
    stone = bricks + 0.5 * texture.cloudy(3.0) + 0.2 * texture.cloudy(0.4) - 0.25 * (texture.up - 3.0)
    stone = stone + 1.2 * texture.strip(texture.up % _STOREY_M - 2.95, 0.1, 0.02) * (texture.up > 2.0)
    texture.kelvin += pane * ((1.0 - frame) * glass + frame * 0.8) + (1.0 - pane) * stone
    dark = np.where(other > 1.2, 1.7, 0.3 + 0.08 * each)
    texture.light *= pane * ((1.0 - frame) * dark + frame * 1.3) + (1.0 - pane) * (1.0 + 0.1 * bricks)
    for _ in range(rng.poisson(0.12 * width)):
        at = rng.uniform(0.0, width)
        pipe = texture.strip(texture.across - at, 0.06, 0.02) + 0.0 * texture.up
        texture.kelvin += rng.normal(-0.5, 1.5) * pipe
        texture.light *= 1.0 - 0.4 * pipe


def paint_sky(texture: SurfaceTexture) -> None:
    """Texture the sky overhead, colder with elevation, with clouds."""
    away = np.hypot(texture.world[..., 0] - texture.world[..., 0].mean(), texture.world[..., 1])
    _sky(texture, np.arctan2(texture.world[..., 2], np.maximum(away, 1e-3)), 9.0)


def paint_skyline(texture: SurfaceTexture) -> None:
    """Texture the sky near the horizon, behind distant houses and trees."""
    rng, (width, _) = texture.rng, texture.size
    _sky(texture, np.arctan2(texture.world[..., 2], 35.0), 6.0)
    texture.light *= 1.05
    trees = 3.5 + 1.1 * _ridge(texture, 9.0) + 0.5 * _ridge(texture, 1.5)
    is_tree = texture.up < trees
    leaves = texture.air_k + 1.1 * texture.cloudy(1.2) + 0.7 * texture.cloudy(3.0) - 0.15 * texture.up
    texture.kelvin[:] = np.where(is_tree, leaves, texture.kelvin)
    texture.light[:] = np.where(is_tree, 0.28 + 0.05 * (leaves - texture.air_k), texture.light)
    at = 0.0
    while at < width:
        wide, tall = rng.uniform(5.0, 12.0), rng.uniform(4.0, 15.0)
        if rng.random() < 0.6:
            _house(texture, at, wide, tall)
        at += wide + rng.exponential(4.0)


def _house(texture: SurfaceTexture, left: float, wide: float, tall: float) -> None:
    """Add a distant house with windows, and a roof that is cold as it faces the sky."""
    rng = texture.rng
    middle = np.abs(texture.across - left - 0.5 * wide)
    roof = tall + np.maximum(0.6 * (0.5 * wide - middle), 0.0) * (rng.random() < 0.5)
    inside = (middle < 0.5 * wide) & (texture.up < roof)
    u, v = (texture.across - left) % 2.2, texture.up % _STOREY_M
    pane = (u > 0.7) & (u < 1.8) & (v > 1.0) & (v < 2.5) & (texture.up < tall - 0.4)
    wall = rng.normal(0.5, 1.2) + 0.4 * texture.cloudy(2.0)
    wall = np.where(pane, rng.choice([-4.0, 2.0], p=[0.75, 0.25]) + 0.8 * texture.cells(2.2, _STOREY_M), wall)
    texture.kelvin[:] = np.where(
        inside, np.where(texture.up > tall, -5.0, wall) + texture.air_k, texture.kelvin
    )
    shade = rng.uniform(0.35, 0.8)
    texture.light[:] = np.where(inside, np.where(pane | (texture.up > tall), 0.2, shade), texture.light)


def paint_leaves(texture: SurfaceTexture) -> None:
    """Texture leaves and twigs, with gaps through which other leaves show."""
    texture.kelvin += 0.9 * texture.cloudy(0.5) + 0.9 * texture.cloudy(0.12)
    texture.light *= np.clip(1.0 + 0.35 * texture.cloudy(0.15), 0.2, 2.0)


def _sky(texture: SurfaceTexture, elevation: Array, clouds_k: float) -> None:
    """Return the sky's temperature by elevation [rad], from the path length through the air, with clouds."""
    texture.kelvin -= _SKY_K * np.sin(np.clip(elevation, 0.0, None)) ** 0.55
    cover = np.clip(texture.cloudy(14.0) - texture.rng.uniform(-0.3, 0.8), 0.0, 1.2)
    texture.kelvin += clouds_k * cover
    texture.light *= 1.0 + 0.5 * cover


def _ridge(texture: SurfaceTexture, metres: float) -> Array:
    """Return noise (1, W) along the horizon."""
    return texture.cloudy(metres)[:1]


# Walls, floors and ceilings of buildings in thermal images.
#
# Air is warmer above than below, corners and edges lose heat, studs conduct it, wires and pipes in the wall
# add some, and no surface is even. The sizes of these effects are textbook cases of building thermography.

_STUDS_M, _SKIRTING_M = 0.6, 0.08
_STUDDED = 0.35  # share of walls with boards on studs; the others are stone
_LAYERED = 2.5  # ratio of width to height of blotches, since air is stratified by temperature


def paint_plaster(texture: SurfaceTexture) -> None:
    """Texture a plastered wall on studs, with skirting, wires, pipes, sockets and stains."""
    rng, width = texture.rng, texture.size[0]
    texture.kelvin += rng.uniform(0.5, 1.1) * (texture.up - 1.2)
    texture.kelvin -= _edges(texture, rng.uniform(1.2, 3.0), 0.22)
    if rng.random() < _STUDDED:
        _studs(texture)
    else:
        _courses(texture)
    texture.kelvin += rng.uniform(0.25, 0.55) * texture.cloudy(2.8, _LAYERED) + 0.15 * texture.cloudy(
        0.5, _LAYERED
    )
    for _ in range(rng.poisson(0.25 * width)):
        _stain(texture)
    for _ in range(rng.poisson(0.3 * width)):
        _wire(texture)
    for _ in range(rng.poisson(0.08 * width)):
        _pipe(texture)
    skirting = texture.strip(texture.up, 0.05 + _SKIRTING_M, 0.005) + 0.0 * texture.across
    texture.kelvin -= rng.uniform(0.2, 1.0) * skirting
    texture.light *= (1.0 - 0.35 * skirting) * (1.0 + 0.02 * texture.cloudy(1.0))
    texture.light *= 1.0 - 0.25 * np.exp(-_to_edge(texture) / 0.12)


def paint_flooring(texture: SurfaceTexture) -> None:
    """Texture a floor of slabs, cold along the walls, warm from sun, heating or feet."""
    rng = texture.rng
    texture.kelvin -= _edges(texture, rng.uniform(0.5, 1.6), 0.35)
    texture.kelvin += rng.uniform(0.3, 0.6) * texture.cloudy(2.5) + 0.2 * texture.cloudy(0.3)
    pitch = rng.choice([0.3, 0.5, 0.6, 1.0])
    joints = _joints(texture, pitch, pitch, 0.012)
    texture.kelvin += rng.uniform(0.15, 0.45) * texture.cells(pitch, pitch) - rng.uniform(0.5, 1.4) * joints
    texture.light *= (1.0 - 0.2 * joints) * (1.0 + 0.04 * texture.cloudy(1.2))
    texture.light *= 1.0 - 0.3 * np.exp(-_to_edge(texture) / 0.15)


def paint_ceiling(texture: SurfaceTexture) -> None:
    """Texture ceiling tiles, some of them grilles of warm or cold air."""
    rng, pitch = texture.rng, 0.6
    joints, tiles = _joints(texture, pitch, pitch, 0.02), texture.cells(pitch, pitch)
    texture.kelvin -= _edges(texture, rng.uniform(0.4, 1.4), 0.3)
    texture.kelvin += 0.3 * texture.cloudy(2.0) + 0.4 * tiles - rng.uniform(0.5, 1.5) * joints
    is_grille = tiles > rng.uniform(2.0, 2.6)
    texture.kelvin += np.where(is_grille, rng.choice([-3.0, 2.5]), 0.0) * (
        0.6 + 0.4 * _joints(texture, 1.0, 0.06, 0.03)
    )
    texture.light *= (1.0 - 0.3 * joints) * np.where(is_grille, 0.7, 1.0) * (1.0 + 0.02 * tiles)


def _studs(texture: SurfaceTexture) -> None:
    """Add studs behind boards, whose heat spreads in the boards."""
    off = (texture.across + texture.rng.uniform(0.0, _STUDS_M)) % _STUDS_M - 0.5 * _STUDS_M
    texture.kelvin -= texture.rng.uniform(0.2, 0.7) * np.exp(-((off / 0.04) ** 2))


def _courses(texture: SurfaceTexture) -> None:
    """Add blocks and joints behind plaster, which spreads their heat."""
    rng, high = texture.rng, texture.rng.uniform(0.2, 0.33)
    off = (texture.up + rng.uniform(0.0, high)) % high - 0.5 * high
    texture.kelvin -= (
        rng.uniform(0.1, 0.4) * np.exp(-((off / 0.025) ** 2)) * (1.0 + 0.3 * texture.cloudy(1.0))
    )


def _stain(texture: SurfaceTexture) -> None:
    """Add a damp, warm, touched or badly insulated patch."""
    rng, (width, height) = texture.rng, texture.size
    u, v = rng.uniform(0.0, width), rng.uniform(0.1, height)
    wide, high = rng.uniform(0.12, 0.6, 2)
    shape = ((texture.across - u) / wide) ** 2 + ((texture.up - v) / high) ** 2
    texture.kelvin += rng.normal(0.0, 1.7) * np.exp(
        -shape * np.clip(1.0 + 0.5 * texture.cloudy(0.5), 0.2, 3.0)
    )


def _wire(texture: SurfaceTexture) -> None:
    """Add a wire in the wall from a socket or switch to the ceiling; the socket is twice as warm."""
    rng, width = texture.rng, texture.size[0]
    u, v, warm = rng.uniform(0.2, max(width - 0.2, 0.21)), rng.choice([0.35, 1.1]), rng.uniform(0.2, 0.8)
    texture.kelvin += warm * texture.strip(texture.across - u, 0.008, 0.03) * (texture.up > v)
    socket = texture.strip(texture.across - u, 0.04, 0.004) * texture.strip(texture.up - v, 0.04, 0.004)
    texture.kelvin += 2.5 * warm * socket
    texture.light *= 1.0 + 0.25 * socket


def _pipe(texture: SurfaceTexture) -> None:
    """Add a pipe with warm or cold water behind the plaster."""
    rng, width = texture.rng, texture.size[0]
    at_u, at_v = rng.uniform(0.0, width), rng.uniform(0.15, 0.5)
    bent = np.where(texture.up > at_v, texture.across - at_u, texture.up - at_v)
    inside = (texture.up > at_v) | (texture.across > at_u)
    texture.kelvin += rng.choice([-1.5, 2.5, 4.0]) * np.exp(-((bent / 0.06) ** 2)) * inside


def _joints(texture: SurfaceTexture, across_m: float, up_m: float, width_m: float) -> Array:
    return np.maximum(
        texture.lines(texture.across, across_m, width_m), texture.lines(texture.up, up_m, width_m)
    )


def _to_edge(texture: SurfaceTexture) -> Array:
    """Return the distance (H, W) [m] to the nearest edge."""
    width, height = texture.size
    across = np.minimum(texture.across, width - texture.across)
    return np.minimum(across, np.minimum(texture.up, height - texture.up))


def _edges(texture: SurfaceTexture, kelvin: float, metres: float) -> Array:
    """Return the cooling of edges, and twice as much of corners [K]."""
    width, height = texture.size
    across = np.exp(-np.minimum(texture.across, width - texture.across) / metres)
    return kelvin * (across + np.exp(-np.minimum(texture.up, height - texture.up) / metres))
