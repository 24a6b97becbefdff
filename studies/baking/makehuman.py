"""MakeHuman's base mesh, its shapes, joints and skinning weights, read with numpy alone.

The data are CC0; see `bake_bodies`. Positions are in metres, with x to the person's front, y left and z up.
"""

import gzip
import itertools
import json
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

_DECIMETRE = 0.1
# Anchors of each factor of a shape, at which a single target has the full weight.
_AGES = {"baby": 0.0, "child": 1.0 / 3.0, "young": 2.0 / 3.0, "old": 1.0}
_THREE = {"min": 0.0, "average": 0.5, "max": 1.0}
_TWO = {"min": 0.0, "max": 1.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyFactors:
    """The factors of one body, each from 0 to 1.

    Attributes:
        sex: "female" or "male".
        age: 0 a baby, 1/3 a child, 2/3 a young adult, 1 an old person.
        weight, muscle, height, proportions, cup: 0.5 is the average.
        ancestry: shares of the African, Asian and Caucasian targets; they sum to 1.
    """

    sex: str
    age: float
    weight: float = 0.5
    muscle: float = 0.5
    height: float = 0.5
    proportions: float = 0.5
    cup: float = 0.4
    ancestry: tuple[float, float, float] = (1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)


class MakeHuman:
    """The data in the folder `mpfb2`.

    Attributes:
        vertices: (V, 3) [m] the base mesh.
        triangles: (T, 3) those of its body, counterclockwise from outside.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.vertices, self._groups = _read_obj(folder / "3dobjs" / "base.obj")
        quads = self._groups["body"]
        self.triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])

    def shape(self, figure: BodyFactors) -> Array:
        """Return the vertices (V, 3) [m] of a body."""
        vertices = self.vertices.copy()
        for name, share in _targets(figure):
            path = self._folder / "targets" / f"{name}.target.gz"
            if share > 0.0 and path.exists():
                rows, moves = self._target(path)
                np.add.at(vertices, rows, share * moves)
        return vertices

    def joint(self, vertices: Array, name: str) -> Array:
        """Return the middle (3,) of a cube that marks a joint, such as "l-eye", in a body (V, 3)."""
        middle: Array = vertices[np.unique(self._groups[f"joint-{name}"])].mean(axis=0)
        return middle

    def weights(self, rig: str) -> dict[str, Array]:
        """Return the weights (V,) of each bone of a rig."""
        data = json.loads((self._folder / "rigs" / "standard" / f"weights.{rig}.json").read_text("utf-8"))
        found = {}
        for bone, pairs in data["weights"].items():
            found[bone] = np.zeros(len(self.vertices))
            if pairs:
                rows, values = zip(*pairs, strict=True)
                found[bone][list(rows)] = values
        return found

    def _target(self, path: Path) -> tuple[Numbers, Array]:
        if path not in self._known:
            with warnings.catch_warnings(), gzip.open(path, "rt", encoding="utf-8") as file:
                warnings.simplefilter("ignore")  # some targets are empty
                rows = np.loadtxt(file, ndmin=2).reshape(-1, 4)
            self._known[path] = rows[:, 0].astype(np.int64), _ours(rows[:, 1:])
        return self._known[path]

    @cached_property
    def _known(self) -> dict[Path, tuple[Numbers, Array]]:
        return {}


def _ours(vertices: Array) -> Array:
    """Convert decimetres with x left, y up and z to the front."""
    return vertices[:, [2, 0, 1]] * _DECIMETRE


def _read_obj(path: Path) -> tuple[Array, dict[str, Numbers]]:
    """Read vertices and the quadrilaterals (Q, 4) of each group."""
    vertices: list[list[float]] = []
    groups: dict[str, list[list[int]]] = {}
    group = ""
    for line in path.read_text("utf-8").splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "v":
            vertices.append([float(word) for word in rest.split()])
        elif kind == "g":
            group = rest.strip()
        elif kind == "f":
            corners = [int(word.split("/")[0]) - 1 for word in rest.split()]
            groups.setdefault(group, []).append((corners * 2)[:4] if len(corners) == 3 else corners)
    return _ours(np.array(vertices)), {name: np.array(faces) for name, faces in groups.items()}


def _tent(value: float, anchors: Mapping[str, float]) -> dict[str, float]:
    """Return the share of each anchor: linear between neighbours."""
    names, places = list(anchors), list(anchors.values())
    return {name: float(np.interp(value, places, np.eye(len(names))[i])) for i, name in enumerate(names)}


def _targets(figure: BodyFactors) -> Iterator[tuple[str, float]]:
    """Yield names and weights of all targets of a figure."""
    ages = _tent(figure.age, _AGES)
    muscle = {f"{k}muscle": v for k, v in _tent(figure.muscle, _THREE).items()}
    weight = {f"{k}weight": v for k, v in _tent(figure.weight, _THREE).items()}
    for ancestry, share in zip(("african", "asian", "caucasian"), figure.ancestry, strict=True):
        for age, of_age in ages.items():
            yield f"macrodetails/{ancestry}-{figure.sex}-{age}", share * of_age
    for (age, a), (m, b), (w, c) in itertools.product(ages.items(), muscle.items(), weight.items()):
        person = f"{figure.sex}-{age}-{m}-{w}"
        yield f"macrodetails/universal-{person}", a * b * c
        for kind, share in _tent(figure.height, _TWO).items():
            # Both halves act from the middle: at 0.5 there is neither.
            yield f"macrodetails/height/{person}-{kind}height", a * b * c * max(2.0 * share - 1.0, 0.0)
        for kind, share in _tent(figure.proportions, {"uncommon": 0.0, "ideal": 1.0}).items():
            name = f"macrodetails/proportions/{person}-{kind}proportions"
            yield name, a * b * c * max(2.0 * share - 1.0, 0.0)
        if figure.sex == "female":
            for cup, share in _tent(figure.cup, _THREE).items():
                yield f"breast/{person}-{cup}cup-averagefirmness", a * b * c * share
