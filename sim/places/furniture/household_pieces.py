"""Things that people carry, open and close: toys, cans, doors, cupboards and drawers.

Builders as in `furniture_pieces`: size [m], temperature [degC] and colour of the main piece, which is first.
"""

import math

from peopleboy.sim.places.pieces import BLACK, SINK_M, STEEL, Piece, ball, box, standing_box, thing_kind, tube
from peopleboy.sim.shapes.materials import Rgb
from peopleboy.sim.shapes.shapes import Quaternion, Shape, Vector

_BOARD_M = 0.02
_SHELF_EVERY_M = 0.45


@thing_kind("bear", size_m=(0.42, 0.42, 0.5), temperature_c=21.5, rgb=(0.32, 0.17, 0.07))
def bear(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a sitting teddy bear, made of balls."""
    depth, width, height = size
    belly, head = 0.28 * height, 0.24 * height
    x, top = -0.12 * depth, height - 0.26 * height
    fur = (
        ball(belly, (x, 0.0, belly - SINK_M)),
        ball(head, (x + 0.04 * depth, 0.0, top)),
        *(ball(0.08 * height, (x, side * 0.19 * height, height - 0.08 * height)) for side in (-1.0, 1.0)),
        *(
            ball(0.11 * height, (x + 0.15 * depth, side * (0.5 * width - 0.11 * height), 1.35 * belly))
            for side in (-1.0, 1.0)
        ),
        *(
            ball(0.13 * height, (0.5 * depth - 0.13 * height, side * 0.26 * width, 0.13 * height))
            for side in (-1.0, 1.0)
        ),
    )
    snout = (ball(0.10 * height, (x + 0.04 * depth + 0.18 * height, 0.0, top - 0.05 * height)),)
    return (Piece("fur", fur, temperature, rgb), Piece("snout", snout, temperature, (0.62, 0.5, 0.36)))


@thing_kind("can", size_m=(0.6, 0.26, 0.4), temperature_c=20.5, rgb=(0.05, 0.18, 0.35))
def can(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a watering can: a round body with a spout in front and a handle behind."""
    depth, width, height = size
    radius, body = 0.5 * width, 0.72 * height
    x, rise = radius - 0.5 * depth, 0.62 * height
    run = 0.5 * depth - 0.1 * radius - x
    length, lean = math.hypot(run, rise), math.atan2(run, rise)
    neck = tube(length, 0.12 * radius, (x + run / 2.0, 0.0, 0.2 * height + rise / 2.0), _pitched(lean))
    thick, top = 0.12 * radius, height - body
    bow = (
        *(box((thick, 0.2 * radius, top), (x + at * radius, 0.0, body + top / 2.0)) for at in (-0.8, 0.5)),
        box((1.2 * radius, 0.16 * radius, thick), (x - 0.15 * radius, 0.0, height - 0.7 * thick)),
    )
    pot = tube(body + SINK_M, radius, (x, 0.0, (body - SINK_M) / 2.0))
    return (Piece("body", (pot, neck, *bow), temperature, rgb),)


@thing_kind("flower", size_m=(0.5, 0.5, 1.0), temperature_c=20.5, rgb=(0.05, 0.22, 0.06))
def flower(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a bush on a stem, in a portable pot."""
    _, width, height = size
    radius, pot = 0.3 * width, 0.26 * height
    bush = (
        ball(1.15 * radius, (0.0, 0.0, height - 1.15 * radius)),
        *(
            ball(radius, ((0.5 * width - radius) * x, (0.5 * width - radius) * y, z * height))
            for x, y, z in ((1.0, 0.3, 0.6), (-1.0, 0.8, 0.65), (-0.2, -1.0, 0.55), (0.2, 1.0, 0.5))
        ),
    )
    stem = tube(0.5 * height, 0.025, (0.0, 0.0, 0.45 * height))
    bowl = tube(pot + SINK_M, 0.3 * width, (0.0, 0.0, (pot - SINK_M) / 2.0))
    return (
        Piece("leaves", (*bush, stem), temperature, rgb),
        Piece("pot", (bowl,), temperature + 0.5, (0.45, 0.2, 0.1)),
    )


@thing_kind("door_leaf", size_m=(0.04, 0.93, 2.03), temperature_c=21.0, rgb=(0.45, 0.3, 0.16))
def door_leaf(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a door leaf, with a handle on both sides near the left edge, seen along x."""
    depth, width, height = size
    leaf = standing_box(depth, width, -SINK_M, height)
    at = min(1.0, 0.5 * height)
    handles = tuple(
        box((0.03, 0.1, 0.02), (side * (depth / 2.0 + 0.015), width / 2.0 - 0.08, at)) for side in (-1.0, 1.0)
    )
    return (
        Piece("leaf", (leaf,), temperature, rgb),
        Piece("handles", handles, temperature, STEEL, is_solid=False),
    )


@thing_kind("cupboard", size_m=(0.45, 0.9, 1.8), temperature_c=21.2, rgb=(0.55, 0.45, 0.33))
def cupboard(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a cupboard with shelves, open to the front."""
    depth, width, height = size
    side, inner = width / 2.0 - _BOARD_M / 2.0, width - 2.0 * _BOARD_M + 0.004
    shelves = max(round(height / _SHELF_EVERY_M), 2)
    lowest, highest = _BOARD_M / 2.0, height - _BOARD_M / 2.0 - 0.003
    boards = tuple(
        box((depth - 0.012, inner, _BOARD_M), (-0.003, 0.0, lowest + k * (highest - lowest) / shelves))
        for k in range(shelves + 1)
    )
    sides = tuple(standing_box(depth, _BOARD_M, -SINK_M, height, y=sign * side) for sign in (-1.0, 1.0))
    back = standing_box(_BOARD_M, inner - 0.002, lowest, highest, x=-depth / 2.0 + _BOARD_M / 2.0 + 0.006)
    dark: Rgb = (0.7 * rgb[0], 0.7 * rgb[1], 0.7 * rgb[2])
    return (Piece("sides", sides, temperature, rgb), Piece("shelves", (*boards, back), temperature, dark))


@thing_kind("drawer", size_m=(0.42, 0.8, 0.2), temperature_c=21.2, rgb=(0.6, 0.5, 0.38))
def drawer(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a drawer: an open box behind a front with a knob."""
    depth, width, height = size
    front = standing_box(_BOARD_M, width, -SINK_M, height, x=(depth - _BOARD_M) / 2.0)
    low, inside, middle = 0.75 * height, depth - _BOARD_M, -_BOARD_M / 2.0
    tray: tuple[Shape, ...] = (
        standing_box(inside - 0.004, width - 0.03, 0.005, _BOARD_M, x=middle),
        *(
            standing_box(inside, 0.012, 0.01, low, x=middle, y=side * (width / 2.0 - 0.02))
            for side in (-1.0, 1.0)
        ),
        standing_box(0.012, width - 0.036, 0.012, low - 0.004, x=-depth / 2.0 + 0.009),
    )
    knob = box((0.025, 0.12, 0.02), (depth / 2.0 + 0.012, 0.0, height / 2.0))
    return (
        Piece("front", (front, *tray), temperature, rgb),
        Piece("knob", (knob,), temperature, BLACK, is_solid=False),
    )


def _pitched(angle: float) -> Quaternion:
    """Return a rotation about y [rad]: an upward direction leans to the front."""
    return (0.0, math.sin(angle / 2.0), 0.0, math.cos(angle / 2.0))
