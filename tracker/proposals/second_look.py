"""A second look at what trees propose: a small network tells whether somebody is there, and where."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.proposals.crops import (
    COLUMNS,
    NUMBERS,
    PLANES,
    ROWS,
    SCORES,
    Planes,
    crops_of,
    numbers_of,
    planes_of,
)
from peopleboy.tracker.proposals.placing import OFFSETS, moved
from peopleboy.tracker.proposals.suppression import Proposals, suppress
from peopleboy.tracker.proposals.window import Floats
from peopleboy.tracker.thermal.mount import Mount
from peopleboy.tracker.weights_archive import opened_archive

Grey = NDArray[np.uint8]

LAYERS: Final = ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96), (1, 1, 32))
"""Side of the kernel, stride and planes of each layer."""
UNITS: Final = 128
TOLD: Final = 1 + OFFSETS
SCALES: Final = np.array([1.0, 0.02, 0.06, 0.08, 0.03])
"""What a unit of each that is told means: log odds, and `placing.offsets`."""
USUAL: Final = np.array([0.0, 0.0, 0.0, 0.0, 0.22])
"""What is told by a network that knows nothing."""

COMMAND: Final = "peopleboy train-detector --second-look"
NETWORK: Final = Path(__file__).parent / "weights" / "second_look.npz"
"""The network that comes with the tracker."""

BELIEVED: Final = 0.5
"""Share of what the second look adds to the log odds of the first that is believed.

In rendered images all of it would be right; in those of real cameras the network is too sure of itself.
"""
BELIEVED_OF_STRANGERS: Final = 0.3
"""The same of a camera whose mount is not known, which is no robot's own."""

_ABOUT: Final = "about"
_PART: Final = 512  # terms of a sum


def shapes() -> dict[str, tuple[int, ...]]:
    """Give the shapes of all weights: what goes in, what comes out."""
    told: dict[str, tuple[int, ...]] = {}
    depth, rows, columns = PLANES, ROWS, COLUMNS
    for layer, (side, stride, planes) in enumerate(LAYERS):
        told |= {f"kernel{layer}": (side * side * depth, planes), f"bias{layer}": (planes,)}
        depth, rows, columns = planes, rows // stride, columns // stride
    told |= {"all": (rows * columns * depth + NUMBERS, UNITS), "all_bias": (UNITS,)}
    return told | {"last": (UNITS, TOLD), "last_bias": (TOLD,), "line": (2,)}


@dataclass(frozen=True, slots=True, eq=False)
class SecondLook:
    """Convolutions, and two layers that see all.

    Attributes:
        weights: float32 by name, as `shapes` says; `line` is gain and offset that make scores log odds.
        about: what it was learned from, for the reader.
    """

    weights: Mapping[str, Planes]
    about: Mapping[str, str] = field(default_factory=dict)

    def told(self, planes: Planes, numbers: Planes) -> Floats:
        """Tell of crops (N, 64, 48, 3) with numbers (N, 9) log odds and offsets (N, 5).

        Log odds are those of the first look and what is added to them.
        """
        here = planes
        for layer, (side, stride, _) in enumerate(LAYERS):
            seen = in_parts(patches(here, side, stride), self.weights[f"kernel{layer}"])
            here = np.maximum(seen + self.weights[f"bias{layer}"], np.float32(0.0))
        flat = np.concatenate([here.reshape(len(here), -1), numbers], axis=1)
        units = np.maximum(in_parts(flat, self.weights["all"]) + self.weights["all_bias"], np.float32(0.0))
        last = (units @ self.weights["last"] + self.weights["last_bias"]).astype(np.float64)
        last[:, 0] += SCORES * numbers[:, 0]
        gain, offset = self.weights["line"].tolist()
        last[:, 0] = gain * last[:, 0] + offset
        return np.asarray(last * SCALES + USUAL)

    def save(self, path: Path) -> None:
        """Write a NumPy archive without pickles; weights have 11 bits there."""
        content: dict[str, Any] = {_ABOUT: np.array(json.dumps(dict(self.about)))}
        content |= {name: array.astype(np.float16) for name, array in self.weights.items()}
        with path.open("wb") as file:
            np.savez_compressed(file, **content)

    @classmethod
    def load(cls, path: Path) -> SecondLook:
        """Read a network.

        Raises:
            BadInput: a file that is missing, is none, or holds another network.
        """
        with opened_archive(path, COMMAND) as archive:
            about = json.loads(str(archive[_ABOUT]))
            arrays = {name: np.asarray(archive[name]) for name in shapes()}
        if not all(_fits(arrays[name], shape) for name, shape in shapes().items()):
            raise BadInput(
                f"holds no network for crops of {ROWS} x {COLUMNS}; `{COMMAND}` makes one", file=str(path)
            )
        return cls({name: array.astype(np.float32) for name, array in arrays.items()}, about)


def look_again(
    network: SecondLook, grey: Grey, change: Grey, first: Proposals, mount: Mount | None, least_score: float
) -> Proposals:
    """Look again at what was proposed in an image of which it is known by how much (H, W) greys changed.

    Boxes are those of the second look; scores lie between both.
    """
    if len(first.box) == 0:
        return first
    crops = crops_of(grey, change, first.box)
    numbers = numbers_of(first, crops, (grey.shape[0], grey.shape[1]), mount)
    told = network.told(planes_of(crops), numbers)
    believed = BELIEVED_OF_STRANGERS if mount is None else BELIEVED
    score = first.score + believed * (told[:, 0] - first.score)
    is_sure = score >= least_score
    return suppress(moved(first.box, told[:, 1:])[is_sure], score[is_sure])


def patches(planes: Planes, side: int, stride: int) -> Planes:
    """Give what a kernel sees at each place, (N, H', W', side side C), of planes (N, H, W, C)."""
    edge = side // 2
    padded = np.pad(planes, ((0, 0), (edge, edge), (edge, edge), (0, 0)))
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


@cache
def shipped_network() -> SecondLook:
    """Read the network that comes with the tracker."""
    return SecondLook.load(NETWORK)


def _fits(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    return array.shape == shape and array.dtype == np.float16 and bool(np.isfinite(array).all())
