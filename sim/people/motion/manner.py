"""The manner of one person: individual differences of gait and bearing."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES, lateral, point_along, turned_back

Array = NDArray[np.float64]
Hold = Literal[
    "free", "pocket", "strap", "telephone", "in_front", "carries", "phone_in_hand", "box", "handle"
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """Individual gait and bearing of one person; the defaults are those of the mean person.

    Attributes:
        stride: stride length relative to other people of the same stature and speed.
        arm_swing: arm swing relative to other people.
        arm_spread: distance of the arms from the trunk, relative to the motion capture clip.
        arms_off_rad, elbow_rad: additional angle of the arms off the trunk, and elbow flexion.
        stoop_rad: forward lean of the trunk.
        head_rad: (2,) angles by which the head is bowed, and turned to the left.
        looks_about_rad: amplitude of head turning from side to side.
        stance_width: foot distance while standing, relative to that of the hip joints.
        narrows: reduction of that distance while walking.
        stance_ahead: lead of the left foot over the right one while standing, as a fraction of stature.
        leans: shift of the weight to one leg while standing, -1..1, positive for the left.
        toe_out_rad: outward angle of the feet.
        sways: movement of the hips from side to side while walking, relative to the motion capture clip.
        bent_knees: reduction of the longest reach of a leg, in leg lengths.
        clearance: height to which the feet are lifted, relative to other people.
        runs: whether the person runs at speeds above 1.6 m/s.
        holds: what the left and the right hand hold when they are not needed otherwise.
    """

    stride: float = 1.0
    arm_swing: float = 1.0
    arm_spread: float = 0.35
    arms_off_rad: float = 0.0
    elbow_rad: float = 0.0
    stoop_rad: float = 0.0
    head_rad: tuple[float, float] = (0.0, 0.0)
    head_sweep_rad: float = 0.0
    stance_width: float = 1.0
    narrows: float = 0.45
    stance_ahead: float = 0.0
    leans: float = 0.0
    toe_out_rad: float = math.radians(7.0)
    sways: float = 1.0
    bent_knees: float = 0.0
    clearance: float = 1.0
    runs: bool = False
    holds: tuple[Hold, Hold] = ("free", "free")


USUAL: Final = Manner()


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """A normal distribution, clipped at two standard deviations, and at `least`."""

    mean: float
    deviation: float
    unit: str
    what: str
    least: float = -math.inf


# Women's steps are 0.66 m long at 1.31 m/s, 0.41 of their stature; feet walk 7 to 8 cm apart, and toes point
# 6 to 7 degrees out (Murray, Drought and Kory 1964, Walking patterns of normal men; Murray, Kory and Sepic
# 1970, Walking patterns of normal women). Deviations, and feet 2 cm wider, are our choice.
SPREADS: Final[Mapping[str, Spread]] = {
    "stride": Spread(
        mean=1.04, deviation=0.05, unit="", what="stride length, relative to the motion capture clip"
    ),
    "arm_swing": Spread(
        mean=1.0, deviation=0.3, unit="", what="arm swing, relative to the motion capture clip", least=0.2
    ),
    "arms_off": Spread(
        mean=6.0, deviation=4.0, unit="deg", what="angle between the arms and the trunk", least=0.0
    ),
    "elbow": Spread(mean=10.0, deviation=9.0, unit="deg", what="additional elbow flexion", least=0.0),
    "stoop": Spread(mean=3.0, deviation=3.5, unit="deg", what="stoop"),
    "bow": Spread(mean=5.0, deviation=8.0, unit="deg", what="head pitch"),
    "aside": Spread(mean=0.0, deviation=14.0, unit="deg", what="head yaw"),
    "looks_about": Spread(mean=0.0, deviation=14.0, unit="deg", what="amplitude of the turning of the head"),
    "stance": Spread(
        mean=1.45,
        deviation=0.4,
        unit="",
        what="distance between the feet while standing, relative to that between the hip joints",
        least=0.8,
    ),
    "step_width": Spread(
        mean=0.66,
        deviation=0.2,
        unit="",
        what="distance between the feet while walking, relative to that between the hip joints",
        least=0.25,
    ),
    "ahead": Spread(
        mean=0.0, deviation=0.025, unit="statures", what="forward offset of the left foot while standing"
    ),
    "toe_out": Spread(mean=8.0, deviation=5.0, unit="deg", what="toe-out angle", least=-2.0),
}
HOLDS: Final[Mapping[Hold, float]] = {
    "free": 0.68, "pocket": 0.13, "strap": 0.05, "telephone": 0.05, "in_front": 0.09,
}  # fmt: skip
_BOTH_ALIKE: Final = 0.5  # share of people who put both hands in the pockets or before the belly, not one
_ARM_SPREAD: Final = (0.35, 0.95)

# Directions of left elbows and palms from the shoulder in the chest's frame, as fractions of stature.
_ELBOW_AND_PALM: Final[dict[Hold, tuple[tuple[float, float, float], tuple[float, float, float]]]] = {
    "pocket": ((-0.09, 0.09, -0.14), (0.03, -0.01, -0.32)),
    "strap": ((0.0, 0.06, -0.175), (0.095, -0.05, -0.065)),
    "telephone": ((0.12, 0.09, -0.11), (0.03, -0.08, 0.09)),
    "in_front": ((-0.02, 0.06, -0.175), (0.165, -0.085, -0.205)),
    "carries": ((0.0, 0.035, -0.18), (0.02, 0.03, -0.37)),
    "phone_in_hand": ((0.02, 0.06, -0.18), (0.18, -0.09, -0.12)),
    "box": ((-0.02, 0.03, -0.185), (0.19, 0.0, -0.205)),
    "handle": ((-0.03, 0.06, -0.18), (0.20, 0.0, -0.21)),
}


def draw_manner(rng: np.random.Generator, carries: str | None, *, has_straps: bool) -> Manner:
    """Draw how a person walks and stands.

    Args:
        rng: random generator.
        carries: side of the hand that carries something, or None.
        has_straps: whether there is a shoulder strap for a hand to hold.
    """

    def near(name: str) -> float:
        spread = SPREADS[name]
        value = spread.mean + spread.deviation * float(np.clip(rng.normal(), -2.0, 2.0))
        return max(value, spread.least)

    leans = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.0, 1.0))
    stance = near("stance")
    return Manner(
        stride=near("stride"),
        arm_swing=near("arm_swing"),
        arm_spread=float(rng.uniform(*_ARM_SPREAD)),
        arms_off_rad=math.radians(near("arms_off")),
        elbow_rad=math.radians(near("elbow")),
        stoop_rad=math.radians(near("stoop")),
        head_rad=(math.radians(near("bow")), math.radians(near("aside"))),
        head_sweep_rad=abs(math.radians(near("looks_about"))),
        stance_width=stance,
        narrows=stance - near("step_width"),
        stance_ahead=near("ahead"),
        leans=leans,
        toe_out_rad=math.radians(near("toe_out")),
        holds=_draw_holds(rng, carries, has_straps=has_straps),
    )


def _draw_holds(rng: np.random.Generator, carries: str | None, *, has_straps: bool) -> tuple[Hold, Hold]:
    names, shares = list(HOLDS), list(HOLDS.values())
    left, right = (names[int(rng.choice(len(names), p=shares))] for _ in range(2))
    is_alike = float(rng.uniform()) < _BOTH_ALIKE
    if right in ("pocket", "in_front") and is_alike:
        left = right
    elif left == right == "telephone":
        left = "free"
    if not has_straps:
        left, right = ("free" if hold == "strap" else hold for hold in (left, right))
    return "carries" if carries == "left" else left, "carries" if carries == "right" else right


def held_arms(holds: tuple[Hold, Hold]) -> tuple[Array, NDArray[np.bool_]]:
    """Return (17, 3) [rad] rotation vectors of arms that hold something, and (17,) which bones those are."""
    rotations, is_held = np.zeros((len(BONES), 3)), np.zeros(len(BONES), np.bool_)
    for side, hold in zip(("left", "right"), holds, strict=True):
        if hold == "free":
            continue
        mirrored = np.array([1.0, lateral(side), 1.0])
        elbow, palm = (mirrored * point for point in _ELBOW_AND_PALM[hold])
        upper, fore, hand = (BONE_INDEX[f"{side}_{bone}"] for bone in ("upper_arm", "forearm", "hand"))
        rotations[upper] = point_along(tuple(elbow))
        rotations[fore] = point_along(turned_back(rotations[upper], palm - elbow))
        is_held[[upper, fore, hand]] = True
    return rotations, is_held


def bearing(manner: Manner) -> Array:
    """Return the (17, 3) [rad] additional rotations of a person's trunk, head and arms."""
    turns = np.zeros((len(BONES), 3))
    bow, aside = manner.head_rad
    turns[BONE_INDEX["abdomen"], 1] = turns[BONE_INDEX["chest"], 1] = 0.5 * manner.stoop_rad
    turns[BONE_INDEX["neck"]] = (0.0, 0.4 * bow - 0.3 * manner.stoop_rad, 0.4 * aside)
    turns[BONE_INDEX["head"]] = (0.0, 0.6 * bow - 0.3 * manner.stoop_rad, 0.6 * aside)
    for side in ("left", "right"):
        turns[BONE_INDEX[f"{side}_upper_arm"], 0] = lateral(side) * manner.arms_off_rad
        turns[BONE_INDEX[f"{side}_upper_arm"], 1] = 0.35 * manner.elbow_rad
        turns[BONE_INDEX[f"{side}_forearm"], :2] = (
            -0.7 * lateral(side) * manner.arms_off_rad,
            -manner.elbow_rad,
        )
    return turns
