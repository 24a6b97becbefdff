"""Streets, facades, leaves and the sky, as a thermal camera sees them.

A clear sky looks far colder overhead than the air and hardly colder at the horizon; glass mirrors it, and
stone that had sun by day stays warm in the evening.
"""

from __future__ import annotations

import numpy as np

from peopleboy.sim.places.textures.surface_texture import Array, Fresco

_STOREY_M = 3.1
_SKY_K = 15.0  # how much colder the sky seems overhead than at the horizon


def paint_street(fresco: Fresco) -> None:
    """A road between two pavements along x: slabs, kerbs, patches, tyre tracks, marks, and manholes."""
    rng, (_, width) = fresco.rng, fresco.size
    off = np.abs(fresco.world[..., 1])
    road_m = min(3.5, 0.16 * width)
    is_road = off < road_m
    slab = rng.choice([0.4, 0.5, 0.8])
    joints = np.maximum(fresco.lines(fresco.across, slab, 0.02), fresco.lines(fresco.up, slab, 0.02))
    slabs = 0.4 * fresco.cells(slab, slab) - 1.2 * joints
    asphalt = rng.uniform(0.4, 2.0) + 0.25 * fresco.cloudy(0.12)
    asphalt = asphalt + 0.9 * fresco.strip(np.abs(off - 0.5 * road_m) - 0.75, 0.15, 0.3)
    fresco.kelvin += np.where(is_road, asphalt, slabs) + 0.5 * fresco.cloudy(4.0) + 0.2 * fresco.cloudy(0.7)
    kerb = fresco.strip(off - road_m - 0.08, 0.08, 0.02)
    mark = fresco.strip(off, 0.06, 0.01) * ((fresco.world[..., 0] % 6.0) < 3.0)
    fresco.kelvin += 1.2 * kerb - 1.4 * mark
    fresco.light *= np.where(is_road, 0.55, 1.0 + 0.05 * slabs) * (1.0 + 0.06 * fresco.cloudy(2.0))
    fresco.light *= (1.0 + 0.5 * kerb) * (1.0 + 2.5 * mark)
    for _ in range(rng.poisson(0.02 * fresco.size[0] * 2.0 * road_m)):
        _mend(fresco, road_m)
    for _ in range(rng.poisson(0.01 * fresco.size[0] * 2.0 * road_m)):
        _manhole(fresco, road_m)


def _mend(fresco: Fresco, road_m: float) -> None:
    """A patch of newer asphalt."""
    rng = fresco.rng
    x, y = rng.uniform(fresco.world[..., 0].min(), fresco.world[..., 0].max()), rng.uniform(-road_m, road_m)
    across, up = rng.uniform(0.4, 2.5, 2)
    inside = fresco.strip(fresco.world[..., 0] - x, across, 0.03) * fresco.strip(
        fresco.world[..., 1] - y, 0.4 * up, 0.03
    )
    fresco.kelvin += rng.normal(0.0, 0.9) * inside
    fresco.light *= 1.0 - rng.uniform(0.0, 0.35) * inside


def _manhole(fresco: Fresco, road_m: float) -> None:
    """A lid over a warm sewer."""
    rng = fresco.rng
    x, y = rng.uniform(fresco.world[..., 0].min(), fresco.world[..., 0].max()), rng.uniform(-road_m, road_m)
    lid = fresco.strip(np.hypot(fresco.world[..., 0] - x, fresco.world[..., 1] - y), 0.3, 0.03)
    fresco.kelvin += rng.uniform(1.0, 4.0) * lid
    fresco.light *= 1.0 - 0.4 * lid


def paint_facade(fresco: Fresco) -> None:
    """Storeys of windows that mirror the cold sky, some of lit rooms; shop windows below; stone between."""
    rng, width = fresco.rng, fresco.size[0]
    pitch = width / max(round(width / rng.uniform(1.9, 3.2)), 1)
    storey = np.floor(fresco.up / _STOREY_M)
    wide = np.where(storey < 1.0, rng.uniform(0.8, 0.9), rng.uniform(0.45, 0.62)) * pitch
    u, v = fresco.across % pitch - 0.5 * pitch, fresco.up % _STOREY_M
    sill = np.where(storey < 1.0, 0.5, 0.95)
    pane = fresco.strip(u, 0.5 * wide, 0.02) * fresco.strip(
        v - 0.5 * (sill + 2.55), 0.5 * (2.55 - sill), 0.02
    )
    frame = np.maximum(
        fresco.lines(u + 0.25 * wide, 0.5 * wide.max(), 0.06),
        fresco.lines(v, rng.choice([0.55, 0.8, 1.6]), 0.05),
    )
    each, other = fresco.cells(pitch, _STOREY_M), fresco.cells(pitch, _STOREY_M)
    glass = -5.0 - 0.9 * (fresco.up / _STOREY_M) + 1.2 * each + 1.1 * fresco.cloudy(1.5)
    glass = np.where(other > 1.2, 3.0 + each, glass)
    bricks = 0.18 * fresco.cells(0.25, 0.08) - 0.3 * fresco.lines(fresco.up, 0.08 * rng.integers(1, 6), 0.015)
    stone = bricks + 0.5 * fresco.cloudy(3.0) + 0.2 * fresco.cloudy(0.4) - 0.25 * (fresco.up - 3.0)
    stone = stone + 1.2 * fresco.strip(fresco.up % _STOREY_M - 2.95, 0.1, 0.02) * (fresco.up > 2.0)
    fresco.kelvin += pane * ((1.0 - frame) * glass + frame * 0.8) + (1.0 - pane) * stone
    dark = np.where(other > 1.2, 1.7, 0.3 + 0.08 * each)
    fresco.light *= pane * ((1.0 - frame) * dark + frame * 1.3) + (1.0 - pane) * (1.0 + 0.1 * bricks)
    for _ in range(rng.poisson(0.12 * width)):
        at = rng.uniform(0.0, width)
        pipe = fresco.strip(fresco.across - at, 0.06, 0.02) + 0.0 * fresco.up
        fresco.kelvin += rng.normal(-0.5, 1.5) * pipe
        fresco.light *= 1.0 - 0.4 * pipe


def paint_sky(fresco: Fresco) -> None:
    """The sky overhead, colder the steeper one looks, with clouds."""
    away = np.hypot(fresco.world[..., 0] - fresco.world[..., 0].mean(), fresco.world[..., 1])
    _sky(fresco, np.arctan2(fresco.world[..., 2], np.maximum(away, 1e-3)), 9.0)


def paint_skyline(fresco: Fresco) -> None:
    """The sky near the horizon, behind far houses and trees."""
    rng, (width, _) = fresco.rng, fresco.size
    _sky(fresco, np.arctan2(fresco.world[..., 2], 35.0), 6.0)
    fresco.light *= 1.05
    trees = 3.5 + 1.1 * _ridge(fresco, 9.0) + 0.5 * _ridge(fresco, 1.5)
    is_tree = fresco.up < trees
    leaves = fresco.air_k + 1.1 * fresco.cloudy(1.2) + 0.7 * fresco.cloudy(3.0) - 0.15 * fresco.up
    fresco.kelvin[:] = np.where(is_tree, leaves, fresco.kelvin)
    fresco.light[:] = np.where(is_tree, 0.28 + 0.05 * (leaves - fresco.air_k), fresco.light)
    at = 0.0
    while at < width:
        wide, tall = rng.uniform(5.0, 12.0), rng.uniform(4.0, 15.0)
        if rng.random() < 0.6:
            _house(fresco, at, wide, tall)
        at += wide + rng.exponential(4.0)


def _house(fresco: Fresco, left: float, wide: float, tall: float) -> None:
    """A far house with windows and a roof that is cold as it faces the sky."""
    rng = fresco.rng
    middle = np.abs(fresco.across - left - 0.5 * wide)
    roof = tall + np.maximum(0.6 * (0.5 * wide - middle), 0.0) * (rng.random() < 0.5)
    inside = (middle < 0.5 * wide) & (fresco.up < roof)
    u, v = (fresco.across - left) % 2.2, fresco.up % _STOREY_M
    pane = (u > 0.7) & (u < 1.8) & (v > 1.0) & (v < 2.5) & (fresco.up < tall - 0.4)
    wall = rng.normal(0.5, 1.2) + 0.4 * fresco.cloudy(2.0)
    wall = np.where(pane, rng.choice([-4.0, 2.0], p=[0.75, 0.25]) + 0.8 * fresco.cells(2.2, _STOREY_M), wall)
    fresco.kelvin[:] = np.where(inside, np.where(fresco.up > tall, -5.0, wall) + fresco.air_k, fresco.kelvin)
    shade = rng.uniform(0.35, 0.8)
    fresco.light[:] = np.where(inside, np.where(pane | (fresco.up > tall), 0.2, shade), fresco.light)


def paint_leaves(fresco: Fresco) -> None:
    """Leaves and twigs, with gaps through which other leaves show."""
    fresco.kelvin += 0.9 * fresco.cloudy(0.5) + 0.9 * fresco.cloudy(0.12)
    fresco.light *= np.clip(1.0 + 0.35 * fresco.cloudy(0.15), 0.2, 2.0)


def _sky(fresco: Fresco, elevation: Array, clouds_k: float) -> None:
    """Colder with elevation [rad] (by the path through the air); clouds send as the air up there."""
    fresco.kelvin -= _SKY_K * np.sin(np.clip(elevation, 0.0, None)) ** 0.55
    cover = np.clip(fresco.cloudy(14.0) - fresco.rng.uniform(-0.3, 0.8), 0.0, 1.2)
    fresco.kelvin += clouds_k * cover
    fresco.light *= 1.0 + 0.5 * cover


def _ridge(fresco: Fresco, metres: float) -> Array:
    """(1, W) noise along the horizon."""
    return fresco.cloudy(metres)[:1]
