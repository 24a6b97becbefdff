"""Walls, floors and ceilings of buildings, as a thermal camera sees them.

Air is warmer above than below, corners and edges lose heat, studs carry it through, wires and pipes in the
wall bring some, and nothing is even. Sizes of these effects: textbook cases of building thermography.
"""

from __future__ import annotations

import numpy as np

from peopleboy.sim.places.textures.surface_texture import Array, SurfaceTexture

_STUDS_M, _SKIRTING_M = 0.6, 0.08
_STUDDED = 0.35  # of walls are boards on studs, the others stone
_LAYERED = 2.5  # blotches are so many times as wide as high, as air lies in layers of one warmth


def paint_plaster(texture: SurfaceTexture) -> None:
    """A plastered wall on studs, with skirting, wires, pipes, sockets and stains."""
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
    """A floor in slabs, cold along the walls, warm where it gets sun, heating or feet."""
    rng = texture.rng
    texture.kelvin -= _edges(texture, rng.uniform(0.5, 1.6), 0.35)
    texture.kelvin += rng.uniform(0.3, 0.6) * texture.cloudy(2.5) + 0.2 * texture.cloudy(0.3)
    pitch = rng.choice([0.3, 0.5, 0.6, 1.0])
    joints = _joints(texture, pitch, pitch, 0.012)
    texture.kelvin += rng.uniform(0.15, 0.45) * texture.cells(pitch, pitch) - rng.uniform(0.5, 1.4) * joints
    texture.light *= (1.0 - 0.2 * joints) * (1.0 + 0.04 * texture.cloudy(1.2))
    texture.light *= 1.0 - 0.3 * np.exp(-_to_edge(texture) / 0.15)


def paint_ceiling(texture: SurfaceTexture) -> None:
    """Ceiling tiles, some of them grilles of warm or cold air."""
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
    """Studs behind boards, which spread what they lead through."""
    off = (texture.across + texture.rng.uniform(0.0, _STUDS_M)) % _STUDS_M - 0.5 * _STUDS_M
    texture.kelvin -= texture.rng.uniform(0.2, 0.7) * np.exp(-((off / 0.04) ** 2))


def _courses(texture: SurfaceTexture) -> None:
    """Blocks and their joints behind plaster, which spreads what they lead through."""
    rng, high = texture.rng, texture.rng.uniform(0.2, 0.33)
    off = (texture.up + rng.uniform(0.0, high)) % high - 0.5 * high
    texture.kelvin -= (
        rng.uniform(0.1, 0.4) * np.exp(-((off / 0.025) ** 2)) * (1.0 + 0.3 * texture.cloudy(1.0))
    )


def _stain(texture: SurfaceTexture) -> None:
    """A damp, warm, leaned-on or badly insulated patch."""
    rng, (width, height) = texture.rng, texture.size
    u, v = rng.uniform(0.0, width), rng.uniform(0.1, height)
    wide, high = rng.uniform(0.12, 0.6, 2)
    shape = ((texture.across - u) / wide) ** 2 + ((texture.up - v) / high) ** 2
    texture.kelvin += rng.normal(0.0, 1.7) * np.exp(
        -shape * np.clip(1.0 + 0.5 * texture.cloudy(0.5), 0.2, 3.0)
    )


def _wire(texture: SurfaceTexture) -> None:
    """A wire in the wall from a socket or switch up to the ceiling; the socket is as warm again."""
    rng, width = texture.rng, texture.size[0]
    u, v, warm = rng.uniform(0.2, max(width - 0.2, 0.21)), rng.choice([0.35, 1.1]), rng.uniform(0.2, 0.8)
    texture.kelvin += warm * texture.strip(texture.across - u, 0.008, 0.03) * (texture.up > v)
    socket = texture.strip(texture.across - u, 0.04, 0.004) * texture.strip(texture.up - v, 0.04, 0.004)
    texture.kelvin += 2.5 * warm * socket
    texture.light *= 1.0 + 0.25 * socket


def _pipe(texture: SurfaceTexture) -> None:
    """A pipe of warm or cold water behind the plaster."""
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
    """(H, W) [m] to the nearest edge."""
    width, height = texture.size
    across = np.minimum(texture.across, width - texture.across)
    return np.minimum(across, np.minimum(texture.up, height - texture.up))


def _edges(texture: SurfaceTexture, kelvin: float, metres: float) -> Array:
    """What edges and, twice as much, corners lose [K]."""
    width, height = texture.size
    across = np.exp(-np.minimum(texture.across, width - texture.across) / metres)
    return kelvin * (across + np.exp(-np.minimum(texture.up, height - texture.up) / metres))
