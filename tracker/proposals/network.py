"""Small networks that look at crops of an image: convolutions, and two layers that see all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.proposals.crops import PLANES, CropSize, Planes
from peopleboy.tracker.weights_archive import opened_archive

_ABOUT: Final = "about"
_PART: Final = 512  # terms of a sum


class Layer(NamedTuple):
    """A convolution.

    Attributes:
        side: of its kernels [px].
        stride: pixels between places where it looks.
        planes: that it gives.
    """

    side: int
    stride: int
    planes: int


class Form(NamedTuple):
    """What a network is made of.

    Attributes:
        crop: what it looks at.
        numbers: that it gets beside each crop.
        layers: its convolutions, one after another.
        units: of the layer after them.
        told: how many numbers it tells.
    """

    crop: CropSize
    numbers: int
    layers: tuple[Layer, ...]
    units: int
    told: int

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Give the shapes of all weights: what goes in, what comes out."""
        shapes: dict[str, tuple[int, ...]] = {}
        depth, rows, columns = PLANES, self.crop.rows, self.crop.columns
        for number, (side, stride, planes) in enumerate(self.layers):
            shapes |= {f"kernel{number}": (side * side * depth, planes), f"bias{number}": (planes,)}
            depth, rows, columns = planes, -(-rows // stride), -(-columns // stride)
        shapes |= {"all": (rows * columns * depth + self.numbers, self.units), "all_bias": (self.units,)}
        return shapes | {"last": (self.units, self.told), "last_bias": (self.told,)}


@dataclass(frozen=True, slots=True, eq=False)
class CropNetwork:
    """Weights of a network of one form, which its classes tell.

    Attributes:
        weights: float32 by name, as `shapes` says.
        about: what it was learned from, for the reader.
    """

    FORM: ClassVar[Form]
    COMMAND: ClassVar[str]
    """What makes a file of it."""

    weights: Mapping[str, Planes]
    about: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Give the shapes of all weights."""
        return cls.FORM.shapes()

    def last(self, planes: Planes, numbers: Planes) -> Planes:
        """Give what the last layer says (N, told) of crops (N, rows, columns, 3) and their numbers."""
        here = planes
        for layer, (side, stride, _) in enumerate(self.FORM.layers):
            seen = in_parts(patches(here, side, stride), self.weights[f"kernel{layer}"])
            here = np.maximum(seen + self.weights[f"bias{layer}"], np.float32(0.0))
        flat = np.concatenate([here.reshape(len(here), -1), numbers], axis=1)
        units = np.maximum(in_parts(flat, self.weights["all"]) + self.weights["all_bias"], np.float32(0.0))
        return np.asarray(units @ self.weights["last"] + self.weights["last_bias"], np.float32)

    def save(self, path: Path) -> None:
        """Write a NumPy archive without pickles; weights have 11 bits there."""
        content: dict[str, Any] = {_ABOUT: np.array(json.dumps(dict(self.about)))}
        content |= {name: array.astype(np.float16) for name, array in self.weights.items()}
        with path.open("wb") as file:
            np.savez_compressed(file, **content)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a network.

        Raises:
            BadInput: a file that is missing, is none, or holds another network.
        """
        with opened_archive(path, cls.COMMAND) as archive:
            about = json.loads(str(archive[_ABOUT]))
            arrays = {name: np.asarray(archive[name]) for name in cls.shapes()}
        if not all(_fits(arrays[name], shape) for name, shape in cls.shapes().items()):
            rows, columns, _ = cls.FORM.crop
            raise BadInput(
                f"holds no network for crops of {rows} x {columns}; `{cls.COMMAND}` makes one", file=str(path)
            )
        return cls({name: array.astype(np.float32) for name, array in arrays.items()}, about)


def patches(planes: Planes, side: int, stride: int) -> Planes:
    """Give what a kernel sees at each place, (N, H', W', side side C), of planes (N, H, W, C)."""
    edge = side // 2
    number, high, wide, deep = planes.shape
    padded = np.zeros((number, high + 2 * edge, wide + 2 * edge, deep), np.float32)
    padded[:, edge : edge + high, edge : edge + wide] = planes
    seen = np.lib.stride_tricks.sliding_window_view(padded, (side, side), (1, 2))[:, ::stride, ::stride]
    count, rows, columns, depth = seen.shape[:4]
    whole = np.ascontiguousarray(seen.transpose(0, 1, 2, 4, 5, 3))
    return np.asarray(whole.reshape(count, rows, columns, side * side * depth), np.float32)


def in_parts(one: Planes, other: Planes) -> Planes:
    """Multiply matrices (..., K) and (K, M), part of K by part.

    Of long sums a BLAS gives each thread a part, and results would hang on how many threads there are.
    """
    total = one[..., :_PART] @ other[:_PART]
    for begin in range(_PART, len(other), _PART):
        total += one[..., begin : begin + _PART] @ other[begin : begin + _PART]
    return total


def _fits(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    return array.shape == shape and array.dtype == np.float16 and bool(np.isfinite(array).all())
