"""Things of streets and garages.

Builders as in `furniture_pieces`: size [m], temperature [degC] and colour of the main piece, which is first.
"""

import math

from peopleboy.sim.places.furniture.appliances import capsule
from peopleboy.sim.places.pieces import (
    ALONG_Y,
    BLACK,
    SINK_M,
    STEEL,
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
from peopleboy.sim.shapes.shapes import Quaternion, Shape, Vector

# Direction in which each ball of a crown touches the outline, and its radius as a share of the crown's.
_CROWN = (
    (0.0, 0.0, 1.0, 0.5),
    (1.0, 0.0, 0.0, 0.5),
    (-1.0, 0.0, 0.0, 0.46),
    (0.0, 1.0, 0.0, 0.5),
    (0.0, -1.0, 0.0, 0.46),
    (0.0, 0.0, -0.5, 0.6),
    (0.6, 0.6, 0.5, 0.4),
    (-0.6, 0.5, 0.6, 0.38),
    (0.5, -0.6, 0.6, 0.42),
    (-0.6, -0.6, 0.5, 0.36),
    (0.7, 0.5, -0.5, 0.36),
    (-0.6, 0.6, -0.5, 0.4),
    (0.6, -0.7, -0.4, 0.32),
    (-0.7, -0.5, -0.5, 0.34),
    (0.9, -0.2, 0.4, 0.28),
    (-0.3, 0.9, 0.4, 0.26),
)


@thing_kind("car", size_m=(4.2, 1.75, 1.45), temperature_c=36.0, rgb=(0.08, 0.12, 0.3), is_heated=True)
def car(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a car that has been driven: warm bonnet, grille, tyres and exhaust, cool panes and roof."""
    depth, width, height = size
    low, waist = 0.17 * height, 0.6 * height
    lower = standing_box(0.985 * depth, width, low, waist)
    pillars = tuple(
        standing_box(0.05, 0.84 * width, waist - 0.02, height - 0.05, x=x * depth)
        for x in (-0.32, -0.06, 0.17)
    )
    bonnet = standing_box(0.27 * depth, 0.9 * width, waist - 0.03, waist + 0.05, x=0.33 * depth)
    grille = standing_box(0.03, 0.6 * width, 1.5 * low, 0.8 * waist, x=0.5 * depth - 0.012)
    glass = standing_box(0.5 * depth, 0.8 * width, waist - 0.03, height - 0.08, x=-0.08 * depth)
    roof = standing_box(0.47 * depth, 0.82 * width, height - 0.1, height, x=-0.09 * depth)
    tyre = 0.215 * height
    wheels = tuple(
        tube(0.2, tyre, (x * depth, y * (width / 2.0 - 0.09), tyre - SINK_M), ALONG_Y)
        for x in (-0.29, 0.31)
        for y in (-1.0, 1.0)
    )
    hubs = tuple(
        tube(0.215, 0.5 * tyre, (x * depth, y * (width / 2.0 - 0.09), tyre - SINK_M), ALONG_Y)
        for x in (-0.29, 0.31)
        for y in (-1.0, 1.0)
    )
    lamps = tuple(
        standing_box(0.025, 0.2 * width, 0.7 * waist, 0.92 * waist, x=0.5 * depth - 0.014, y=y * 0.36 * width)
        for y in (-1.0, 1.0)
    )
    exhaust = tube(
        0.12,
        0.035,
        (-0.5 * depth + 0.04, 0.3 * width, 1.05 * low),
        (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)),
    )
    body_c = 20.5
    return (
        Piece("bonnet", (bonnet,), temperature, rgb, uneven_k=2.5),
        Piece("body", (lower, *pillars), body_c, rgb, emissivity=0.88, gradient_k_per_m=-3.0, uneven_k=0.9),
        Piece("grille", (grille,), temperature + 4.0, BLACK, uneven_k=2.5),
        Piece("glass", (glass,), body_c - 3.0, (0.06, 0.07, 0.09), emissivity=0.85, uneven_k=0.8),
        Piece("roof", (roof,), body_c - 4.0, rgb, uneven_k=0.5),
        Piece("tyres", wheels, 27.0, BLACK, uneven_k=1.0),
        Piece("hubs", hubs, 33.0, STEEL, emissivity=0.8, is_solid=False),
        Piece("lamps", lamps, 25.0, (0.8, 0.8, 0.75), glow=0.2),
        Piece("exhaust", (exhaust,), temperature + 18.0, STEEL, is_solid=False),
    )


@thing_kind("bicycle", size_m=(1.75, 0.55, 1.05), temperature_c=20.0, rgb=(0.05, 0.25, 0.12))
def bicycle(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a bicycle on its stand: two rings and a frame, cooler than the air under a clear sky."""
    depth, width, height = size
    radius = 0.19 * depth
    hubs = (-0.5 * depth + radius, 0.5 * depth - radius)
    wheels = tuple(_chord(x, radius, k) for x in hubs for k in range(8))
    seat, bar, crank = (-0.13 * depth, 0.85 * height), (0.24 * depth, height - 0.03), (-0.05 * depth, radius)
    frame = (
        _strut((hubs[0], radius), crank),
        _strut((hubs[0], radius), seat),
        _strut(crank, seat),
        _strut(crank, (bar[0], 0.75 * height)),
        _strut(seat, (bar[0], 0.75 * height)),
        _strut((hubs[1], radius), bar),
        tube(width, 0.018, (bar[0], 0.0, bar[1]), ALONG_Y),
        box((0.24, 0.14, 0.06), (seat[0], 0.0, seat[1])),
    )
    return (
        Piece("frame", frame, temperature, rgb, uneven_k=0.4),
        Piece("tyres", wheels, temperature - 0.5, BLACK, uneven_k=0.3),
    )


def _chord(x: float, radius: float, index: int) -> Shape:
    """Build one of eight pieces of a tyre that touches the floor."""
    first, second = (math.tau * (k + 0.5) / 8.0 for k in (index, index + 1))
    inner = (radius - 0.02) / math.cos(math.pi / 8.0)
    ends = [(x + inner * math.cos(a), radius - SINK_M / 2.0 + inner * math.sin(a)) for a in (first, second)]
    return _strut(ends[0], ends[1], 0.02)


def _strut(start: tuple[float, float], end: tuple[float, float], radius: float = 0.02) -> Shape:
    """Build a rod between two points (x, z) in the plane of the wheels."""
    across, up = end[0] - start[0], end[1] - start[1]
    half = 0.5 * math.atan2(across, up)
    turn: Quaternion = (0.0, math.sin(half), 0.0, math.cos(half))
    middle = (0.5 * (start[0] + end[0]), 0.0, 0.5 * (start[1] + end[1]))
    return capsule(math.hypot(across, up), radius, middle, turn)


@thing_kind("tree", size_m=(3.2, 3.2, 5.5), temperature_c=21.0, rgb=(0.06, 0.2, 0.05))
def tree(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a tree: a trunk and a crown of leaves, as warm as the air."""
    _, width, height = size
    radius = width / 2.0
    middle = height - 0.925 * radius
    crown = tuple(
        ball(share * radius, _beside(middle, x, y, z, radius * (1.0 - share))) for x, y, z, share in _CROWN
    )
    trunk = tube(middle + SINK_M, 0.045 * width, (0.0, 0.0, 0.5 * (middle - SINK_M)))
    bough = capsule(
        0.5 * radius, 0.03 * width, (0.2 * radius, 0.0, middle - 0.8 * radius), (0.0, 0.25, 0.0, 0.968)
    )
    return (
        Piece("crown", crown, temperature, rgb, covering=Covering.LEAVES, is_solid=False),
        Piece("trunk", (trunk, bough), temperature + 0.8, (0.2, 0.14, 0.09), uneven_k=0.8),
    )


def _beside(height: float, x: float, y: float, z: float, away_m: float) -> Vector:
    """Return a point at a distance from the centre of a slightly flattened crown, in a direction."""
    return (away_m * x, away_m * y, height + 0.85 * away_m * z)


@thing_kind(
    "street_lamp", size_m=(0.45, 0.45, 4.2), temperature_c=33.0, rgb=(0.08, 0.1, 0.09), is_heated=True
)
def street_lamp(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a lamp on a pole with a wide foot."""
    depth, _, height = size
    foot = tube(0.8 + SINK_M, 0.42 * depth, (0.0, 0.0, 0.5 * (0.8 - SINK_M)))
    base = tube(0.12 + SINK_M, 0.5 * depth, (0.0, 0.0, 0.5 * (0.12 - SINK_M)))
    pole = tube(height - 0.6, 0.22 * depth, (0.0, 0.0, 0.5 * (height - 0.6)))
    head = tube(0.5, 0.42 * depth, (0.0, 0.0, height - 0.35))
    cap = tube(0.1, 0.5 * depth, (0.0, 0.0, height - 0.05))
    return (
        Piece("head", (head,), temperature, (0.9, 0.85, 0.7), glow=0.9, is_solid=False),
        Piece("pole", (pole, foot, base, cap), 20.0, rgb, gradient_k_per_m=-0.6, uneven_k=0.6),
    )


@thing_kind("market_stall", size_m=(1.6, 2.6, 2.5), temperature_c=62.0, rgb=(0.55, 0.1, 0.08), is_heated=True)
def market_stall(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a stall under an awning, with a hot plate, goods and a counter."""
    depth, width, height = size
    plate = standing_box(0.35 * depth, 0.3 * width, 0.93, 1.0, x=0.05 * depth, y=0.25 * width)
    table = standing_box(0.6 * depth, 0.92 * width, -SINK_M, 0.94, x=0.03 * depth)
    goods = tuple(
        standing_box(
            0.4 * depth, 0.11 * width, 0.93, 1.02 + 0.05 * (k % 3), x=0.05 * depth, y=(k - 3.2) * 0.13 * width
        )
        for k in range(4)
    )
    posts = corner_legs(0.05, height - 0.1, depth / 2.0 - 0.06, width / 2.0 - 0.04)
    awning = standing_box(depth, width, height - 0.14, height)
    return (
        Piece("plate", (plate,), temperature, STEEL, uneven_k=5.0),
        Piece("table", (table,), 21.5, WOOD, uneven_k=0.8, gradient_k_per_m=1.5),
        Piece("goods", goods, 19.0, (0.5, 0.25, 0.1), uneven_k=1.2),
        Piece("posts", posts, 20.0, STEEL),
        Piece("awning", (awning,), 18.0, rgb, uneven_k=0.9, is_solid=False),
    )


@thing_kind("bin", size_m=(0.5, 0.5, 0.95), temperature_c=20.5, rgb=BLACK)
def bin_(size: Vector, temperature: float, rgb: Rgb) -> tuple[Piece, ...]:
    """Build a litter bin with a lid."""
    depth, _, height = size
    drum = tube(height - 0.1 + SINK_M, 0.46 * depth, (0.0, 0.0, 0.5 * (height - 0.1 - SINK_M)))
    lid = tube(0.14, 0.5 * depth, (0.0, 0.0, height - 0.07))
    return (Piece("drum", (drum, lid), temperature, rgb, gradient_k_per_m=1.0, uneven_k=0.5),)
