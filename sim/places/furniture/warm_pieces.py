"""The warm clutter that a tracker must not take for people: radiators, lamps, monitors, robots.

Source of the list: T fig. 4.1. Every builder takes depth, width, height [m] and the temperature
[degC] and colour of the main piece, and returns the pieces, the main one first.
"""

from __future__ import annotations

from peopleboy.sim.places.pieces import (
    ALONG_Y,
    BLACK,
    SINK_M,
    STEEL,
    WHITE,
    Piece,
    ball,
    box,
    standing_box,
    tube,
)
from peopleboy.sim.shapes.materials import Rgb
from peopleboy.sim.shapes.shapes import Vector

_MOST_RIBS = 14  # with the panel they fit into one body of 16 shapes


def radiator(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A ribbed panel on a wall: two straight warm sides, as a standing person has."""
    depth, width, height = size
    count = max(2, min(_MOST_RIBS, round(width / 0.09)))
    pitch = width / count
    panel = standing_box(
        0.6 * depth + SINK_M, width - 0.3 * pitch, 0.02, height - 0.02, x=0.3 * depth - SINK_M / 2
    )
    ribs = tuple(
        standing_box(0.6 * depth, 0.6 * pitch, 0.0, height, x=0.7 * depth, y=(k + 0.5) * pitch - width / 2.0)
        for k in range(count)
    )
    return (
        Piece(
            name="panel",
            shapes=(panel, *ribs),
            temperature_c=temperature,
            rgb=rgb,
            variation_k=1.5,
            gradient_k_per_m=14.0,
            uneven_k=1.0,
        ),
    )


def pipe(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A heating pipe that runs up a wall."""
    depth, _, height = size
    shape = tube(height + 2.0 * SINK_M, depth / 2.0, (depth / 2.0 + 0.02, 0.0, height / 2.0))
    return (Piece(name="pipe", shapes=(shape,), temperature_c=temperature, rgb=rgb, variation_k=0.6),)


def ceiling_lamp(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A bright tube under its housing."""
    depth, width, height = size
    glass = tube(0.92 * width, 0.3 * height, (0.0, 0.0, 0.3 * height), ALONG_Y)
    housing = standing_box(depth, width, 0.55 * height, height + SINK_M)
    return (
        Piece(name="tube", shapes=(glass,), temperature_c=temperature, rgb=rgb, glow=1.0, is_solid=False),
        Piece(name="housing", shapes=(housing,), temperature_c=30.0, rgb=WHITE, is_solid=False),
    )


def floor_lamp(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A hot bulb in a warm shade on a pole."""
    depth, _, height = size
    radius = depth / 2.0
    bulb = ball(0.05, (0.0, 0.0, height - 0.04))
    shade = tube(0.24, radius, (0.0, 0.0, height - 0.22))
    pole = tube(height - 0.3, 0.015, (0.0, 0.0, (height - 0.3) / 2.0))
    foot = tube(0.03 + SINK_M, 0.9 * radius, (0.0, 0.0, (0.03 - SINK_M) / 2.0))
    return (
        Piece(name="bulb", shapes=(bulb,), temperature_c=temperature, rgb=rgb, glow=1.0),
        Piece(
            name="shade", shapes=(shade,), temperature_c=36.0, rgb=(0.8, 0.7, 0.5), glow=0.6, variation_k=1.0
        ),
        Piece(name="pole", shapes=(pole, foot), temperature_c=23.0, rgb=STEEL, emissivity=0.6),
    )


def monitor(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A flat screen on a foot, warm all over in front."""
    depth, width, height = size
    bottom = 0.28 * height
    middle = (bottom + height) / 2.0
    screen = box((0.01, width - 0.04, height - bottom - 0.04), (0.02, 0.0, middle))
    case = standing_box(0.04, width, bottom, height)
    stem = standing_box(0.03, 0.06, -SINK_M, bottom + 0.05, x=-0.01)
    foot = standing_box(depth, 0.45 * width, -SINK_M, 0.02)
    return (
        Piece(
            name="screen",
            shapes=(screen,),
            temperature_c=temperature,
            rgb=rgb,
            glow=0.7,
            variation_k=0.8,
            shine=1.0,
        ),
        Piece(name="case", shapes=(case,), temperature_c=temperature - 3.0, rgb=BLACK),
        Piece(name="foot", shapes=(stem, foot), temperature_c=23.0, rgb=BLACK),
    )


def robot(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """A robot like the PeopleBot: base, column with warm electronics, and a deck with a camera."""
    depth, width, height = size
    base = (standing_box(depth, width, 0.05, 0.27), ball(0.04, (-0.4 * depth, 0.0, 0.04 - SINK_M)))
    wheels = tuple(
        tube(0.05, 0.09, (0.05, side * width / 2.0, 0.09 - SINK_M), ALONG_Y) for side in (-1.0, 1.0)
    )
    column = standing_box(0.3 * depth, 0.4 * width, 0.22, height - 0.12, x=-0.12 * depth)
    bay = standing_box(0.5 * depth, 0.55 * width, 0.30, 0.62, x=-0.1 * depth)
    deck = tube(0.1, 0.42 * width, (-0.05, 0.0, height - 0.13))
    camera = standing_box(0.1, 0.12, height - 0.1, height, x=0.05)
    return (
        Piece(name="base", shapes=base, temperature_c=temperature, rgb=rgb),
        Piece(name="wheels", shapes=wheels, temperature_c=22.0, rgb=BLACK, emissivity=0.95),
        Piece(name="column", shapes=(column,), temperature_c=temperature - 1.0, rgb=STEEL),
        Piece(name="electronics", shapes=(bay,), temperature_c=temperature + 2.5, rgb=BLACK, variation_k=0.8),
        Piece(name="deck", shapes=(deck,), temperature_c=temperature - 0.5, rgb=rgb),
        Piece(name="camera", shapes=(camera,), temperature_c=temperature + 1.5, rgb=BLACK),
    )
