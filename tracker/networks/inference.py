"""Inference of dense and small convolutional networks, bit-identical on every processor."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import ClassVar, Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from peopleboy.tracker.networks.convolution import Planes, Workspace, convolve, convolve_tiles, tile_kernel
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive

Floats = NDArray[np.float32]

CHANNELS: Final = 3
"""Channels of a crop: grey, its change, and whether a pixel is inside the image."""


def one_thread() -> AbstractContextManager[object]:
    """Limit NumPy's matrix products to one thread; small ones take no longer.

    With several threads the last digits depend on their number.
    """
    if all(library.num_threads == 1 for library in _blas().lib_controllers):
        return nullcontext()
    limited: AbstractContextManager[object] = _blas().limit(limits=1)
    return limited


@cache
def _blas() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


@dataclass(frozen=True, slots=True, eq=False)
class DenseNetwork:
    """Fully connected layers with rectified linear units between them.

    Attributes:
        layers: (inputs, units) weights and (units,) bias of each layer.
    """

    layers: Sequence[tuple[Floats, Floats]]

    def predict(self, inputs: Floats) -> Floats:
        """Return the outputs (N, outputs) for inputs (N, inputs)."""
        *hidden, (weights, bias) = self.layers
        for inner, inner_bias in hidden:
            inputs = inputs @ inner
            inputs += inner_bias
            np.maximum(inputs, np.float32(0), out=inputs)
        return inputs @ weights + bias


class NetworkLayer(NamedTuple):
    """Shape of a convolution.

    Attributes:
        side: of its kernels [px].
        stride: step of the output [px].
        planes: number of output channels.
    """

    side: int
    stride: int
    planes: int

    @property
    def is_by_tiles(self) -> bool:
        """Whether Winograd filtering applies, which takes less than half of the products."""
        return self.side == 3 and self.stride == 1


class CropSize(NamedTuple):
    """The size of a crop.

    Attributes:
        rows, columns: of the crop [px].
        heights: height of the crop in heights of the box.
    """

    rows: int
    columns: int
    heights: float


class Architecture(NamedTuple):
    """Layers of a `CropNetwork`.

    Attributes:
        crop: its input image.
        features: number of further inputs per crop.
        layers: convolutions, in order.
        units: of the dense layer after them.
        outputs: of the last layer.
    """

    crop: CropSize
    features: int
    layers: tuple[NetworkLayer, ...]
    units: int
    outputs: int

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Return the shapes of all weights: inputs, outputs."""
        shapes: dict[str, tuple[int, ...]] = {}
        depth, rows, columns = CHANNELS, self.crop.rows, self.crop.columns
        for number, (side, stride, planes) in enumerate(self.layers):
            shapes |= {f"kernel{number}": (side * side * depth, planes), f"bias{number}": (planes,)}
            depth, rows, columns = planes, -(-rows // stride), -(-columns // stride)
        shapes |= {"all": (rows * columns * depth + self.features, self.units), "all_bias": (self.units,)}
        return shapes | {"last": (self.units, self.outputs), "last_bias": (self.outputs,)}


@dataclass(frozen=True, slots=True, eq=False)
class CropNetwork:
    """A convolutional network on crops of an image; subclasses define architecture and name.

    Attributes:
        weights: float32 by name, with the shapes of `shapes`.
        about: description of the training data, for readers of the file.
    """

    ARCHITECTURE: ClassVar[Architecture]
    MODEL: ClassVar[str]
    """Name for `peopleboy train`, and of the file."""

    weights: Mapping[str, Planes]
    about: Mapping[str, str] = field(default_factory=dict)
    _tile_kernels: Mapping[int, Planes] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Transform the kernels of the Winograd layers."""
        kernels = {
            number: tile_kernel(self.weights[f"kernel{number}"])
            for number, layer in enumerate(self.ARCHITECTURE.layers)
            if layer.is_by_tiles
        }
        object.__setattr__(self, "_tile_kernels", kernels)

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Return the shapes of all weights."""
        return cls.ARCHITECTURE.shapes()

    def outputs(self, planes: Planes, features: Planes, workspace: Workspace | None = None) -> Planes:
        """Return the outputs (N, outputs) of the last layer for crops (N, rows, columns, 3) and features.

        Args:
            planes: the crops.
            features: (N, F) numbers; the network uses the last ones, as many as its architecture has.
            workspace: buffers; None for new ones, which adds a quarter to the time.
        """
        weights, count = self.weights, self.ARCHITECTURE.features
        flat = np.empty((len(planes), len(weights["all"])), np.float32)
        flat[:, -count:] = features[:, -count:]
        dense = DenseNetwork([(weights["all"], weights["all_bias"]), (weights["last"], weights["last_bias"])])
        with one_thread():
            flat[:, :-count] = self._convolve(planes, workspace or Workspace()).reshape(len(planes), -1)
            return np.asarray(dense.predict(flat), np.float32)

    def _convolve(self, crops: Planes, workspace: Workspace) -> Planes:
        """Apply all convolutions to crops (N, rows, columns, 3)."""
        planes = crops
        for number, layer in enumerate(self.ARCHITECTURE.layers):
            bias = self.weights[f"bias{number}"]
            if layer.is_by_tiles:
                planes = convolve_tiles(planes, self._tile_kernels[number], bias, workspace)
            else:
                kernel = self.weights[f"kernel{number}"]
                planes = convolve(planes, kernel, bias, layer.side, layer.stride, workspace)
        return planes

    @classmethod
    @cache
    def shipped(cls) -> Self:
        """Read the shipped network."""
        return cls.load(SHIPPED / f"{cls.MODEL}.npz")

    def save(self, path: Path) -> None:
        """Write the network; weights are rounded to 11 bits, which halves the file."""
        arrays = {name: array.astype(np.float16) for name, array in self.weights.items()}
        WeightsArchive(arrays, self.about).save(path)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a network.

        Raises:
            BadInput: the file is missing, invalid, or holds another network.
        """
        specs = {name: ArraySpec(shape, np.float16) for name, shape in cls.shapes().items()}
        archive = WeightsArchive.load(path, cls.MODEL, specs)
        return cls({name: array.astype(np.float32) for name, array in archive.arrays.items()}, archive.about)
