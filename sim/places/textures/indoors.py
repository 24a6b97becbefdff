"""Walls, floors and ceilings of buildings, as a thermal camera sees them.

Air is warmer above than below, corners and edges lose heat, studs carry it through, wires and pipes in the
wall bring some, and nothing is even. Sizes of these effects: textbook cases of building thermography.
"""

from __future__ import annotations

import numpy as np

from peopleboy.sim.places.textures.surface_texture import Array, Fresco

_STUDS_M, _SKIRTING_M = 0.6, 0.08
_STUDDED = 0.35  # of walls are boards on studs, the others stone
_LAYERED = 2.5  # blotches are so many times as wide as high, as air lies in layers of one warmth


def paint_plaster(fresco: Fresco) -> None:
    """A plastered wall on studs, with skirting, wires, pipes, sockets and stains."""
    rng, width = fresco.rng, fresco.size[0]
    fresco.kelvin += rng.uniform(0.5, 1.1) * (fresco.up - 1.2)
    fresco.kelvin -= _edges(fresco, rng.uniform(1.2, 3.0), 0.22)
    if rng.random() < _STUDDED:
        _studs(fresco)
    else:
        _courses(fresco)
    fresco.kelvin += rng.uniform(0.25, 0.55) * fresco.cloudy(2.8, _LAYERED) + 0.15 * fresco.cloudy(
        0.5, _LAYERED
    )
    for _ in range(rng.poisson(0.25 * width)):
        _stain(fresco)
    for _ in range(rng.poisson(0.3 * width)):
        _wire(fresco)
    for _ in range(rng.poisson(0.08 * width)):
        _pipe(fresco)
    skirting = fresco.strip(fresco.up, 0.05 + _SKIRTING_M, 0.005) + 0.0 * fresco.across
    fresco.kelvin -= rng.uniform(0.2, 1.0) * skirting
    fresco.light *= (1.0 - 0.35 * skirting) * (1.0 + 0.02 * fresco.cloudy(1.0))
    fresco.light *= 1.0 - 0.25 * np.exp(-_to_edge(fresco) / 0.12)


def paint_flooring(fresco: Fresco) -> None:
    """A floor in slabs, cold along the walls, warm where it gets sun, heating or feet."""
    rng = fresco.rng
    fresco.kelvin -= _edges(fresco, rng.uniform(0.5, 1.6), 0.35)
    fresco.kelvin += rng.uniform(0.3, 0.6) * fresco.cloudy(2.5) + 0.2 * fresco.cloudy(0.3)
    pitch = rng.choice([0.3, 0.5, 0.6, 1.0])
    joints = _joints(fresco, pitch, pitch, 0.012)
    fresco.kelvin += rng.uniform(0.15, 0.45) * fresco.cells(pitch, pitch) - rng.uniform(0.5, 1.4) * joints
    fresco.light *= (1.0 - 0.2 * joints) * (1.0 + 0.04 * fresco.cloudy(1.2))
    fresco.light *= 1.0 - 0.3 * np.exp(-_to_edge(fresco) / 0.15)


def paint_ceiling(fresco: Fresco) -> None:
    """Ceiling tiles, some of them grilles of warm or cold air."""
    rng, pitch = fresco.rng, 0.6
    joints, tiles = _joints(fresco, pitch, pitch, 0.02), fresco.cells(pitch, pitch)
    fresco.kelvin -= _edges(fresco, rng.uniform(0.4, 1.4), 0.3)
    fresco.kelvin += 0.3 * fresco.cloudy(2.0) + 0.4 * tiles - rng.uniform(0.5, 1.5) * joints
    is_grille = tiles > rng.uniform(2.0, 2.6)
    fresco.kelvin += np.where(is_grille, rng.choice([-3.0, 2.5]), 0.0) * (
        0.6 + 0.4 * _joints(fresco, 1.0, 0.06, 0.03)
    )
    fresco.light *= (1.0 - 0.3 * joints) * np.where(is_grille, 0.7, 1.0) * (1.0 + 0.02 * tiles)


def _studs(fresco: Fresco) -> None:
    """Studs behind boards, which spread what they lead through."""
    off = (fresco.across + fresco.rng.uniform(0.0, _STUDS_M)) % _STUDS_M - 0.5 * _STUDS_M
    fresco.kelvin -= fresco.rng.uniform(0.2, 0.7) * np.exp(-((off / 0.04) ** 2))


def _courses(fresco: Fresco) -> None:
    """Blocks and their joints behind plaster, which spreads what they lead through."""
    rng, high = fresco.rng, fresco.rng.uniform(0.2, 0.33)
    off = (fresco.up + rng.uniform(0.0, high)) % high - 0.5 * high
    fresco.kelvin -= rng.uniform(0.1, 0.4) * np.exp(-((off / 0.025) ** 2)) * (1.0 + 0.3 * fresco.cloudy(1.0))


def _stain(fresco: Fresco) -> None:
    """A damp, warm, leaned-on or badly insulated patch."""
    rng, (width, height) = fresco.rng, fresco.size
    u, v = rng.uniform(0.0, width), rng.uniform(0.1, height)
    wide, high = rng.uniform(0.12, 0.6, 2)
    shape = ((fresco.across - u) / wide) ** 2 + ((fresco.up - v) / high) ** 2
    fresco.kelvin += rng.normal(0.0, 1.7) * np.exp(-shape * np.clip(1.0 + 0.5 * fresco.cloudy(0.5), 0.2, 3.0))


def _wire(fresco: Fresco) -> None:
    """A wire in the wall from a socket or switch up to the ceiling; the socket is as warm again."""
    rng, width = fresco.rng, fresco.size[0]
    u, v, warm = rng.uniform(0.2, max(width - 0.2, 0.21)), rng.choice([0.35, 1.1]), rng.uniform(0.2, 0.8)
    fresco.kelvin += warm * fresco.strip(fresco.across - u, 0.008, 0.03) * (fresco.up > v)
    socket = fresco.strip(fresco.across - u, 0.04, 0.004) * fresco.strip(fresco.up - v, 0.04, 0.004)
    fresco.kelvin += 2.5 * warm * socket
    fresco.light *= 1.0 + 0.25 * socket


def _pipe(fresco: Fresco) -> None:
    """A pipe of warm or cold water behind the plaster."""
    rng, width = fresco.rng, fresco.size[0]
    at_u, at_v = rng.uniform(0.0, width), rng.uniform(0.15, 0.5)
    bent = np.where(fresco.up > at_v, fresco.across - at_u, fresco.up - at_v)
    inside = (fresco.up > at_v) | (fresco.across > at_u)
    fresco.kelvin += rng.choice([-1.5, 2.5, 4.0]) * np.exp(-((bent / 0.06) ** 2)) * inside


def _joints(fresco: Fresco, across_m: float, up_m: float, width_m: float) -> Array:
    return np.maximum(fresco.lines(fresco.across, across_m, width_m), fresco.lines(fresco.up, up_m, width_m))


def _to_edge(fresco: Fresco) -> Array:
    """(H, W) [m] to the nearest edge."""
    width, height = fresco.size
    across = np.minimum(fresco.across, width - fresco.across)
    return np.minimum(across, np.minimum(fresco.up, height - fresco.up))


def _edges(fresco: Fresco, kelvin: float, metres: float) -> Array:
    """What edges and, twice as much, corners lose [K]."""
    width, height = fresco.size
    across = np.exp(-np.minimum(fresco.across, width - fresco.across) / metres)
    return kelvin * (across + np.exp(-np.minimum(fresco.up, height - fresco.up) / metres))
