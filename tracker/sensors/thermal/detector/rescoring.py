"""Second stage of the detector: small networks on crops correct the scores and boxes of detections."""

from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.networks.inference import Architecture, CropNetwork, CropSize, NetworkLayer
from peopleboy.tracker.sensors.detections import Detections, suppress
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, decode_boxes
from peopleboy.tracker.sensors.thermal.detector.crops import (
    FEATURES,
    SCORES,
    Planes,
    crop_features,
    cut_crops,
    normalise_crops,
)
from peopleboy.tracker.sensors.thermal.detector.window import Floats

Grey = NDArray[np.uint8]

_LAYERS: Final = tuple(
    NetworkLayer(*one) for one in ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96))
)

EDGES: Final = 2
"""Numbers that encode the left and right edge of a person: see `encode_edges`."""

# The full correction would be best on rendered images; on images of real cameras the network is
# overconfident, most of all with an unknown mount, as the robot's own camera has a known one.
TRUSTED: Final = 0.5
"""Factor on the network's correction of the log-odds."""
TRUSTED_WITHOUT_MOUNT: Final = 0.3
"""The same for a camera with an unknown mount."""


class RescoringNetwork(CropNetwork):
    """Predicts log-odds and offsets; the weight `line` holds gain and offset of the calibration."""

    ARCHITECTURE: ClassVar[Architecture] = Architecture(
        CropSize(64, 48, 1.4), FEATURES, (*_LAYERS, NetworkLayer(1, 1, 32)), 128, 1 + OFFSETS
    )
    MODEL: ClassVar[str] = "rescoring"
    SCALES: ClassVar[Floats] = np.array([1.0, 0.02, 0.06, 0.08, 0.03])
    """Units of the outputs: log-odds, and offsets as in `encode_boxes`."""
    USUAL: ClassVar[Floats] = np.array([0.0, 0.0, 0.0, 0.0, 0.22])
    """Values at outputs of 0."""

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Return the shapes of all weights."""
        return cls.ARCHITECTURE.shapes() | {"line": (2,)}

    def predict(self, planes: Planes, features: Planes, workspace: Workspace | None = None) -> Floats:
        """Return log-odds and offsets (N, 5) for crops (N, 64, 48, 3) with features (N, 9)."""
        outputs = self.outputs(planes, features, workspace).astype(np.float64)
        outputs[:, 0] += SCORES * features[:, 0]
        gain, offset = self.weights["line"].tolist()
        outputs[:, 0] = gain * outputs[:, 0] + offset
        return np.asarray(outputs * self.SCALES + self.USUAL)


class BoxRefinementNetwork(CropNetwork):
    """Predicts offsets of boxes and the edges of people, without scores, at 1.6 times the resolution."""

    ARCHITECTURE: ClassVar[Architecture] = Architecture(
        CropSize(96, 72, 1.3), FEATURES - 1, (*_LAYERS, NetworkLayer(3, 2, 128)), 160, OFFSETS + EDGES
    )
    MODEL: ClassVar[str] = "box-refinement"
    SCALES: ClassVar[Floats] = np.array([0.015, 0.03, 0.05, 0.03, 0.04, 0.04])
    """Units of the outputs: offsets as in `encode_boxes`, and edges as in `encode_edges`."""
    USUAL: ClassVar[Floats] = np.array([0.0, 0.0, 0.0, 0.22, -0.18, 0.18])
    """Values at outputs of 0."""

    def predict(self, planes: Planes, features: Planes, workspace: Workspace | None = None) -> Floats:
        """Return offsets and edges (N, 6) for crops (N, 96, 72, 3) with features (N, 9) without the score."""
        outputs = self.outputs(planes, features, workspace)
        return np.asarray(outputs.astype(np.float64) * self.SCALES + self.USUAL)


def rescore(
    network: RescoringNetwork,
    grey: Grey,
    change: Grey,
    first: Detections,
    mount: Mount | None,
    least_score: float,
    workspace: Workspace | None = None,
) -> Detections:
    """Rescore the cascade's detections in an image (H, W), given the change of its greys (H, W).

    Boxes are the network's; scores are blended from the network's and the cascade's.
    """
    if len(first.box) == 0:
        return first
    predicted = network.predict(*_inputs(network, grey, change, first, mount), workspace)
    trusted = TRUSTED_WITHOUT_MOUNT if mount is None else TRUSTED
    score = first.score + trusted * (predicted[:, 0] - first.score)
    rescored = Detections.of(decode_boxes(first.box, predicted[:, 1:]), score, first.trees)
    return suppress(rescored.take(score >= least_score))


def refine_boxes(
    network: BoxRefinementNetwork,
    grey: Grey,
    change: Grey,
    found: Detections,
    mount: Mount | None,
    workspace: Workspace | None = None,
) -> Detections:
    """Refine the boxes of detections in an image (H, W), given the change of its greys (H, W)."""
    if len(found.box) == 0:
        return found
    predicted = network.predict(*_inputs(network, grey, change, found, mount), workspace)
    offsets, edges = predicted[:, :OFFSETS], predicted[:, OFFSETS:]
    # Edges are relative to the given boxes, and become relative to the refined ones.
    scale = np.exp(offsets[:, [2]])
    return found._replace(box=decode_boxes(found.box, offsets), edges=(edges - offsets[:, [0]]) / scale)


def encode_edges(window: Floats, whole: Floats) -> Floats:
    """Return left and right edges (N, 2) of boxes (N, 4), from the middles of windows (N, 4), in heights."""
    left = whole[:, 0] - window[:, 0] - window[:, 2] / 2.0
    return np.stack([left, left + whole[:, 2]], axis=1) / window[:, [3]]


def _inputs(
    network: CropNetwork, grey: Grey, change: Grey, found: Detections, mount: Mount | None
) -> tuple[Planes, Planes]:
    """Return normalised crops and features of detections."""
    crops = cut_crops(grey, change, found.box, network.ARCHITECTURE.crop)
    return normalise_crops(crops), crop_features(found, crops, (grey.shape[0], grey.shape[1]), mount)
