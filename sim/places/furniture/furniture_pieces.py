"""Furniture at room temperature, pillars, and what hangs on walls.

Builders as in `warm_pieces`: size [m], temperature [degC] and colour of the main piece, which comes first.
"""

from __future__ import annotations

from peopleboy.sim.places.pieces import SINK_M, STEEL, WHITE, Piece, ball, standing_box, tube
from peopleboy.sim.shapes.materials import Covering, Rgb
from peopleboy.sim.shapes.shapes import Vector

# Middle of each ball of leaves, in radii sideways and as a share of the height, and its share of the radius.
_LEAVES = ((0.0, 0.0, 1.0, 1.0), (0.7, 0.4, 0.6, 0.9), (-0.6, 0.6, 0.5, 0.8), (0.0, -0.8, 0.55, 0.9))


def window(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A cold pane in a frame with a middle post, on a wall."""
    depth, width, height = size
    rail = 0.07
    pane = standing_box(
        depth / 2.0 + SINK_M, width - rail, 0.5 * rail, height - 0.5 * rail, x=(depth / 2.0 - SINK_M) / 2.0
    )
    side = (width - rail) / 2.0 - 0.002  # no face of a post lies in a rail's
    deep, middle = depth + SINK_M, (depth - SINK_M) / 2.0
    frame = (
        standing_box(deep, width, 0.0, rail, x=middle),
        standing_box(deep, width, height - rail, height, x=middle),
        *(
            standing_box(deep - 0.004, rail, 0.5 * rail, height - 0.5 * rail, x=middle - 0.002, y=y)
            for y in (-side, 0.0, side)
        ),
    )
    return (
        Piece(
            name="pane",
            shapes=(pane,),
            temperature_c=temperature,
            rgb=rgb,
            emissivity=0.9,
            glow=0.4,
            shine=1.0,
            covering=Covering.GLASS,
        ),
        Piece(name="frame", shapes=frame, temperature_c=temperature + 2.5, rgb=WHITE),
    )


def poster(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A sheet on a wall."""
    depth, width, height = size
    sheet = standing_box(depth + SINK_M, width, 0.0, height, x=(depth - SINK_M) / 2.0)
    return (Piece(name="poster", shapes=(sheet,), temperature_c=temperature, rgb=rgb),)


def table(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A board on four legs."""
    depth, width, height = size
    top = standing_box(depth, width, height - 0.035, height)
    legs = tuple(
        standing_box(
            0.05, 0.05, -SINK_M, height - 0.01, x=sx * (depth / 2.0 - 0.06), y=sy * (width / 2.0 - 0.06)
        )
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
    return (
        Piece(name="top", shapes=(top,), temperature_c=temperature, rgb=rgb),
        Piece(name="legs", shapes=legs, temperature_c=temperature - 0.5, rgb=STEEL),
    )


def chair(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A seat with a back on four legs."""
    depth, width, height = size
    seat = standing_box(depth, width, 0.42, 0.46)
    back = standing_box(0.03, width - 0.02, 0.45, height, x=-depth / 2.0 + 0.025)
    legs = tuple(
        standing_box(0.03, 0.03, -SINK_M, 0.43, x=sx * (depth / 2.0 - 0.04), y=sy * (width / 2.0 - 0.04))
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
    return (
        Piece(name="seat", shapes=(seat, back), temperature_c=temperature, rgb=rgb),
        Piece(name="legs", shapes=legs, temperature_c=temperature - 0.5, rgb=STEEL, emissivity=0.6),
    )


def block(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A plain block: a cabinet, a pillar, a box."""
    depth, width, height = size
    shape = standing_box(depth, width, -SINK_M, height)
    return (Piece(name="block", shapes=(shape,), temperature_c=temperature, rgb=rgb),)


def column(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A round pillar as thick as it is deep."""
    depth, _, height = size
    shape = tube(height + SINK_M, depth / 2.0, (0.0, 0.0, (height - SINK_M) / 2.0))
    return (Piece(name="column", shapes=(shape,), temperature_c=temperature, rgb=rgb),)


def plant(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Balls of leaves on a stem, in a pot."""
    depth, width, height = size
    pot = tube(0.3 + SINK_M, 0.3 * depth, (0.0, 0.0, (0.3 - SINK_M) / 2.0))
    stem = tube(height - 0.3, 0.03, (0.0, 0.0, 0.3 + (height - 0.3) / 2.0))
    radius = (depth + width) / 6.0
    leaves = tuple(
        ball(radius * share, (radius * x, radius * y, 0.3 + (height - 0.3 - radius) * z))
        for x, y, z, share in (
            (0.0, 0.0, 1.0, 1.0),
            (0.7, 0.4, 0.6, 0.9),
            (-0.6, 0.6, 0.5, 0.8),
            (0.0, -0.8, 0.55, 0.9),
        )
    )
    return (
        Piece(
            name="leaves",
            shapes=(*leaves, stem),
            temperature_c=temperature,
            rgb=rgb,
            covering=Covering.LEAVES,
        ),
        Piece(name="pot", shapes=(pot,), temperature_c=temperature + 0.5, rgb=(0.45, 0.2, 0.1)),
    )
