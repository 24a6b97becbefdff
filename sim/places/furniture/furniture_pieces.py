"""Things of rooms: furniture, and warm clutter that trackers may confuse with people.

Source of the list of clutter: T fig. 4.1. Every builder takes depth, width, height [m] and the temperature
[degC] and colour of the main piece, and returns the pieces, the main one first.
"""

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
from peopleboy.sim.shapes.shapes import Vector

_MOST_RIBS = 14  # together with the panel they fit into one body of 16 shapes


@thing_kind(
    "radiator",
    size_m=(0.09, 1.2, 0.6),
    temperature_c=48.0,
    rgb=WHITE,
    base_m=0.12,
    is_hung=True,
    is_heated=True,
)
def radiator(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a ribbed panel on a wall: two straight warm sides, like those of a standing person."""
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
            "panel", (panel, *ribs), temperature, rgb, variation_k=1.5, gradient_k_per_m=14.0, uneven_k=1.0
        ),
    )


@thing_kind(
    "pipe",
    size_m=(0.06, 0.06, 2.7),
    temperature_c=44.0,
    rgb=WHITE,
    is_hung=True,
    is_to_ceiling=True,
    is_heated=True,
)
def pipe(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a heating pipe that runs up a wall."""
    depth, _, height = size
    shape = tube(height + 2.0 * SINK_M, depth / 2.0, (depth / 2.0 + 0.02, 0.0, height / 2.0))
    return (Piece("pipe", (shape,), temperature, rgb, variation_k=0.6),)


@thing_kind(
    "ceiling_lamp",
    size_m=(0.22, 1.25, 0.1),
    temperature_c=62.0,
    rgb=(1.0, 1.0, 0.95),
    is_from_ceiling=True,
    is_heated=True,
)
def ceiling_lamp(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a bright tube under its housing."""
    depth, width, height = size
    glass = tube(0.92 * width, 0.3 * height, (0.0, 0.0, 0.3 * height), ALONG_Y)
    housing = standing_box(depth, width, 0.55 * height, height + SINK_M)
    return (
        Piece("tube", (glass,), temperature, rgb, glow=1.0, is_solid=False),
        Piece("housing", (housing,), 30.0, WHITE, is_solid=False),
    )


@thing_kind("floor_lamp", size_m=(0.36, 0.36, 1.6), temperature_c=75.0, rgb=(1.0, 0.95, 0.8), is_heated=True)
def floor_lamp(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a hot bulb in a warm shade on a pole."""
    depth, _, height = size
    radius = depth / 2.0
    bulb = ball(0.05, (0.0, 0.0, height - 0.04))
    shade = tube(0.24, radius, (0.0, 0.0, height - 0.22))
    pole = tube(height - 0.3, 0.015, (0.0, 0.0, (height - 0.3) / 2.0))
    foot = tube(0.03 + SINK_M, 0.9 * radius, (0.0, 0.0, (0.03 - SINK_M) / 2.0))
    return (
        Piece("bulb", (bulb,), temperature, rgb, glow=1.0),
        Piece("shade", (shade,), 36.0, (0.8, 0.7, 0.5), glow=0.6, variation_k=1.0),
        Piece("pole", (pole, foot), 23.0, STEEL, emissivity=0.6),
    )


@thing_kind("monitor", size_m=(0.2, 0.55, 0.46), temperature_c=35.0, rgb=(0.35, 0.5, 0.75), is_heated=True)
def monitor(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a flat screen on a foot, with a warm front."""
    depth, width, height = size
    bottom = 0.28 * height
    middle = (bottom + height) / 2.0
    screen = box((0.01, width - 0.04, height - bottom - 0.04), (0.02, 0.0, middle))
    case = standing_box(0.04, width, bottom, height)
    stem = standing_box(0.03, 0.06, -SINK_M, bottom + 0.05, x=-0.01)
    foot = standing_box(depth, 0.45 * width, -SINK_M, 0.02)
    return (
        Piece("screen", (screen,), temperature, rgb, glow=0.7, variation_k=0.8, shine=1.0),
        Piece("case", (case,), temperature - 3.0, BLACK),
        Piece("foot", (stem, foot), 23.0, BLACK),
    )


@thing_kind("robot", size_m=(0.47, 0.38, 1.12), temperature_c=27.0, rgb=(0.5, 0.04, 0.05), is_heated=True)
def robot(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a robot like the PeopleBot: base, column with warm electronics, and a deck with a camera."""
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
        Piece("base", base, temperature, rgb),
        Piece("wheels", wheels, 22.0, BLACK, emissivity=0.95),
        Piece("column", (column,), temperature - 1.0, STEEL),
        Piece("electronics", (bay,), temperature + 2.5, BLACK, variation_k=0.8),
        Piece("deck", (deck,), temperature - 0.5, rgb),
        Piece("camera", (camera,), temperature + 1.5, BLACK),
    )


# Furniture at room temperature, pillars, and things on walls.

# Centre of each ball of leaves, sideways in radii and as a share of the height, and its share of the radius.
_LEAVES = ((0.0, 0.0, 1.0, 1.0), (0.7, 0.4, 0.6, 0.9), (-0.6, 0.6, 0.5, 0.8), (0.0, -0.8, 0.55, 0.9))


@thing_kind(
    "window", size_m=(0.05, 1.4, 1.2), temperature_c=16.0, rgb=(0.55, 0.65, 0.75), base_m=0.95, is_hung=True
)
def window(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a cold pane in a frame with a middle post, on a wall."""
    depth, width, height = size
    rail = 0.07
    pane = standing_box(
        depth / 2.0 + SINK_M, width - rail, 0.5 * rail, height - 0.5 * rail, x=(depth / 2.0 - SINK_M) / 2.0
    )
    side = (width - rail) / 2.0 - 0.002  # no faces of posts and rails are coplanar
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
    """Build a sheet on a wall."""
    depth, width, height = size
    sheet = standing_box(depth + SINK_M, width, 0.0, height, x=(depth - SINK_M) / 2.0)
    return (Piece("poster", (sheet,), temperature, rgb),)


@thing_kind("table", size_m=(0.75, 1.4, 0.74), temperature_c=21.5, rgb=WOOD)
def table(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a board on four legs."""
    depth, width, height = size
    top = standing_box(depth, width, height - 0.035, height)
    legs = corner_legs(0.05, height - 0.01, depth / 2.0 - 0.06, width / 2.0 - 0.06)
    return (Piece("top", (top,), temperature, rgb), Piece("legs", legs, temperature - 0.5, STEEL))


@thing_kind("chair", size_m=(0.45, 0.45, 0.9), temperature_c=21.8, rgb=(0.08, 0.1, 0.25), is_seat=True)
def chair(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a seat with a back on four legs."""
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
    """Build a plain block: a cabinet, a pillar, a box."""
    depth, width, height = size
    shape = standing_box(depth, width, -SINK_M, height)
    return (Piece("block", (shape,), temperature, rgb),)


@thing_kind(
    "round_pillar", size_m=(0.4, 0.4, 2.7), temperature_c=21.5, rgb=(0.6, 0.58, 0.54), is_to_ceiling=True
)
def column(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a round pillar as thick as it is deep."""
    depth, _, height = size
    shape = tube(height + SINK_M, depth / 2.0, (0.0, 0.0, (height - SINK_M) / 2.0))
    return (Piece("column", (shape,), temperature, rgb),)


@thing_kind("plant", size_m=(0.6, 0.6, 1.4), temperature_c=20.5, rgb=(0.05, 0.22, 0.06))
def plant(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build balls of leaves on a stem, in a pot."""
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
