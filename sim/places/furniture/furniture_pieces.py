"""Furniture at room temperature, pillars, and what hangs on walls.

Builders as in `warm_pieces`: size [m], temperature [degC] and colour of the main piece, which comes first.
"""

from __future__ import annotations

from peopleboy.sim.places.pieces import (
    SINK_M,
    STEEL,
    WHITE,
    WOOD,
    Piece,
    ball,
    corner_legs,
    standing_box,
    thing_kind,
    tube,
)
from peopleboy.sim.shapes.materials import Covering, Rgb
from peopleboy.sim.shapes.shapes import Vector

# Middle of each ball of leaves, in radii sideways and as a share of the height, and its share of the radius.
_LEAVES = ((0.0, 0.0, 1.0, 1.0), (0.7, 0.4, 0.6, 0.9), (-0.6, 0.6, 0.5, 0.8), (0.0, -0.8, 0.55, 0.9))


@thing_kind(
    "window", size_m=(0.05, 1.4, 1.2), temperature_c=16.0, rgb=(0.55, 0.65, 0.75), base_m=0.95, is_hung=True
)
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
            "pane", (pane,), temperature, rgb, emissivity=0.9, glow=0.4, shine=1.0, covering=Covering.GLASS
        ),
        Piece("frame", frame, temperature + 2.5, WHITE),
    )


@thing_kind(
    "poster", size_m=(0.01, 0.6, 0.9), temperature_c=21.5, rgb=(0.7, 0.2, 0.15), base_m=1.0, is_hung=True
)
def poster(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A sheet on a wall."""
    depth, width, height = size
    sheet = standing_box(depth + SINK_M, width, 0.0, height, x=(depth - SINK_M) / 2.0)
    return (Piece("poster", (sheet,), temperature, rgb),)


@thing_kind("table", size_m=(0.75, 1.4, 0.74), temperature_c=21.5, rgb=WOOD)
def table(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A board on four legs."""
    depth, width, height = size
    top = standing_box(depth, width, height - 0.035, height)
    legs = corner_legs(0.05, height - 0.01, depth / 2.0 - 0.06, width / 2.0 - 0.06)
    return (Piece("top", (top,), temperature, rgb), Piece("legs", legs, temperature - 0.5, STEEL))


@thing_kind("chair", size_m=(0.45, 0.45, 0.9), temperature_c=21.8, rgb=(0.08, 0.1, 0.25), is_seat=True)
def chair(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A seat with a back on four legs."""
    depth, width, height = size
    seat = standing_box(depth, width, 0.42, 0.46)
    back = standing_box(0.03, width - 0.02, 0.45, height, x=-depth / 2.0 + 0.025)
    legs = corner_legs(0.03, 0.43, depth / 2.0 - 0.04, width / 2.0 - 0.04)
    return (
        Piece("seat", (seat, back), temperature, rgb),
        Piece("legs", legs, temperature - 0.5, STEEL, emissivity=0.6),
    )


@thing_kind("pillar", size_m=(0.4, 0.4, 2.7), temperature_c=21.5, rgb=(0.6, 0.58, 0.54), is_to_ceiling=True)
@thing_kind("block", size_m=(0.5, 0.5, 0.5), temperature_c=21.5, rgb=(0.5, 0.5, 0.5))
@thing_kind("cabinet", size_m=(0.42, 0.8, 1.9), temperature_c=21.3, rgb=(0.5, 0.42, 0.32))
def block(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A plain block: a cabinet, a pillar, a box."""
    depth, width, height = size
    shape = standing_box(depth, width, -SINK_M, height)
    return (Piece("block", (shape,), temperature, rgb),)


@thing_kind(
    "round_pillar", size_m=(0.4, 0.4, 2.7), temperature_c=21.5, rgb=(0.6, 0.58, 0.54), is_to_ceiling=True
)
def column(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A round pillar as thick as it is deep."""
    depth, _, height = size
    shape = tube(height + SINK_M, depth / 2.0, (0.0, 0.0, (height - SINK_M) / 2.0))
    return (Piece("column", (shape,), temperature, rgb),)


@thing_kind("plant", size_m=(0.6, 0.6, 1.4), temperature_c=20.5, rgb=(0.05, 0.22, 0.06))
def plant(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Balls of leaves on a stem, in a pot."""
    depth, width, height = size
    pot = tube(0.3 + SINK_M, 0.3 * depth, (0.0, 0.0, (0.3 - SINK_M) / 2.0))
    stem = tube(height - 0.3, 0.03, (0.0, 0.0, 0.3 + (height - 0.3) / 2.0))
    radius = (depth + width) / 6.0
    leaves = tuple(
        ball(radius * share, (radius * x, radius * y, 0.3 + (height - 0.3 - radius) * z))
        for x, y, z, share in _LEAVES
    )
    return (
        Piece("leaves", (*leaves, stem), temperature, rgb, covering=Covering.LEAVES),
        Piece("pot", (pot,), temperature + 0.5, (0.45, 0.2, 0.1)),
    )
