"""A fully convolutional network that detects people of all sizes, and their postures, in a thermal image.

Anchor-free: each position of a map of scores is the middle of at most one person (CenterNet, Zhou et al.
2019), on four maps for people of different heights (feature pyramid, Lin et al., CVPR 2017).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Final, NamedTuple, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, intersection
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.convolution import Planes, Workspace, convolve, convolve_tiles, tile_kernel
from peopleboy.tracker.networks.inference import NetworkLayer, one_thread
from peopleboy.tracker.networks.weights_archive import ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.detections import SHARED
from peopleboy.tracker.track import TrackPosture

Grey = NDArray[np.uint8]
Floats = NDArray[np.float64]

PLANES: Final = 5
"""Channels of the input: grey, grey relative to its surroundings, change, expected height, and inside."""
STRIDES: Final = (4, 8, 16, 32)
"""Steps of the maps [px]."""
HEIGHTS: Final = 8.0
"""Typical height of the people on a map, in strides."""
USUAL: Final = np.array([0.0, 0.0, 0.0, -1.4, -1.4, -1.4])
"""Values of the box at outputs of 0: shift of the middle to the right and down, and logarithms."""
SHIFT: Final = 0.25
"""Unit of the shifts, in typical heights."""
BOX: Final = 6


OUTPUTS: Final = 1 + BOX + len(TrackPosture)
"""Per position: log-odds, box, and log-odds of the postures."""

_DEPTHS: Final = {4: 32, 8: 64, 16: 96, 32: 128}
_RESIDUAL: Final = {4: "a", 8: "ab", 16: "ab", 32: "a"}


def parts_of(stride: int) -> tuple[str, ...]:
    """Return the names of the residual layers at a stride."""
    return tuple(f"body{stride}{part}" for part in _RESIDUAL[stride])


def _layers() -> dict[str, tuple[NetworkLayer, int]]:
    """Return each layer with the depth of its input."""
    layers = {"stem": (NetworkLayer(3, 2, 16), PLANES)}
    depth = 16
    for stride, planes in _DEPTHS.items():
        layers[f"down{stride}"] = NetworkLayer(3, 2, planes), depth
        layers |= {name: (NetworkLayer(3, 1, planes), planes) for name in parts_of(stride)}
        depth = planes
    for stride in STRIDES[:-1]:
        planes = _DEPTHS[stride]
        layers[f"into{stride}"] = NetworkLayer(1, 1, planes), _DEPTHS[2 * stride]
        layers[f"side{stride}"] = NetworkLayer(1, 1, planes), planes
        layers[f"head{stride}"] = NetworkLayer(3, 1, planes), planes
    for stride, planes in _DEPTHS.items():
        layers[f"out{stride}"] = NetworkLayer(1, 1, OUTPUTS), planes
    return layers


LAYERS: Final[Mapping[str, tuple[NetworkLayer, int]]] = _layers()

_GLOBAL_GREY: Final = 2.0  # added to the deviation of the image, and ...
_LOCAL_GREY: Final = 4.0  # ... of the surroundings [grey]: below it contrast is noise
_SURROUNDINGS_PX: Final = 31
_MOST: Final = 4.0  # in standard deviations
_STATURE_M: Final = 1.7
_HEIGHT_PX: Final = 64.0  # unit of expected heights
_HIGHEST: Final = 4.0


def input_planes(grey: Grey, change: Grey, mount: Mount | None) -> Planes:
    """Return the input (H, W, 5) for an image.

    Args:
        grey: (H, W) image.
        change: (H, W) change of the greys.
        mount: of the camera; None if unknown.
    """
    image = grey.astype(np.float32)
    planes = np.empty((*grey.shape, PLANES), np.float32)
    unit = np.float32(1.0 / (float(image.std()) + _GLOBAL_GREY))
    np.clip((image - image.mean()) * unit, -_MOST, _MOST, out=planes[..., 0])
    size = (_SURROUNDINGS_PX, _SURROUNDINGS_PX)
    mean = cv2.boxFilter(image, -1, size, borderType=cv2.BORDER_REPLICATE)
    square = cv2.sqrBoxFilter(image, cv2.CV_32F, size, borderType=cv2.BORDER_REPLICATE)
    spread = np.sqrt(np.maximum(square - mean * mean, 0.0)) + np.float32(_LOCAL_GREY)
    np.clip((image - mean) / spread, -_MOST, _MOST, out=planes[..., 1])
    np.clip(change.astype(np.float32) * unit, 0.0, _MOST, out=planes[..., 2])
    planes[..., 3] = 0.0
    if mount is not None:
        below = np.arange(len(grey)) - mount.horizon_px
        expected = np.clip(_STATURE_M * below / max(mount.height_m, 0.1) / _HEIGHT_PX, 0.0, _HIGHEST)
        planes[..., 3] = 0.25 + expected[:, None]
    planes[..., 4] = 1.0
    return planes


class NetworkDetections(NamedTuple):
    """What the network finds in an image.

    Attributes:
        score: (N,) log-odds.
        box: (N, 4) [px] from head to feet, as wide as the torso.
        edges: (N, 2) left and right edge of the whole person, as in `Detections`.
        posture: (N, 5) log-odds of the postures, up to a constant.
    """

    score: Floats
    box: Floats
    edges: Floats
    posture: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PeopleNetwork:
    """The network.

    Attributes:
        weights: float32 by name, with the shapes of `shapes`.
        about: description of the training data, for readers of the file.
    """

    MODEL: ClassVar[str] = "people"

    weights: Mapping[str, Planes]
    about: Mapping[str, str] = field(default_factory=dict)
    _tile_kernels: Mapping[str, Planes] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Transform the kernels of the Winograd layers."""
        kernels = {
            name: tile_kernel(self.weights[f"{name}_kernel"])
            for name, (layer, _) in LAYERS.items()
            if layer.is_by_tiles
        }
        object.__setattr__(self, "_tile_kernels", kernels)

    @staticmethod
    def shapes() -> dict[str, tuple[int, ...]]:
        """Return the shapes of all weights."""
        shapes: dict[str, tuple[int, ...]] = {"line": (2,)}
        for name, (layer, depth) in LAYERS.items():
            shapes[f"{name}_kernel"] = (layer.side * layer.side * depth, layer.planes)
            shapes[f"{name}_bias"] = (layer.planes,)
        return shapes

    def detect(
        self, grey: Grey, change: Grey, mount: Mount | None, least: float, workspace: Workspace
    ) -> NetworkDetections:
        """Detect people in an image (H, W).

        Args:
            grey: (H, W) image.
            change: (H, W) change of the greys.
            mount: of the camera; None if unknown.
            least: smallest log-odds of a detection.
            workspace: buffers.
        """
        rows, columns = grey.shape
        step = STRIDES[-1]
        planes = np.zeros((1, -(-rows // step) * step, -(-columns // step) * step, PLANES), np.float32)
        planes[0, :rows, :columns] = input_planes(grey, change, mount)
        with one_thread():
            maps = self.maps(planes, workspace)
        gain, offset = self.weights["line"].tolist()
        return suppress(decode(maps, (least - offset) / gain, (gain, offset)))

    def maps(self, planes: Planes, workspace: Workspace) -> dict[int, Planes]:
        """Return the maps (H', W', 12) by stride for an input (1, H, W, 5), with H and W multiples of 32."""

        def layer(name: str, inputs: Planes) -> Planes:
            return self._layer(name, inputs, workspace)

        here, seen = layer("stem", planes), {}
        for stride in STRIDES:
            here = layer(f"down{stride}", here)
            for name in parts_of(stride):
                here = here + layer(name, here)
            seen[stride] = here
        maps = {STRIDES[-1]: self._outputs(STRIDES[-1], here)}
        for stride in reversed(STRIDES[:-1]):
            above = layer(f"into{stride}", here).copy()
            here = layer(f"side{stride}", seen[stride]).copy()
            here += above.repeat(2, axis=1).repeat(2, axis=2)
            maps[stride] = self._outputs(stride, layer(f"head{stride}", here))
        return maps

    def _layer(self, name: str, planes: Planes, workspace: Workspace) -> Planes:
        layer, bias = LAYERS[name][0], self.weights[f"{name}_bias"]
        if layer.is_by_tiles:
            return convolve_tiles(planes, self._tile_kernels[name], bias, workspace)
        return convolve(planes, self.weights[f"{name}_kernel"], bias, layer.side, layer.stride, workspace)

    def _outputs(self, stride: int, planes: Planes) -> Planes:
        weights = self.weights
        return np.asarray(planes[0] @ weights[f"out{stride}_kernel"] + weights[f"out{stride}_bias"])

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


def decode(maps: Mapping[int, Planes], least: float, line: tuple[float, float]) -> NetworkDetections:
    """Return the people in maps by stride: the local maxima of the first output.

    Args:
        maps: (H', W', 12) outputs by stride.
        least: smallest first output of a person.
        line: gain and offset that make log-odds of it.
    """
    parts = []
    for stride, outputs in maps.items():
        score_map = np.ascontiguousarray(outputs[..., 0])
        highest = cv2.dilate(score_map, np.ones((3, 3), np.uint8))
        row, column = np.nonzero((score_map >= least) & (score_map == highest))
        here = outputs[row, column].astype(np.float64)
        box = here[:, 1 : 1 + BOX] + USUAL
        unit = HEIGHTS * stride
        u = (column + 0.5) * stride - 0.5 + SHIFT * unit * box[:, 0]
        v = (row + 0.5) * stride - 0.5 + SHIFT * unit * box[:, 1]
        height = unit * np.exp(np.clip(box[:, 2], -2.0, 2.5))
        width, left, right = (np.exp(np.clip(box[:, k], -4.0, 1.5)) for k in (3, 4, 5))
        width *= height
        boxes = np.stack([u - width / 2.0, v - height / 2.0, width, height], axis=1)
        score = line[0] * here[:, 0] + line[1]
        parts.append((score, boxes, np.stack([-left, right], axis=1), here[:, 1 + BOX :]))
    return NetworkDetections(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def suppress(found: NetworkDetections) -> NetworkDetections:
    """Keep the best of overlapping boxes, the highest score first."""
    order = np.argsort(-found.score, kind="stable")
    box = found.box[order]
    size = area(box)
    shared = intersection(box[:, None], box[None]) / np.minimum(size[:, None], size[None])
    kept: list[int] = []
    for row in range(len(order)):
        if not kept or shared[row, kept].max() <= SHARED:
            kept.append(row)
    rows = order[kept]
    return NetworkDetections(*(column[rows] for column in found))
