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
from peopleboy.tracker.proposals.looks.convolution import Desk, convolved, convolved_by_tiles, turned
from peopleboy.tracker.proposals.looks.crops import PLANES, CropSize, Planes
from peopleboy.tracker.proposals.looks.one_thread import one_thread
from peopleboy.tracker.weights_archive import opened_archive

_ABOUT: Final = "about"


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

    @property
    def is_by_tiles(self) -> bool:
        """Whether the half of the products is enough for it."""
        return self.side == 3 and self.stride == 1


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
    _turned: Mapping[int, Planes] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Turn the kernels of those layers that look by tiles."""
        kernels = {
            number: turned(self.weights[f"kernel{number}"])
            for number, layer in enumerate(self.FORM.layers)
            if layer.is_by_tiles
        }
        object.__setattr__(self, "_turned", kernels)

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Give the shapes of all weights."""
        return cls.FORM.shapes()

    def last(self, planes: Planes, numbers: Planes, desk: Desk | None = None) -> Planes:
        """Give what the last layer says (N, told) of crops (N, rows, columns, 3) and their numbers.

        Args:
            planes: the crops.
            numbers: (N, numbers).
            desk: where to work; None for a new one, which costs a quarter of the time.
        """
        weights, seen = self.weights, numbers.shape[1]
        flat = np.empty((len(planes), len(weights["all"])), np.float32)
        flat[:, -seen:] = numbers
        with one_thread():
            flat[:, :-seen] = self._convolved(planes, desk or Desk()).reshape(len(planes), -1)
            units = np.maximum(flat @ weights["all"] + weights["all_bias"], np.float32(0.0))
            return np.asarray(units @ weights["last"] + weights["last_bias"], np.float32)

    def _convolved(self, crops: Planes, desk: Desk) -> Planes:
        """Give what all convolutions make of crops (N, rows, columns, 3)."""
        here = crops
        for number, layer in enumerate(self.FORM.layers):
            bias = self.weights[f"bias{number}"]
            if layer.is_by_tiles:
                here = convolved_by_tiles(here, self._turned[number], bias, desk)
            else:
                here = convolved(here, self.weights[f"kernel{number}"], bias, layer.side, layer.stride, desk)
        return here

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


def _fits(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    return array.shape == shape and array.dtype == np.float16 and bool(np.isfinite(array).all())
