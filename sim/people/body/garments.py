"""Garments on the mesh of a body: its parts, pushed out along their normals and widened."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.bodies import RestBody
from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.outfit import Outfit
from peopleboy.sim.people.body.skeleton import BONE_INDEX

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

_SHOE_M: Final = 0.008  # thickness of shoes
_SOLE_M: Final = 0.02  # vertices below this height belong to the sole, which is flat
_HAIR_M: Final[Mapping[str, float]] = {"short": 0.012, "long": 0.018, "cap": 0.008, "bald": 0.0}
_HOOD_M: Final = 0.02
_HEM_M: Final = 0.028  # trousers hang this far below the ankle's cut
# [m] Radii at the lower end of loose garments, if the outfit names none.
_LEG_M: Final[Mapping[str, float]] = {"jeans": 0.056, "trousers": 0.062}
_SLEEVE_M: Final[Mapping[str, float]] = {
    "shirt": 0.044, "checked_shirt": 0.044, "wool_jumper": 0.046, "striped_jumper": 0.046, "fleece": 0.048,
    "jacket": 0.05, "lab_coat": 0.052,
}  # fmt: skip
_SHORT_SLEEVE_M: Final = 0.062
# Radii of what surrounds each thigh, as fractions of stature.
_THIGH: Final[Mapping[str, float]] = {"shorts": 0.059, "skirt": 0.083, "lab_coat": 0.082}
_LONG_COAT: Final = 0.084
_LOOSE_FROM: Final = 0.15  # share of a limb above which cloth follows it
_SMALL: Final = 1e-9


def bare_stature(stature_m: float, clothes: Clothes) -> float:
    """Return the stature [m] without shoes and hair of a person of a given height."""
    return stature_m - _SHOE_M - _HAIR_M[clothes.hair]


class Garments:
    """Clothes on one body at rest: which garment covers each part, and how far it stands off the skin."""

    def __init__(self, body: RestBody, clothes: Clothes, outfit: Outfit, stature_m: float) -> None:
        self._body, self._clothes, self._outfit, self._h = body, clothes, outfit, stature_m
        self._labels = list(body.mesh.labels)
        names = (clothes.hair, clothes.shoes, clothes.bottom, clothes.top)
        self._names = ("skin", *names)
        self._group = dict.fromkeys(self._labels, 0)
        self._thickness = np.zeros(len(self._names))
        for number, (garment, _) in enumerate(clothes.garments(), start=1):
            self._thickness[number] = garment.thickness_m
            for part in garment.covers:
                self._group[part] = number
        for part in outfit.covers:
            self._group[part] = len(names)
        self._thickness[1], self._thickness[2] = self._hair_m(), _SHOE_M
        if clothes.hair == "bald" and outfit.headgear == "none":
            self._group["hair"] = 0

    def _hair_m(self) -> float:
        if self._outfit.headgear == "hood":
            return _HOOD_M
        return _HAIR_M[self._clothes.hair] + 0.4 * self._outfit.hair_m

    def worn(self) -> tuple[Array, Numbers, Numbers, Numbers]:
        """Return the dressed mesh.

        Where garments meet, vertices are doubled, and a strip closes the step between them.

        Returns:
            (V, 3) vertices [m], (T, 3) triangles, (T,) labels, and (V,) rows of the body's vertices.
        """
        mesh = self._body.mesh
        group_of_label = np.array([self._group[name] for name in self._labels])
        group = group_of_label[mesh.label]
        keys, corners = np.unique(mesh.triangles * len(self._names) + group[:, None], return_inverse=True)
        corners = corners.reshape(-1, 3)
        rows, groups = keys // len(self._names), keys % len(self._names)
        strips, strip_labels = _strips(mesh.triangles, corners, group, mesh.label, self._thickness)
        label = np.concatenate([mesh.label, strip_labels])
        triangles = np.concatenate([corners, strips])
        normals = _normals(self._body.vertices, mesh.triangles)
        vertices = self._body.vertices[rows] + self._thickness[groups, None] * normals[rows]
        self._loosen(vertices, corners, mesh.label, groups)
        return vertices, triangles, label, rows

    def _loosen(self, vertices: Array, triangles: Numbers, label: Numbers, groups: Numbers) -> None:
        """Widen sleeves, trouser legs, skirts and coats, and flatten soles, in place."""
        for side in SIDES:
            for name, radius_m in self._radii().items():
                part = f"{side}_{name}"
                if radius_m > 0.0:
                    own = _own(triangles, label, self._labels.index(part), groups, self._group[part])
                    hem_m = _HEM_M if name == "shin" and self._is_long() else 0.0
                    self._widen(vertices, own, BONE_INDEX[part], radius_m, hem_m)
            foot = f"{side}_foot"
            own = _own(triangles, label, self._labels.index(foot), groups, self._group[foot])
            soles = own[vertices[own, 2] < _SOLE_M]
            vertices[soles, 2] = vertices[own, 2].min()

    def _radii(self) -> dict[str, float]:
        """Return the radius [m] of loose cloth at the lower end of each limb, 0 where it follows the limb."""
        return {
            "thigh": self._thigh_m(),
            "shin": self._leg_m(),
            "forearm": self._sleeve_m(),
            "upper_arm": self._upper_sleeve_m(),
        }

    def _is_long(self) -> bool:
        return self._clothes.bottom in ("jeans", "trousers")

    def _leg_m(self) -> float:
        if not self._is_long():
            return 0.0
        return (self._outfit.leg_m or _LEG_M[self._clothes.bottom]) * self._h / 1.75

    def _sleeve_m(self) -> float:
        return (self._outfit.sleeve_m or _SLEEVE_M.get(self._clothes.top, 0.0)) * self._h / 1.75

    def _upper_sleeve_m(self) -> float:
        is_short = self._clothes.top in ("t_shirt", "printed_t_shirt")
        return _SHORT_SLEEVE_M * self._h / 1.75 if is_short else 0.0

    def _thigh_m(self) -> float:
        if self._outfit.coat == "long":
            return _LONG_COAT * self._h
        worn = self._clothes.top if self._clothes.top in _THIGH else self._clothes.bottom
        return _THIGH.get(worn, 0.0) * self._h

    def _widen(self, vertices: Array, own: Numbers, bone: int, radius_m: float, hem_m: float) -> None:
        """Push vertices of a limb away from its axis, to a radius that grows towards the limb's end."""
        body = self._body
        local = body.in_bone(bone, vertices[own])
        length = -float(local[:, 2].min())
        along = np.clip((-local[:, 2] / length - _LOOSE_FROM) / (1.0 - _LOOSE_FROM), 0.0, 1.0)
        distance = np.maximum(np.hypot(local[:, 0], local[:, 1]), _SMALL)
        # At the top cloth follows the limb, at the end it hangs free.
        wanted = radius_m * np.minimum(1.0, 2.0 * along)
        factor = np.maximum(wanted / distance, 1.0)
        local[:, :2] *= factor[:, None]
        local[:, 2] -= hem_m * np.clip((along - 0.85) / 0.15, 0.0, 1.0)
        vertices[own] = local @ body.turns[bone] + body.joints[bone]


def _own(triangles: Numbers, label: Numbers, wanted: int, groups: Numbers, group: int) -> Numbers:
    """Return the vertices of a part that belong to the garment which covers it."""
    own: Numbers = np.unique(triangles[label == wanted])
    chosen: Numbers = own[groups[own] == group]
    return chosen


def _normals(vertices: Array, triangles: Numbers) -> Array:
    """Return unit normals (V, 3) of vertices."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, triangles[:, k], flat)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), _SMALL))


def _strips(
    triangles: Numbers, corners: Numbers, group: Numbers, label: Numbers, thickness: Array
) -> tuple[Numbers, Numbers]:
    """Return the triangles that close the steps between garments, and their labels.

    Args:
        triangles: (T, 3) of the undressed mesh.
        corners: (T, 3) the same with doubled vertices.
        group: (T,) garment of each triangle.
        label: (T,) its part.
        thickness: thickness of each garment; the thicker one owns the strip.
    """
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    own_start, own_end = corners.reshape(-1), np.roll(corners, -1, axis=1).reshape(-1)
    edge = {(a, b): k for k, (a, b) in enumerate(zip(start.tolist(), end.tolist(), strict=True))}
    made, labels = [], []
    for (a, b), k in edge.items():
        other = edge.get((b, a))
        if a > b or other is None or group[owner[k]] == group[owner[other]]:
            continue
        # Along this edge one side runs from p to q, the other from s to r.
        p, q, r, s = own_start[k], own_end[k], own_start[other], own_end[other]
        made += [(q, p, s), (q, s, r)]
        outer = max(owner[k], owner[other], key=lambda t: thickness[group[t]])
        labels += [label[outer]] * 2
    return np.array(made, np.int64).reshape(-1, 3), np.array(labels, np.int64)
