"""Things that people carry, push or ride: how they are held, their shapes and their materials."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_placement import put_on_floor
from peopleboy.sim.people.body.body_shapes import FLOOR, FRAME_INDEX, PartGeometry, box, capsule
from peopleboy.sim.people.body.postures import standing_rotations
from peopleboy.sim.people.body.skeleton import BONE_INDEX
from peopleboy.sim.people.motion.manner import Hold, Manner, bearing, held_arms
from peopleboy.sim.shapes.materials import COLOURS, Material, Rgb
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind, Vector

Array = NDArray[np.float64]

Equipment = Literal["nothing", "box", "walking_frame", "trolley", "pushchair", "wheelchair", "bicycle"]
RIDDEN: Final[tuple[Equipment, ...]] = ("wheelchair", "bicycle")


@dataclass(frozen=True, slots=True, kw_only=True)
class EquipmentPart:
    """A part of a thing: its shapes on a bone or on the floor frame of its person, and its material."""

    name: str
    geometry: PartGeometry
    material: Material


_PAINTS: Final = ("black", "red", "blue", "green", "light_grey", "white", "navy")
_METAL: Final[Rgb] = (0.35, 0.35, 0.36)
_RUBBER: Final[Rgb] = (0.02, 0.02, 0.02)
_WHEEL_SIDES: Final = 24
_SIDEWAYS: Final[Quaternion] = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # turns z to -y

Shapes = Mapping[str, tuple[Sequence[Shape], Rgb]]


class Grip(NamedTuple):
    """The left palm of a person of a stature who holds a thing before the body.

    Attributes:
        stature_m: [m].
        in_chest: x, y, z [m] in the frame of the chest.
        on_floor: x, y, z [m] in the person's frame on the floor.
    """

    stature_m: float
    in_chest: Vector
    on_floor: Vector


EQUIPMENT_HOLDS: Final[Mapping[Equipment, Hold]] = {
    "box": "box",
    "walking_frame": "handle",
    "trolley": "handle",
    "pushchair": "handle",
}
"""What both hands do; those of riders are part of their poses."""


def find_grip(
    manner: Manner, offsets: Array, supports: Array, arm_m: tuple[float, float], stature_m: float
) -> Grip:
    """Return where the left palm of a standing person is.

    Args:
        manner: of the person, with what the hands hold.
        offsets: (17, 3) [m] as returned by `joint_offsets`.
        supports: (12, 3) [m] as returned by `support_points`.
        arm_m: [m] as returned by `arm_lengths`.
        stature_m: [m].
    """
    held, is_held = held_arms(manner.holds)
    turns = standing_rotations() + bearing(manner)
    turns[is_held] = held[is_held]
    bones = np.empty((len(FRAME_INDEX), 4, 4))
    put_on_floor(turns, offsets, supports, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), bones)
    forearm, chest = bones[BONE_INDEX["left_forearm"]], bones[BONE_INDEX["chest"]]
    palm = forearm[:3, 3] - arm_m[1] * forearm[:3, 2]
    in_chest = chest[:3, :3].T @ (palm - chest[:3, 3])
    return Grip(stature_m, tuple(in_chest.tolist()), tuple(palm.tolist()))


def make_equipment(
    kind: Equipment, grip: Grip, air_c: float, rng: np.random.Generator
) -> tuple[EquipmentPart, ...]:
    """Make the parts of a thing to fit a person.

    A thing has the temperature of the air [degC]. Its colour is random.
    """
    paint = COLOURS[str(rng.choice(_PAINTS))]
    bone = "chest" if kind == "box" else FLOOR
    return tuple(
        EquipmentPart(
            name=name,
            geometry=PartGeometry(bone=bone, shapes=tuple(shapes)),
            material=Material(temperature_c=air_c, emissivity=0.92, variation_k=0.2, rgb=rgb),
        )
        for name, (shapes, rgb) in _MAKERS[kind](grip, paint).items()
    )


def _box(grip: Grip, paint: Rgb) -> Shapes:
    """Make a carton between the palms, in the chest's frame."""
    del paint
    h, (x, y, z) = grip.stature_m, grip.in_chest
    return {"carton": ([box((x, 0.0, z + 0.03), (0.17 * h, 2.0 * y, 0.16 * h))], (0.38, 0.25, 0.13))}


def _walking_frame(grip: Grip, paint: Rgb) -> Shapes:
    """Make a frame on four small wheels, with a seat between the handles."""
    x, half, z = grip.on_floor
    frame = []
    for y in (half, -half):
        frame += [
            capsule((x - 0.06, y, z), (x + 0.10, y, z), 0.016),
            capsule((x + 0.06, y, z), (x + 0.16, y, 0.12), 0.014),
            capsule((x + 0.10, y, 0.55 * z), (x - 0.20, y, 0.12), 0.014),
        ]
    bars = [capsule((x + 0.12, half, 0.45 * z), (x + 0.12, -half, 0.45 * z), 0.013)]
    seat = [box((x + 0.05, 0.0, 0.62 * z), (0.22, 2.0 * half, 0.03))]
    wheels = [_disc((x + dx, y, 0.1), 0.1, 0.03) for dx in (-0.2, 0.16) for y in (half, -half)]
    return {"frame": (frame + bars, paint), "seat": (seat, _RUBBER), "wheels": (wheels, _RUBBER)}


def _trolley(grip: Grip, paint: Rgb) -> Shapes:
    """Make a shopping trolley: a basket of five sides on a frame."""
    x, half, z = grip.on_floor
    rear, front, low, top = x + 0.06, x + 0.86, 0.50, 0.92
    middle, length = (rear + front) / 2.0, front - rear
    wall, height = 0.012, top - low
    basket = [box((middle, y, (low + top) / 2.0), (length, wall, height)) for y in (half - 0.02, 0.02 - half)]
    basket += [box((end, 0.0, (low + top) / 2.0), (wall, 2.0 * half - 0.04, height)) for end in (rear, front)]
    basket += [box((middle, 0.0, low), (length, 2.0 * half - 0.04, wall))]
    frame = [capsule((x, half, z), (x, -half, z), 0.018)]
    for y in (half - 0.02, 0.02 - half):
        frame += [
            capsule((x, y, z), (rear, y, low), 0.014),
            capsule((rear, y, low), (rear, y, 0.14), 0.014),
            capsule((rear, y, 0.14), (front - 0.05, y, 0.14), 0.014),
        ]
    wheels = [
        _disc((dx, y, 0.06), 0.06, 0.03) for dx in (rear, front - 0.05) for y in (half - 0.02, 0.02 - half)
    ]
    return {"basket": (basket, _METAL), "frame": (frame, paint), "wheels": (wheels, _RUBBER)}


def _pushchair(grip: Grip, paint: Rgb) -> Shapes:
    """Make a pushchair with a hood; the child in it is not visible."""
    x, half, z = grip.on_floor
    frame = [capsule((x, half, z), (x, -half, z), 0.016)]
    for y in (half, -half):
        frame += [
            capsule((x, y, z), (x + 0.62, y, 0.16), 0.013),
            capsule((x + 0.30, y, 0.56), (x + 0.12, y, 0.14), 0.013),
        ]
    seat = [
        box((x + 0.48, 0.0, 0.42), (0.34, 2.0 * half - 0.05, 0.12)),
        box((x + 0.24, 0.0, 0.62), (0.10, 2.0 * half - 0.05, 0.50)),
        box((x + 0.37, 0.0, 0.89), (0.32, 2.0 * half - 0.04, 0.05)),
        box((x + 0.66, 0.0, 0.26), (0.12, 2.0 * half - 0.08, 0.06)),
    ]
    wheels = [_disc((x + dx, y, 0.11), 0.11, 0.04) for dx in (0.12, 0.62) for y in (half, -half)]
    return {"seat": (seat, paint), "frame": (frame, _METAL), "wheels": (wheels, _RUBBER)}


SEAT_M: Final = 0.48
"""[m] height of a wheelchair's seat."""


def _wheelchair(grip: Grip, paint: Rgb) -> Shapes:
    """Make a wheelchair; the hips of its person are above the person's position."""
    h = grip.stature_m
    back = -0.075 * h - 0.02
    seat = [
        box((back + 0.22, 0.0, SEAT_M - 0.02), (0.44, 0.42, 0.04)),
        box((back - 0.015, 0.0, SEAT_M + 0.22), (0.03, 0.42, 0.44)),
    ]
    front = 0.245 * h + 0.16
    frame = []
    for y in (0.22, -0.22):
        frame += [
            capsule((back, y, SEAT_M + 0.24), (back + 0.36, y, SEAT_M + 0.24), 0.018),
            capsule((back, y, SEAT_M + 0.46), (back - 0.14, y, SEAT_M + 0.46), 0.014),
            capsule((back, y, SEAT_M + 0.46), (back, y, 0.25), 0.013),
            capsule((back + 0.42, y, SEAT_M - 0.04), (front - 0.06, 0.6 * y, 0.13), 0.013),
            capsule((back, y, 0.25), (back + 0.42, y, 0.25), 0.013),
            capsule((back + 0.42, y, SEAT_M - 0.04), (back + 0.42, y, 0.17), 0.013),
        ]
    rest = [box((front, 0.6 * y, 0.11), (0.16, 0.14, 0.015)) for y in (0.22, -0.22)]
    large = [shape for y in (0.28, -0.28) for shape in _ring((back + 0.06, y, 0.30), 0.287, 0.013)]
    small = [_disc((back + 0.42, y, 0.085), 0.085, 0.03) for y in (0.22, -0.22)]
    return {"seat": (seat, _RUBBER), "frame": ([*frame, *rest], paint), "wheels": (large + small, _RUBBER)}


@dataclass(frozen=True, slots=True)
class BicycleSize:
    """Sizes [m] of a bicycle for a person of a stature; x is ahead of the hips' joints.

    Attributes:
        hips_z: height of the hips' joints of its rider.
        crank: x, z of the bottom bracket.
        arm: length of the cranks.
        wheel: outer radius of the wheels.
        bar: x, z of the handlebar's grips.
        axles: x of the rear and the front axle.
    """

    hips_z: float
    crank: tuple[float, float]
    arm: float
    wheel: float
    bar: tuple[float, float]
    axles: tuple[float, float]


def bicycle_size(h: float) -> BicycleSize:
    """Return the sizes of a bicycle: the leg is nearly straight on the lower pedal."""
    k = h / 1.75
    hips, crank = 1.01 * k, (0.21 * k, 0.28 * k)
    return BicycleSize(
        hips_z=hips, crank=crank, arm=0.165 * k, wheel=0.335 * k, bar=(0.60 * k, 1.06 * k),
        axles=(-0.23 * k, 0.83 * k),
    )  # fmt: skip


def _bicycle(grip: Grip, paint: Rgb) -> Shapes:
    """Make a bicycle; the hips of its rider are above the person's position."""
    size, k = bicycle_size(grip.stature_m), grip.stature_m / 1.75
    rear, front = size.axles
    crank, wheel = (size.crank[0], 0.0, size.crank[1]), size.wheel
    saddle = (-0.03 * k, 0.0, size.hips_z - 0.10 * k)
    head_low, head_top = (0.66 * k, 0.0, 0.68 * k), (0.62 * k, 0.0, 0.86 * k)
    bar_x, bar_z = size.bar
    tubes = [
        capsule(crank, saddle, 0.016), capsule(crank, head_low, 0.02), capsule(head_low, head_top, 0.02),
        capsule((0.03 * k, 0.0, 0.75 * k), head_top, 0.016),
        capsule(head_top, (bar_x, 0.0, bar_z), 0.014),
        capsule((bar_x, 0.26, bar_z), (bar_x, -0.26, bar_z), 0.014),
    ]  # fmt: skip
    for y in (0.05, -0.05):
        tubes += [
            capsule(head_low, (front, y, wheel), 0.013),
            capsule(crank, (rear, y, wheel), 0.011),
            capsule((0.02 * k, 0.0, 0.72 * k), (rear, y, wheel), 0.011),
        ]
    wheels = [shape for x in (rear, front) for shape in _ring((x, 0.0, wheel), wheel - 0.018, 0.018)]
    seat = [capsule((-0.12 * k, 0.0, saddle[2]), (0.10 * k, 0.0, saddle[2]), 0.045)]
    return {"frame": (tubes, paint), "wheels": (wheels, _RUBBER), "saddle": (seat, _RUBBER)}


def _disc(centre: Vector, radius: float, width: float) -> Shape:
    """Make a small wheel with its axle along y."""
    return Shape(kind=ShapeKind.CYLINDER, size=(width, radius, 0.0), position=centre, orientation=_SIDEWAYS)


def _ring(centre: Vector, radius: float, tyre: float) -> list[Shape]:
    """Make a large wheel with its axle along y: its tyre; spokes are too thin to be visible."""
    angles = np.linspace(0.0, math.tau, _WHEEL_SIDES + 1)
    x, y, z = centre
    points: list[Vector] = [
        (x + radius * math.cos(angle), y, z + radius * math.sin(angle)) for angle in angles.tolist()
    ]
    return [capsule(a, b, tyre) for a, b in pairwise(points)]


_MAKERS: Final[Mapping[Equipment, Callable[[Grip, Rgb], Shapes]]] = {
    "box": _box,
    "walking_frame": _walking_frame,
    "trolley": _trolley,
    "pushchair": _pushchair,
    "wheelchair": _wheelchair,
    "bicycle": _bicycle,
}
