"""What a person is made of: body, clothes, equipment and gait, as configured."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.appearance.finisher import Finisher
from peopleboy.sim.people.body.anthropometry import BodySize, measure
from peopleboy.sim.people.body.bodies import RestBody
from peopleboy.sim.people.body.body_placement import BodyFrame, arm_lengths
from peopleboy.sim.people.body.body_shapes import ARM_PARTS as _LIMBS
from peopleboy.sim.people.body.body_shapes import (
    BAG_PART,
    BODY_PARTS,
    PHONE_PART,
    SIDES,
    PartGeometry,
    bag,
    bone_index,
    build_body,
    phone,
    support_points,
)
from peopleboy.sim.people.body.clothes import dress
from peopleboy.sim.people.body.outfit import NOTHING_MORE, Outfit, put_on
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.body.skeleton import joint_offsets, joint_points
from peopleboy.sim.people.body.skin import BodyPlan, dress_body
from peopleboy.sim.people.equipment import EQUIPMENT_HOLDS, RIDDEN, EquipmentPart, find_grip, make_equipment
from peopleboy.sim.people.motion.gait import Gait, walking_gait
from peopleboy.sim.people.motion.gait_styles import GAIT_STYLES
from peopleboy.sim.people.motion.manner import USUAL, Hold, Manner, held_arms
from peopleboy.sim.people.motion.stance import POSTURES, Builds
from peopleboy.sim.people.person_config import Arms, PersonConfig
from peopleboy.sim.people.riding import riding_gait, riding_supports
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shapes import Part
from peopleboy.sim.shapes.skins import Skin

Array = NDArray[np.float64]

_CARRIED_PARTS = (BAG_PART, PHONE_PART)
ARM_PARTS = (*_LIMBS, *_CARRIED_PARTS)
PART_CLASSES = {name: i for i, name in enumerate((*BODY_PARTS, *_CARRIED_PARTS), start=1)}

_ARM_POSTURES: Final[Mapping[Arms, Posture]] = {
    "crossed": Posture.ARMS_CROSSED,
    "raised": Posture.ARMS_RAISED,
}
_ARM_HOLDS: Final[Mapping[Arms, tuple[Hold, Hold]]] = {
    "in_pockets": ("pocket", "pocket"),
    "telephone": ("telephone", "free"),
    "phone_in_hand": ("phone_in_hand", "free"),
}
_BOW_TO_PHONE_RAD = math.radians(24.0)
_BAG_LOOK = Material(temperature_c=23.5, variation_k=0.2, rgb=(0.05, 0.03, 0.02))
_BAG_HAND = "right"
_PHONE_LOOK = Material(temperature_c=31.0, variation_k=0.0, rgb=(0.02, 0.02, 0.03))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BodyModel:
    """A person without its movements.

    Attributes:
        config: the settings.
        parts: its parts and those of its equipment.
        part_keys: the names of the parts in the world, each with its owner: the person or the equipment.
        skin: the mesh that bends with the parts, or None for a person of capsules.
        frame: the geometry that connects bones and parts.
        joint_bone, joint_offset: as `skeleton.joint_points` returns them.
        arm_m: [m] as `body_placement.arm_lengths` returns them.
        gait: its gait.
        manner: its manner of moving.
        radius_m: [m] of the upright capsule that represents the person in contacts and sonar.
    """

    config: PersonConfig
    parts: tuple[Part, ...]
    part_keys: tuple[str, ...]
    skin: Skin | None
    frame: BodyFrame
    joint_bone: NDArray[np.int64]
    joint_offset: Array
    arm_m: tuple[float, float]
    gait: Gait
    manner: Manner
    radius_m: float

    def builds(self) -> Builds:
        """Return its constant properties, as the kernels of stances need them."""
        held, is_held = held_arms(self.manner.holds)
        (rotations, sway), arms = self.gait.tables, _ARM_POSTURES.get(self.config.arms)
        return Builds(
            rotations=rotations[None],
            sway=sway[None],
            root_scale=np.array([self.gait.root_scale]),
            height_m=np.array([self.config.height_m]),
            held=held[None],
            is_held=is_held[None],
            arms=np.array([-1 if arms is None else POSTURES[arms]], np.int64),
            has_bag=np.array([self.config.bag]),
            head_sweep_rad=np.array([self.manner.head_sweep_rad], np.float64),
        )


def make_body_model(
    config: PersonConfig,
    rng: np.random.Generator,
    finisher: Finisher | None,
    body: RestBody | None,
    air_c: float,
) -> BodyModel:
    """Make a person.

    Args:
        config: the settings.
        rng: random generator of clothes and equipment.
        finisher: adds detail to the appearance; None for plain people.
        body: of the skin; None for a person of capsules.
        air_c: [degC] temperature of the air, and so of equipment.
    """
    size = measure(config.height_m, config.sex, config.build)
    manner = _manner_of(config, USUAL if finisher is None else finisher.manner)
    plan = _plan(config, size, NOTHING_MORE if finisher is None else finisher.outfit, body)
    plan = replace(plan, geometry=plan.geometry | _carried(config, manner, size))
    materials = dress(config.clothes, rng) | {BAG_PART: _BAG_LOOK, PHONE_PART: _PHONE_LOOK}
    if finisher is not None:
        materials = finisher.finish(materials, plan.geometry, plan.head_m)
    gait, supports = _gait_of(config, plan, manner)
    things: tuple[EquipmentPart, ...] = ()
    if config.equipment != "nothing":
        grip = find_grip(manner, plan.offsets, supports, plan.arm_m, config.height_m)
        things = make_equipment(config.equipment, grip, air_c, rng)
    geometry = plan.geometry | {thing.name: thing.geometry for thing in things}
    return BodyModel(
        config=config,
        parts=(
            *(Part(name=n, shapes=g.shapes, material=materials[n]) for n, g in plan.geometry.items()),
            *(Part(name=t.name, shapes=t.geometry.shapes, material=t.material) for t in things),
        ),
        part_keys=(
            *(f"{config.name}/{name}" for name in plan.geometry),
            *(f"{config.name}.{config.equipment}/{thing.name}" for thing in things),
        ),
        skin=plan.skin,
        frame=BodyFrame(
            plan.offsets, supports, bone_index(geometry), np.array([g.offset_m for g in geometry.values()])
        ),
        joint_bone=plan.joint_bone,
        joint_offset=plan.joint_offset,
        arm_m=plan.arm_m,
        gait=gait,
        manner=manner,
        radius_m=(size.girths.bideltoid_breadth + size.girths.chest_depth) / 4.0 * size.stature_m,
    )


def _plan(config: PersonConfig, size: BodySize, outfit: Outfit, body: RestBody | None) -> BodyPlan:
    """Return the plan of a person of capsules, or of one with a skin on a body."""
    if body is not None:
        return dress_body(body, size, config.clothes, outfit)
    thickness_m = config.clothes.thickness_m()
    parts = build_body(size, config.clothes.hair, thickness_m)
    joint_bone, joint_offset = joint_points(size)
    return BodyPlan(
        skin=None,
        geometry=put_on(parts, size, outfit, thickness_m),
        offsets=joint_offsets(size),
        supports=support_points(size),
        joint_bone=joint_bone,
        joint_offset=joint_offset,
        arm_m=arm_lengths(size.stature_m),
        head_m=size.stature_m,
    )


def _carried(config: PersonConfig, manner: Manner, size: BodySize) -> dict[str, PartGeometry]:
    """Return the configured bag, and the telephone of a person who holds one."""
    carried = {BAG_PART: bag(_BAG_HAND, size.stature_m)} if config.bag else {}
    for side, hold in zip(SIDES, manner.holds, strict=True):
        if hold in ("telephone", "phone_in_hand"):
            return carried | {PHONE_PART: phone(side, size.stature_m)}
    return carried


def _manner_of(config: PersonConfig, own: Manner) -> Manner:
    """Change a person's own manner by the configured gait, arms and equipment."""
    manner = GAIT_STYLES[config.gait].applied_to(own)
    if config.equipment != "nothing":
        hold: Hold = EQUIPMENT_HOLDS.get(config.equipment, "free")
        return replace(manner, holds=(hold, hold))
    if config.arms in _ARM_HOLDS:
        left, right = (
            kept if kept == "carries" else new
            for kept, new in zip(own.holds, _ARM_HOLDS[config.arms], strict=True)
        )
        manner = replace(manner, holds=(left, right))
    if config.arms == "phone_in_hand":
        bow, _ = manner.head_rad
        manner = replace(manner, head_rad=(bow + _BOW_TO_PHONE_RAD, 0.0))
    return manner


def _gait_of(config: PersonConfig, plan: BodyPlan, manner: Manner) -> tuple[Gait, Array]:
    """Return the gait, and the points that the body rests on."""
    if config.equipment not in RIDDEN:
        return walking_gait(plan.offsets, plan.supports[:3], config.height_m, manner), plan.supports
    ankle_m = -float(plan.supports[0, 2])
    gait = riding_gait(config.equipment, plan.offsets, plan.arm_m, ankle_m, config.height_m)
    return gait, riding_supports(config.equipment, config.height_m)
