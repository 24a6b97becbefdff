"""The appearance of a person in full detail: temperatures that follow the air, folds, a face, hair, a bag."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.clothing import OPEN, Worn, add_trimmings, paint_cloth, paint_shoes
from peopleboy.sim.people.appearance.faces import paint_face, paint_hair, paint_skin
from peopleboy.sim.people.appearance.textures import Mesh, crumple, make_mesh
from peopleboy.sim.people.appearance.traits import draw_traits
from peopleboy.sim.people.body.body_shapes import BAG_PART, PHONE_PART, PartGeometry
from peopleboy.sim.people.body.clothes import ROOM_C, Garment
from peopleboy.sim.people.body.outfit import Outfit, draw_outfit
from peopleboy.sim.people.motion.manner import Manner, draw_manner
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.shapes.materials import COLOURS, Finish, Material, Rgb
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

# Temperatures of skin and clothes in air of any temperature.
#
# A garment's surface lies between air and skin: T = air + (skin - air) * r. The heat that flows through the
# cloth leaves from its surface, so r = 1 / (1 + h R) with h [W / (m2 K)] of the surface and R [m2 K / W]
# of the cloth (ISO 7730:2005, clause 4.1, solved for the surface). The catalogue gives T in air of 21
# degC, which gives each garment's r; in air of 21 degC all temperatures are those of the catalogue.

WARMEST_SKIN_C = 36.8
_COVERED_SKIN_C = 33.4  # skin under clothes, in air of 21 degC
_BY_RADIATION, _IN_A_ROOM = 4.5, 8.5  # [W / (m2 K)] h by radiation, and in all; the rest is convection
_LEAST, _MOST = 0.2, 0.95  # limits of r: a warm shoe, a stocking

# [K] skin temperature in air of _AIR_C less that in air of 21 degC: after an hour in still air of 50 %
# humidity, standing, at twice the basal metabolism, in clothes of 0.7 clo, of 1.2 clo at 15 degC, up to
# 2.2 clo at -5 degC. Run with JOS-3 0.5 (Takahashi et al. 2021, Energy and Buildings 231, 110575), one man.
_AIR_C = (-5.0, 5.0, 10.0, 15.0, 21.0, 25.0, 30.0, 35.0, 40.0)
_SKIN_K = {
    "head": (-4.9, -3.6, -2.7, -1.6, 0.0, 1.3, 2.2, 2.7, 3.3),
    "neck": (-6.7, -4.2, -2.9, -1.6, 0.0, 1.0, 1.9, 2.5, 3.0),
    "hand": (-15.9, -7.2, -4.3, -2.0, 0.0, 0.9, 1.6, 2.0, 2.5),
    "arm": (-7.1, -5.5, -3.7, -1.9, 0.0, 0.9, 1.5, 2.0, 2.6),
    "leg": (-3.6, -2.8, -2.3, -1.4, 0.0, 0.8, 1.3, 1.5, 2.4),
    "foot": (-4.4, -3.8, -3.4, -1.6, 0.0, 0.6, 0.9, 1.0, 1.6),
    "trunk": (-2.7, -2.1, -1.7, -1.1, 0.0, 0.3, 0.4, 1.4, 2.7),
}
_REGION = {
    "head": "head", "hair": "head", "neck": "neck", "hand": "hand", "forearm": "arm", "upper_arm": "arm",
    "foot": "foot", "shin": "leg", "thigh": "leg",
}  # fmt: skip


def skin_change_k(part: str, air_c: float) -> float:
    """Return the skin temperature of a part in air of `air_c`, less that in air of 21 degC [K]."""
    bare = part.removeprefix("left_").removeprefix("right_")
    return float(np.interp(air_c, _AIR_C, _SKIN_K[_REGION.get(bare, "trunk")]))


def bare_c(at_room_c: float, part: str, air_c: float) -> float:
    """Return the temperature [degC] of bare skin, given its temperature in air of 21 degC."""
    return min(at_room_c + skin_change_k(part, air_c), max(WARMEST_SKIN_C, at_room_c))


def share_of_skin(at_room_c: float) -> float:
    """Return r of a garment, given its temperature [degC] in air of 21 degC."""
    return min(max((at_room_c - ROOM_C) / (_COVERED_SKIN_C - ROOM_C), _LEAST), _MOST)


def under_cloth_c(part: str, air_c: float) -> float:
    """Return the temperature [degC] of skin under clothes."""
    return bare_c(_COVERED_SKIN_C, part, air_c)


def wind_loss(moving_m_s: float) -> float:
    """Return the heat loss of a surface in moving air [m/s], relative to the loss in a room.

    Source: ISO 7730:2005, clause 4.1: 12.1 W / (m2 K) by convection at 1 m/s, proportional to the root of
    speed; 4.5 W / (m2 K) by radiation.
    """
    return max((12.1 * float(np.sqrt(moving_m_s)) + _BY_RADIATION) / _IN_A_ROOM, 1.0)


def cloth_c(at_room_c: float, part: str, air_c: float, loss: float = 1.0) -> float:
    """Return the temperature [degC] of a garment's surface, given that in still air of 21 degC.

    Args:
        at_room_c: [degC] temperature of the surface in still air of 21 degC.
        part: the part that it covers.
        air_c: [degC] temperature of the air.
        loss: heat loss of the surface relative to that in a room: r = 1 / (1 + loss h R).
    """
    r = share_of_skin(at_room_c)
    return air_c + (under_cloth_c(part, air_c) - air_c) * r / (r + loss * (1.0 - r))


_CLOTH_TEXEL_M, _SKIN_TEXEL_M, _FACE_TEXEL_M, _HAIR_TEXEL_M = 0.007, 0.010, 0.003, 0.006
# Garments of one kind fit tightly or loosely: standard deviation of T - air, as a share of its mean.
_FIT = 0.2
_BAG_COLOURS = ("black", "dark_brown", "grey", "navy", "khaki", "red")
_WIND_M_S = (0.3, 2.5)  # wind speed on a street, from sheltered to open
_SHIRT_C, _SHIRT_RGB = 30.2, COLOURS["white"]
_FOLD_M = 0.12  # distance of folds round a part of 1 m girth; it grows with the root of the girth
_COLD_HANDS = {"hand": 1.0, "foot": 0.8, "forearm": 0.4, "shin": 0.3}  # share by part


class Finisher:
    """Adds full detail to the appearance of one person's parts.

    In air of 21 degC the mean temperature of a part, over many people, is the same as without detail.
    """

    def __init__(
        self, config: PersonConfig, air_c: float, rng: np.random.Generator, *, is_outdoors: bool = False
    ) -> None:
        clothes = config.clothes
        self.outfit, self.manner = draw_bearing(config, rng)
        self._traits = draw_traits(config, self.outfit, air_c, rng)
        names = (clothes.hair, clothes.shoes, clothes.bottom, clothes.top)
        worn = [(garment, name) for (garment, _), name in zip(clothes.garments(), names, strict=True)]
        self._worn = {part: (g, name) for g, name in worn for part in g.covers if name != "bald"}
        self._worn |= dict.fromkeys(self.outfit.covers, self._worn["chest"])
        self._fit = {name: _FIT * float(np.clip(rng.normal(), -2.0, 2.0)) for name in names}
        self._hair = "cap" if self.outfit.headgear != "none" else clothes.hair
        self._bag_rgb = COLOURS[str(rng.choice(_BAG_COLOURS))]
        self._loss = wind_loss(float(rng.uniform(*_WIND_M_S))) if is_outdoors else 1.0
        self._air_c, self._rng = air_c, rng

    def finish(
        self, materials: Mapping[str, Material], geometry: Mapping[str, PartGeometry], head_m: float
    ) -> dict[str, Material]:
        """Add detail to the materials that `dress` returns, for parts of the given shapes.

        Face and hair are those of a person of the stature `head_m`.
        """
        self._stature_m = head_m
        skin_rgb, hair_rgb = materials["head"].rgb, materials["hair"].rgb
        materials = {**materials, **dict.fromkeys(self.outfit.covers, materials["chest"])}
        brows = COLOURS["dark_brown"] if self._hair in ("bald", "cap") else hair_rgb
        return {
            part: self._finish_part(part, materials[part], shape, brows if part == "head" else skin_rgb)
            for part, shape in geometry.items()
        }

    def _finish_part(self, part: str, material: Material, geometry: PartGeometry, second: Rgb) -> Material:
        if part == PHONE_PART:
            return material
        if part == BAG_PART:
            warmer_k = material.temperature_c - ROOM_C
            return replace(material, temperature_c=self._air_c + warmer_k, rgb=self._bag_rgb)
        bare = part.removeprefix("left_").removeprefix("right_")
        if part not in self._worn:
            skin_c = self._skin_c(material.temperature_c, part, bare)
            finish = self._face(skin_c, geometry, second) if part == "head" else self._skin(bare, geometry)
            return replace(material, temperature_c=skin_c, finish=finish)
        garment, name = self._worn[part]
        surface_c = self._surface_c(material.temperature_c, part, name)
        finish = (
            self._head_of_hair(surface_c, geometry, second)
            if part == "hair"
            else self._cloth(part, bare, garment, name, surface_c, geometry, second)
        )
        return replace(material, temperature_c=surface_c, finish=finish)

    def _skin_c(self, at_room_c: float, part: str, bare: str) -> float:
        own_k = self._traits.warmer_k + self._traits.hands_k * _COLD_HANDS.get(bare, 0.0)
        return bare_c(at_room_c, part, self._air_c) + own_k

    def _surface_c(self, at_room_c: float, part: str, name: str) -> float:
        """Return the surface temperature [degC] of a garment on this person."""
        surface_c = cloth_c(at_room_c, part, self._air_c, self._loss)
        own_k = share_of_skin(at_room_c) * self._traits.warmer_k + self._fit[name] * (surface_c - self._air_c)
        return surface_c + own_k

    def _face(self, face_c: float, geometry: PartGeometry, hair: Rgb) -> Finish:
        mesh, _ = _lay(geometry, _FACE_TEXEL_M)
        return paint_face(mesh, self._stature_m, face_c, self._air_c, self._traits).finish(hair)

    def _head_of_hair(self, hair_c: float, geometry: PartGeometry, scalp: Rgb) -> Finish:
        mesh, _ = _lay(geometry, _HAIR_TEXEL_M)
        share = float(np.clip((hair_c - self._air_c) / 8.5, -0.5, 2.0))
        return paint_hair(mesh, self._stature_m, self._hair, share, self._traits, self._rng).finish(scalp)

    def _skin(self, bare: str, geometry: PartGeometry) -> Finish:
        mesh, depth_m = _lay(geometry, _SKIN_TEXEL_M)
        cold_k = max(ROOM_C - self._air_c, 0.0)
        tip_k = {"hand": -1.2 - 0.2 * cold_k + 0.5 * self._traits.hands_k, "shin": -1.0, "forearm": -0.6}
        return paint_skin(
            mesh, crumple(mesh, _fold_m(depth_m), self._rng), bare, tip_k.get(bare, 0.0)
        ).finish()

    def _cloth(
        self,
        part: str,
        bare: str,
        garment: Garment,
        name: str,
        surface_c: float,
        geometry: PartGeometry,
        skin: Rgb,
    ) -> Finish:
        mesh, depth_m = _lay(geometry, _CLOTH_TEXEL_M)
        sheet = crumple(mesh, _fold_m(depth_m), self._rng)
        worn = Worn(
            part=bare,
            garment=garment,
            cloth_c=surface_c,
            skin_c=under_cloth_c(part, self._air_c) + self._traits.warmer_k,
            air_c=self._air_c,
            half_depth_m=depth_m,
            outward={"left": 1.0, "right": -1.0}.get(part.split("_")[0], 0.0),
            under_c=self._surface_c(_SHIRT_C, part, name),
        )
        if bare == "foot":
            return paint_shoes(mesh, sheet, worn).finish()
        paint = paint_cloth(mesh, sheet, worn)
        add_trimmings(paint, worn, self._traits, name)
        return paint.finish(_SHIRT_RGB if name in OPEN else skin)


def appearance_stream(seed: int, name: str) -> np.random.Generator:
    """Return the random stream of a person's appearance in a world of the given seed."""
    return stream(seed, f"person.{name}.looks")


def draw_bearing(config: PersonConfig, rng: np.random.Generator) -> tuple[Outfit, Manner]:
    """Draw a person's outfit and manner, before anything else of its appearance."""
    outfit = draw_outfit(rng, config.clothes, config.sex, config.bag or config.equipment != "nothing")
    carries = _hand_that_carries(config, outfit)
    return outfit, draw_manner(rng, carries, has_straps=_has_straps(outfit))


def _hand_that_carries(config: PersonConfig, outfit: Outfit) -> str | None:
    if config.bag:
        return "right"
    return outfit.side if outfit.carried == "shopping_bag" else None


def _has_straps(outfit: Outfit) -> bool:
    return outfit.carried in ("rucksack", "shoulder_bag")


def _fold_m(depth_m: float) -> float:
    return float(_FOLD_M * (2.0 * np.pi * depth_m) ** 0.5)


def _lay(geometry: PartGeometry, texel_m: float) -> tuple[Mesh, float]:
    """Return a grid round a part, and half the part's depth [m]."""
    low, high = np.array([_reach(shape) for shape in geometry.shapes]).transpose(1, 0, 2)
    least, most = low.min(axis=0), high.max(axis=0)
    half = (most - least) / 2.0
    round_m = 2.0 * np.pi * float(np.mean(half[:2]))
    return make_mesh(float(least[2]), float(most[2]), round_m, texel_m), float(half[0])


def _reach(shape: Shape) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the least and greatest corners (3,) [m] of a shape in its part's frame."""
    at = np.array(shape.position)
    half = np.full(3, shape.size[0])
    if shape.kind == ShapeKind.BOX:
        half = np.array(shape.size) / 2.0
    elif shape.kind in (ShapeKind.CAPSULE, ShapeKind.CYLINDER):
        x, y, z, w = shape.orientation
        axis = np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])
        is_flat = shape.kind == ShapeKind.CYLINDER
        across = np.sqrt(np.maximum(1.0 - axis**2, 0.0)) if is_flat else 1.0
        half = np.abs(axis) * shape.size[0] / 2.0 + across * shape.size[1]
    return at - half, at + half
