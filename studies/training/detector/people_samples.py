"""Training samples of the network that detects people: augmented images, and targets for each of its maps."""

import math
from collections.abc import Sequence
from multiprocessing.shared_memory import SharedMemory
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import Posture
from peopleboy.studies.training.detector.augmentation import augment, cut_off
from peopleboy.studies.training.detector.clutter import clutter, overlay
from peopleboy.studies.training.detector.electronics import simulate_electronics
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.sensors.thermal.detector.people_network import (
    BOX,
    HEIGHTS,
    PLANES,
    SHIFT,
    STRIDES,
    USUAL,
    input_planes,
)
from peopleboy.tracker.track import TrackPosture

Floats = NDArray[np.float32]
Halves = NDArray[np.float16]
Boxes = NDArray[np.float64]
Grey = NDArray[np.uint8]
Draw = np.random.Generator
Batch = tuple[Halves, dict[int, Halves]]
Targets = dict[int, Floats]
"""Targets (H', W', 10) by stride: the score, its weight, the weight of the box, its six numbers, posture."""

CANVAS: Final = (192, 256)
"""Rows and columns of the training images."""

_CLASSES: Final = {
    Posture.SITTING: TrackPosture.SITTING,
    Posture.BENDING: TrackPosture.BENDING,
    Posture.CROUCHING: TrackPosture.CROUCHING,
    Posture.KNEELING: TrackPosture.CROUCHING,
    Posture.LYING: TrackPosture.LYING,
    Posture.FALLEN: TrackPosture.LYING,
}
POSTURE_OF: Final = np.array(
    [list(TrackPosture).index(_CLASSES.get(posture, TrackPosture.UPRIGHT)) for posture in Posture]
)
"""(10,) number of the recognised posture for each posture of a simulated person."""

_STILL: Final = 0.3  # share of images without change
_SHAKEN: Final = 0.25  # share of images whose change contains that of a camera motion
_MOST_SHIFT_PX: Final = 7.0
_SHIFT_DOWN_PX: Final = 1.2  # standard deviation
_MOUNT_KNOWN: Final = 0.5
_AS_RENDERED: Final = 0.2
_CUT: Final = 0.15
_SCALES: Final = (0.55, 1.35)
_LEAST_SIDE_PX: Final = 32
_AT_PEOPLE: Final = 0.7  # share of parts that contain a person's middle
_LEAST_SPREAD: Final = 2.5  # [grey] standard deviation, in the box of a person who can be seen
_WITHIN: Final = (0.2, 0.8)  # where on the canvas, in shares of its sides


class SharedBatch(NamedTuple):
    """A batch of N samples in shared memory: copying it through a pipe takes longer than to train on it.

    Attributes:
        name: of the shared memory.
        samples: N.
    """

    name: str
    samples: int

    def take(self) -> Batch:
        """Copy the batch, and free the shared memory."""
        memory = SharedMemory(self.name)
        planes, targets = _arrays_in(memory, self.samples)
        copied = planes.copy(), {stride: target.copy() for stride, target in targets.items()}
        del planes, targets
        memory.close()
        memory.unlink()
        return copied


def batch_of(images: Sequence[ThermalImage], seed: int) -> SharedBatch:
    """Return a sample of each of N images: inputs (N, 192, 256, 5), and targets (N, H', W', 10) by stride."""
    rng = np.random.default_rng(seed)
    cv2.setNumThreads(1)  # there are as many processes as cores
    memory = SharedMemory(create=True, size=len(images) * _SAMPLE_BYTES)
    planes, targets = _arrays_in(memory, len(images))
    for number, image in enumerate(images):
        planes[number], own = sample_of(image, rng)
        for stride in STRIDES:
            targets[stride][number] = own[stride]
    del planes, targets
    memory.close()
    return SharedBatch(memory.name, len(images))


_PLANES: Final = (*CANVAS, PLANES)
_TARGETS: Final = {stride: (CANVAS[0] // stride, CANVAS[1] // stride, 4 + BOX) for stride in STRIDES}
_SAMPLE_BYTES: Final = 2 * sum(map(math.prod, (_PLANES, *_TARGETS.values())))


def _arrays_in(memory: SharedMemory, count: int) -> Batch:
    """Return the inputs, and the targets by stride, that lie one after the other in shared memory."""
    planes = np.ndarray((count, *_PLANES), np.float16, memory.buf)
    targets, offset = {}, planes.nbytes
    for stride, shape in _TARGETS.items():
        targets[stride] = np.ndarray((count, *shape), np.float16, memory.buf, offset)
        offset += targets[stride].nbytes
    return planes, targets


def sample_of(image: ThermalImage, rng: Draw) -> tuple[Floats, Targets]:
    """Augment an image, and return the network's input (192, 256, 5) and its targets."""
    if rng.random() >= _AS_RENDERED:
        image = overlay(simulate_electronics(augment(clutter(image, rng), rng), rng), rng)
    if rng.random() < _CUT:
        image = cut_off(image, rng)
    grey, change, corner, scale = _part(image, rng)
    change = _other_change(grey, change, rng)
    mount = _mount_of_part(image.mount, corner[1], scale) if rng.random() < _MOUNT_KNOWN else None
    rows, columns = grey.shape
    top, left = (int(rng.integers(0, CANVAS[k] - grey.shape[k] + 1)) for k in (0, 1))
    planes = np.zeros((*CANVAS, PLANES), np.float32)
    planes[top : top + rows, left : left + columns] = input_planes(grey, change, mount)
    shift = np.array([left - corner[0], top - corner[1]])
    box, whole = (_moved(one, scale, shift) for one in (image.box, image.whole))
    shown = np.array([left - 0.5, top - 0.5, left + columns - 0.5, top + rows - 0.5])
    visible = np.where(_stands_out(grey, _moved(image.whole, scale, -np.array(corner))), image.visible, 0.0)
    people = _People(box, whole, visible, POSTURE_OF[image.posture], shown)
    return planes, {stride: people.target(stride) for stride in STRIDES}


def _part(image: ThermalImage, rng: Draw) -> tuple[Grey, Grey, tuple[int, int], float]:
    """Scale an image, and cut a part that fits on the canvas: grey, change, its corner, and the scale."""
    rows, columns = image.grey.shape
    scale = math.exp(rng.uniform(*np.log(_SCALES)))
    size = (max(round(columns * scale), _LEAST_SIDE_PX), max(round(rows * scale), _LEAST_SIDE_PX))
    way = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
    grey, change = (
        np.asarray(cv2.resize(one, size, interpolation=way), np.uint8) for one in (image.grey, image.change)
    )
    over = [max(size[0] - CANVAS[1], 0), max(size[1] - CANVAS[0], 0)]
    u, v = (int(rng.integers(0, one + 1)) for one in over)
    if any(over) and len(image.box) and rng.random() < _AT_PEOPLE:
        left, top, width, height = (scale * image.box[int(rng.integers(len(image.box)))]).tolist()
        u = int(np.clip(left + width / 2.0 - rng.uniform(*_WITHIN) * CANVAS[1], 0, over[0]))
        v = int(np.clip(top + height / 2.0 - rng.uniform(*_WITHIN) * CANVAS[0], 0, over[1]))
    rows_of_part, columns_of_part = slice(v, v + CANVAS[0]), slice(u, u + CANVAS[1])
    return grey[rows_of_part, columns_of_part], change[rows_of_part, columns_of_part], (u, v), scale


def _stands_out(grey: Grey, whole: Boxes) -> NDArray[np.bool_]:
    """Return whether anything is to be seen in the box of each silhouette."""
    low = np.clip(np.floor(whole[:, :2]), 0, None).astype(np.int64)
    high = np.ceil(whole[:, :2] + whole[:, 2:]).astype(np.int64) + 1
    spreads = [
        float(here.std()) if (here := grey[top:bottom, left:right]).size else 0.0
        for (left, top), (right, bottom) in zip(low.tolist(), np.maximum(high, low).tolist(), strict=True)
    ]
    return np.array(spreads) >= _LEAST_SPREAD


def _mount_of_part(mount: Mount, top: int, scale: float) -> Mount:
    return Mount((mount.horizon_px + 0.5) * scale - 0.5 - top, mount.focal_px * scale, mount.height_m)


def _moved(box: Boxes, scale: float, shift: NDArray[np.int64]) -> Boxes:
    corner = (box[:, :2] + 0.5) * scale - 0.5 + shift
    return np.concatenate([corner, box[:, 2:] * scale], axis=1)


def _other_change(grey: Grey, change: Grey, rng: Draw) -> Grey:
    """Remove the change, or add that of a camera motion which is not compensated."""
    where = rng.random()
    if where < _STILL:
        return np.zeros_like(change)
    if where > _STILL + _SHAKEN:
        return change
    right, down = rng.uniform(-_MOST_SHIFT_PX, _MOST_SHIFT_PX), rng.normal(0.0, _SHIFT_DOWN_PX)
    moved = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])
    size = (grey.shape[1], grey.shape[0])
    other = cv2.warpAffine(grey, moved, size, borderMode=cv2.BORDER_REPLICATE)
    return np.maximum(change, np.asarray(cv2.absdiff(grey, other), np.uint8))


_SPANS: Final = {4: (16.0, 60.0), 8: (44.0, 120.0), 16: (88.0, 240.0), 32: (176.0, math.inf)}
"""Sizes [px] of the people of each map."""
_LENGTH: Final = 0.75  # size of a person in widths of the silhouette, if that is more than the height
_LEAST_PX: Final = 20.0
_LEAST_VISIBLE: Final = 0.4
_LEAST_INSIDE: Final = 0.22  # share of the box
_LEAST_WIDE: Final = 0.3  # share of its width
_SPREAD: Final = (0.1, 0.08)  # standard deviations of the score around a person's middle, in sides of the box
_SHARPEST: Final = 0.3  # the least of them, in strides
_REGRESSED: Final = 0.6  # score from which on the box is trained
_THINNEST: Final = 0.04  # least distance of the silhouette's sides from the middle, in heights


class _People:
    """The P people of a sample."""

    def __init__(
        self, box: Boxes, whole: Boxes, visible: Boxes, posture: NDArray[np.int64], shown: Boxes
    ) -> None:
        """Note which people count.

        Args:
            box: (P, 4) [px] from head to feet, as wide as the torso.
            whole: (P, 4) [px] of the silhouettes.
            visible: (P,) visible share of the part inside the image.
            posture: (P,) numbers of the postures.
            shown: (4,) [px] left, top, right and bottom edge of the image on the canvas.
        """
        self._box, self._whole, self._posture = box, whole, posture
        low = np.maximum(box[:, :2], shown[:2])
        high = np.minimum(box[:, :2] + box[:, 2:], shown[2:])
        self._low, self._high = low, high
        self._is_shown = (high > low).all(axis=1)
        share = np.maximum(high - low, 0.0) / np.maximum(box[:, 2:], 1e-6)
        self._size = np.maximum(box[:, 3], _LENGTH * whole[:, 2])
        self._counts = (
            (share.prod(axis=1) >= _LEAST_INSIDE)
            & (share[:, 0] >= _LEAST_WIDE)
            & (visible >= _LEAST_VISIBLE)
            & (self._size >= _LEAST_PX)
        )

    def target(self, stride: int) -> Floats:
        """Return the target of a map; where people overlap, that of the nearest middle."""
        rows, columns = CANVAS[0] // stride, CANVAS[1] // stride
        target = np.zeros((rows, columns, 4 + BOX), np.float32)
        target[..., 1] = 1.0
        u, v = (stride * (np.arange(count, dtype=np.float64) + 0.5) - 0.5 for count in (columns, rows))
        least, most = _SPANS[stride]
        for one in np.flatnonzero(self._is_shown).tolist():
            if not self._counts[one]:
                low, high = self._low[one], self._high[one]
                across, down = (u >= low[0]) & (u <= high[0]), (v >= low[1]) & (v <= high[1])
                target[..., 1] *= 1.0 - (down[:, None] & across[None])
            elif least <= self._size[one] < most:
                self._add(target, one, u, v, stride)
        return target

    def _add(self, target: Floats, one: int, u: Boxes, v: Boxes, stride: int) -> None:
        """Add a person to a target."""
        low, high = self._low[one], self._high[one]
        middle = (low + high) / 2.0
        spread = np.maximum(_SPREAD * (high - low), _SHARPEST * stride)
        off = ((u - middle[0]) / spread[0])[None] ** 2 + ((v - middle[1]) / spread[1])[:, None] ** 2
        score = np.exp(-0.5 * off)
        score[np.unravel_index(off.argmin(), off.shape)] = 1.0
        i, j = np.nonzero(score > np.maximum(target[..., 2], _REGRESSED))
        np.maximum(target[..., 0], score, out=target[..., 0])
        target[i, j, 2] = score[i, j]
        x, y, width, height = self._box[one].tolist()
        left, _, wide, _ = self._whole[one].tolist()
        centre, unit = x + width / 2.0, HEIGHTS * stride
        target[i, j, 3] = (centre - u[j]) / (SHIFT * unit)
        target[i, j, 4] = (y + height / 2.0 - v[i]) / (SHIFT * unit)
        target[i, j, 5] = math.log(height / unit)
        for k, side in enumerate((width, centre - left, left + wide - centre)):
            target[i, j, 6 + k] = math.log(max(side / height, _THINNEST)) - USUAL[3 + k]
        target[i, j, 9] = self._posture[one]
