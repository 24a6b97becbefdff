"""Warm appliances and other things of kitchens, halls and workshops.

Builders as in `furniture_pieces`: size [m], temperature [degC] and colour of the main piece, which is first.
"""

import math

from peopleboy.sim.places.pieces import (
    ALONG_Y,
    BLACK,
    SINK_M,
    STEEL,
    WHITE,
    WOOD,
    Piece,
    ball,
    box,
    corner_legs,
    standing_box,
    thing_kind,
    tube,
)
from peopleboy.sim.shapes.materials import Covering, Rgb
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind, Vector

ALONG_X: Quaternion = (0.0, math.sin(math.pi / 4.0), 0.0, math.cos(math.pi / 4.0))


def capsule(length: float, radius: float, position: Vector, orientation: Quaternion) -> Shape:
    """Make a capsule from the length between its caps, radius and centre [m]."""
    return Shape(
        kind=ShapeKind.CAPSULE, size=(length, radius, 0.0), position=position, orientation=orientation
    )


@thing_kind(
    "light_panel",
    size_m=(0.6, 0.6, 0.04),
    temperature_c=31.0,
    rgb=(1.0, 1.0, 0.97),
    is_from_ceiling=True,
    is_heated=True,
)
def lit_shade(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a flat LED panel under the ceiling, hardly warmer than a hand."""
    depth, width, height = size
    panel = standing_box(depth, width, 0.0, height + SINK_M)
    return (Piece("panel", (panel,), temperature, rgb, glow=1.0, uneven_k=0.8, is_solid=False),)


@thing_kind(
    "screen",
    size_m=(0.06, 1.25, 0.72),
    temperature_c=33.0,
    rgb=(0.3, 0.45, 0.7),
    base_m=1.2,
    is_hung=True,
    is_heated=True,
)
def screen(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a large flat screen on a wall, warmest at the top."""
    depth, width, height = size
    glass = standing_box(0.5 * depth, width - 0.03, 0.015, height - 0.015, x=0.75 * depth + 0.002)
    case = standing_box(0.8 * depth + SINK_M, width, 0.0, height, x=0.4 * depth - SINK_M / 2.0)
    return (
        Piece("glass", (glass,), temperature, rgb, glow=0.7, gradient_k_per_m=5.0, uneven_k=0.9, shine=0.8),
        Piece("case", (case,), temperature - 3.0, BLACK),
    )


@thing_kind("kettle", size_m=(0.25, 0.18, 0.26), temperature_c=70.0, rgb=STEEL, is_heated=True)
def kettle(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a kettle that has boiled, on its base."""
    depth, width, height = size
    radius, x = 0.5 * width, 0.5 * (width - depth)
    jug = tube(0.8 * height, 0.92 * radius, (x, 0.0, 0.55 * height))
    lid = tube(0.06 * height, 0.5 * radius, (x, 0.0, 0.97 * height))
    base = tube(0.16 * height, radius, (x, 0.0, 0.08 * height - SINK_M))
    handle = standing_box(0.02, 0.025, 0.3 * height, 0.9 * height, x=0.5 * depth - 0.01)
    bridge = standing_box(depth - width, 0.02, 0.82 * height, 0.88 * height, x=0.5 * width - 0.006)
    return (
        Piece("jug", (jug,), temperature, rgb, gradient_k_per_m=-60.0, uneven_k=2.0),
        Piece("base", (base, handle, bridge, lid), 28.0, BLACK),
    )


@thing_kind("fridge", size_m=(0.62, 0.6, 1.8), temperature_c=20.0, rgb=WHITE)
def fridge(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a fridge over a freezer: cool doors, cold seals, and warm air from below."""
    depth, width, height = size
    body = standing_box(depth - 0.02, width, 0.09, height, x=-0.01)
    seals = tuple(
        box((0.012, width - 0.04, 0.02), (depth / 2.0 - 0.015, 0.0, at * height)) for at in (0.36, 0.985)
    )
    grille = standing_box(depth - 0.05, width - 0.02, -SINK_M, 0.1)
    handles = tuple(
        standing_box(0.03, 0.025, low * height, high * height, x=depth / 2.0, y=0.38 * width)
        for low, high in ((0.2, 0.34), (0.4, 0.6))
    )
    return (
        Piece("body", (body,), temperature, rgb, gradient_k_per_m=-1.2, uneven_k=0.4),
        Piece("seals", seals, temperature - 4.5, STEEL, is_solid=False),
        Piece("grille", (grille,), 33.0, BLACK, uneven_k=1.5),
        Piece("handles", handles, temperature, STEEL, is_solid=False),
    )


@thing_kind("oven", size_m=(0.6, 0.6, 0.9), temperature_c=46.0, rgb=WHITE, is_heated=True)
def oven(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a stove with a hot pane in front, and hobs on top, one of them hot."""
    depth, width, height = size
    pane = standing_box(0.02, 0.7 * width, 0.28 * height, 0.68 * height, x=depth / 2.0 - 0.008)
    body = standing_box(depth - 0.02, width, -SINK_M, height - 0.02, x=-0.01)
    plates = tuple(
        tube(0.02, 0.16 * width, (sx * 0.22 * depth, sy * 0.24 * width, height - 0.012))
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
    rail = box((0.02, 0.8 * width, 0.02), (depth / 2.0 + 0.02, 0.0, 0.76 * height))
    return (
        Piece("glass", (pane,), temperature, BLACK, uneven_k=2.0, is_solid=False),
        Piece("body", (body,), 26.0, rgb, gradient_k_per_m=6.0, uneven_k=0.6),
        Piece("hot_plate", plates[:1], temperature + 25.0, BLACK, is_solid=False),
        Piece("plates", plates[1:], 29.0, BLACK, is_solid=False),
        Piece("rail", (rail,), 27.0, STEEL, is_solid=False),
    )


@thing_kind("counter", size_m=(0.6, 2.4, 0.9), temperature_c=21.2, rgb=WHITE)
def counter(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a counter or kitchen unit: doors below a worktop."""
    depth, width, height = size
    doors = max(2, min(round(width / 0.6), 12))
    pitch = width / doors
    fronts = tuple(
        standing_box(
            0.03, pitch - 0.02, 0.12, height - 0.06, x=depth / 2.0 - 0.03, y=(k + 0.5) * pitch - width / 2.0
        )
        for k in range(doors)
    )
    body = standing_box(depth - 0.06, width - 0.02, -SINK_M, height - 0.03, x=-0.02)
    board = standing_box(depth, width, height - 0.04, height)
    return (
        Piece("fronts", fronts, temperature, rgb, uneven_k=0.4, gradient_k_per_m=0.8),
        Piece("body", (body,), temperature - 1.0, BLACK, gradient_k_per_m=1.0),
        Piece("board", (board,), temperature + 0.6, STEEL, uneven_k=0.7),
    )


@thing_kind("shelf", size_m=(0.45, 1.2, 1.9), temperature_c=21.5, rgb=(0.45, 0.33, 0.2))
def shelf_of_boxes(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a rack with boxes on its shelves."""
    depth, width, height = size
    levels = 4
    boards = tuple(
        standing_box(depth, width, at - 0.03, at)
        for at in (0.08, *(0.08 + (height - 0.08) * k / (levels - 1) for k in range(1, levels)))
    )
    posts = corner_legs(0.03, height - 0.012, depth / 2.0 - 0.02, width / 2.0 - 0.02)
    gap = (height - 0.08) / (levels - 1)
    boxes = tuple(
        standing_box(
            0.8 * depth,
            (0.16 + 0.05 * ((k + j) % 3)) * width,
            0.075 + j * gap,
            0.08 + j * gap + (0.4 + 0.13 * ((2 * k + j) % 3)) * gap,
            y=(0.3 * k - 0.3) * width,
        )
        for j in range(levels - 1)
        for k in range(3)
    )
    return (
        Piece("boxes", boxes, temperature, rgb, uneven_k=1.0, gradient_k_per_m=0.8),
        Piece("rack", (*boards, *posts), temperature - 1.0, STEEL, emissivity=0.7),
    )


@thing_kind("vending_machine", size_m=(0.8, 0.95, 1.85), temperature_c=24.5, rgb=(0.5, 0.05, 0.06))
def vending_machine(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a vending machine: a lit cool pane, and below it warm air and a slot."""
    depth, width, height = size
    pane = standing_box(
        0.02, 0.62 * width, 0.34 * height, 0.93 * height, x=depth / 2.0 - 0.005, y=0.12 * width
    )
    panel = standing_box(
        0.02, 0.16 * width, 0.45 * height, 0.8 * height, x=depth / 2.0 - 0.004, y=-0.36 * width
    )
    grille = standing_box(0.02, 0.8 * width, 0.04, 0.16 * height, x=depth / 2.0 - 0.003)
    body = standing_box(depth - 0.01, width, -SINK_M, height, x=-0.005)
    return (
        Piece("body", (body,), temperature, rgb, gradient_k_per_m=2.0, uneven_k=0.6),
        Piece(
            "window",
            (pane,),
            temperature - 6.0,
            (0.7, 0.75, 0.8),
            glow=0.6,
            emissivity=0.87,
            gradient_k_per_m=2.0,
            uneven_k=0.8,
            is_solid=False,
        ),
        Piece("panel", (panel,), 34.0, BLACK, glow=0.2, is_solid=False),
        Piece("grille", (grille,), 38.0, BLACK, uneven_k=2.0, is_solid=False),
    )


@thing_kind("machine", size_m=(0.9, 2.0, 1.35), temperature_c=44.0, rgb=(0.12, 0.25, 0.2), is_heated=True)
def machine(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a machine tool: a bed, a headstock, and a hot ribbed motor behind."""
    depth, width, height = size
    bed = (
        standing_box(depth, 0.9 * width, 0.04, 0.5 * height),
        standing_box(0.9 * depth, width, -SINK_M, 0.06),
        standing_box(0.7 * depth, 0.18 * width, 0.45 * height, 0.7 * height, y=-0.35 * width),
    )
    head = standing_box(0.85 * depth, 0.34 * width, 0.48 * height, height, y=0.33 * width)
    radius = 0.16 * height
    motor = tube(0.36 * width, radius, (0.2 * depth, 0.0, 0.5 * height + radius), ALONG_Y)
    ribs = tuple(
        tube(0.015, 1.12 * radius, (0.2 * depth, (k - 2.5) * 0.05 * width, 0.5 * height + radius), ALONG_Y)
        for k in range(6)
    )
    panel = standing_box(0.04, 0.2 * width, 0.72 * height, 0.94 * height, x=0.44 * depth, y=0.33 * width)
    return (
        Piece("motor", (motor, *ribs), temperature, STEEL, uneven_k=2.5),
        Piece("bed", bed, 22.0, rgb, emissivity=0.85, gradient_k_per_m=4.0, uneven_k=0.8),
        Piece("head", (head,), 27.5, rgb, gradient_k_per_m=5.0, uneven_k=1.2),
        Piece("panel", (panel,), 31.0, BLACK, glow=0.2, is_solid=False),
    )


@thing_kind("glass_wall", size_m=(0.08, 2.4, 2.4), temperature_c=19.5, rgb=(0.45, 0.55, 0.55))
def glass_wall(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a full-height pane in a frame of posts, which reflects the heat of people and lets light pass."""
    depth, width, height = size
    pane = standing_box(0.4 * depth, width - 0.02, 0.02, height - 0.02)
    count = max(round(width / 1.2), 1)
    posts = tuple(
        standing_box(0.9 * depth, 0.06, -SINK_M, height - 0.004, y=(k / count - 0.5) * (width - 0.062))
        for k in range(min(count, 13) + 1)
    )
    rails = (
        standing_box(depth, width, -SINK_M / 2.0, 0.06),
        standing_box(depth, width, height - 0.06, height),
    )
    return (
        Piece(
            "pane",
            (pane,),
            temperature,
            rgb,
            emissivity=0.85,
            uneven_k=0.5,
            gradient_k_per_m=0.8,
            covering=Covering.GLASS,
            shine=1.0,
            is_clear=True,
        ),
        Piece("frame", (*posts, *rails), temperature + 1.5, STEEL, emissivity=0.7),
    )


@thing_kind("dog", size_m=(0.75, 0.28, 0.6), temperature_c=28.5, rgb=(0.3, 0.18, 0.08), is_heated=True)
def dog(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a standing dog: as warm as a person, and half as tall as a child."""
    depth, width, height = size
    radius, back = 0.42 * width, 0.62 * height
    trunk = capsule(0.42 * depth, radius, (-0.04 * depth, 0.0, back), ALONG_X)
    legs = tuple(
        tube(back + SINK_M, 0.13 * width, (x * depth, y * width, 0.5 * (back - SINK_M)))
        for x in (-0.27, 0.19)
        for y in (-0.24, 0.24)
    )
    neck = ball(0.36 * width, (0.25 * depth, 0.0, 0.78 * height))
    head = ball(0.4 * width, (0.32 * depth, 0.0, height - 0.4 * width))
    muzzle = capsule(0.1 * depth, 0.17 * width, (0.43 * depth, 0.0, height - 0.48 * width), ALONG_X)
    tail = capsule(0.14 * depth, 0.08 * width, (-0.41 * depth, 0.0, 0.78 * height), ALONG_X)
    return (
        Piece("fur", (trunk, neck, tail), temperature, rgb, uneven_k=1.0),
        Piece("legs", legs, temperature - 1.5, rgb, uneven_k=0.8),
        Piece("head", (head, muzzle), temperature + 2.5, rgb, uneven_k=1.0),
    )


@thing_kind("bench", size_m=(0.55, 1.6, 0.85), temperature_c=21.0, rgb=WOOD, is_seat=True)
def bench(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a bench of boards with a back."""
    depth, width, height = size
    pitch = (depth - 0.06) / 3.0
    boards = tuple(
        standing_box(pitch - 0.02, width, 0.42, 0.46, x=-depth / 2.0 + 0.06 + (k + 0.5) * pitch)
        for k in range(3)
    )
    backs = tuple(
        standing_box(0.03, width - 0.01, low, low + 0.1, x=-depth / 2.0 + 0.015)
        for low in (0.55, height - 0.1)
    )
    legs = tuple(
        standing_box(depth - 0.07, 0.05, -SINK_M, 0.43, x=0.01, y=y * width) for y in (-0.4, 0.4)
    ) + tuple(
        standing_box(0.025, 0.05, -SINK_M, height - 0.02, x=-depth / 2.0 + 0.04, y=y * width)
        for y in (-0.38, 0.38)
    )
    return (
        Piece("boards", (*boards, *backs), temperature, rgb, uneven_k=0.6),
        Piece("legs", legs, temperature - 1.0, BLACK),
    )


@thing_kind("railing", size_m=(0.04, 2.0, 1.05), temperature_c=19.5, rgb=STEEL)
def railing(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a see-through barrier of two rails and upright bars."""
    depth, width, height = size
    radius = 0.5 * depth
    rails = tuple(tube(width, radius, (0.0, 0.0, at), ALONG_Y) for at in (0.15, height - radius))
    count = min(max(round(width / 0.16), 2), 12)
    bars = tuple(
        tube(height - 0.15, 0.45 * radius, (0.0, ((k + 0.5) / count - 0.5) * width, 0.5 * (height + 0.1)))
        for k in range(count)
    )
    posts = tuple(
        tube(
            height + SINK_M - radius,
            0.9 * radius,
            (0.0, y * (width - 2.2 * radius), 0.5 * (height - SINK_M - radius)),
        )
        for y in (-0.5, 0.5)
    )
    return (Piece("bars", (*rails, *bars, *posts), temperature, rgb, uneven_k=0.3),)
