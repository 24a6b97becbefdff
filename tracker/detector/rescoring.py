"""Rescoring: a small network on crops corrects the scores and the boxes of the cascade's detections."""

from __future__ import annotations

from functools import cache
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.detector.box_regression import OFFSETS, decode_boxes
from peopleboy.tracker.detector.crops import (
    FEATURES,
    SCORES,
    Planes,
    crop_features,
    cut_crops,
    normalise_crops,
)
from peopleboy.tracker.detector.detections import Detections, suppress
from peopleboy.tracker.detector.window import Floats
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.networks.inference import Architecture, CropNetwork, CropSize, NetworkLayer
from peopleboy.tracker.networks.weights_archive import SHIPPED

Grey = NDArray[np.uint8]

_LAYERS: Final = ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96), (1, 1, 32))
SCALES: Final = np.array([1.0, 0.02, 0.06, 0.08, 0.03])
"""Units of the outputs: log odds, and offsets as of `encode_boxes`."""
USUAL: Final = np.array([0.0, 0.0, 0.0, 0.0, 0.22])
"""What outputs of 0 stand for."""

FILE: Final = "rescoring.npz"

# In rendered images all of the correction would be right; on images of real cameras the network is too sure
# of itself, and most so where the mount is not known, which is no robot's own camera.
TRUSTED: Final = 0.5
"""Share of the network's correction of the log odds that is applied."""
TRUSTED_WITHOUT_MOUNT: Final = 0.3
"""The same for a camera whose mount is not known."""


class RescoringNetwork(CropNetwork):
    """Predicts log odds and offsets; its weight `line` is gain and offset that calibrate the log odds."""

    ARCHITECTURE: ClassVar[Architecture] = Architecture(
        CropSize(64, 48, 1.4), FEATURES, tuple(NetworkLayer(*one) for one in _LAYERS), 128, 1 + OFFSETS
    )
    MODEL: ClassVar[str] = "rescoring"

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Return the shapes of all weights."""
        return cls.ARCHITECTURE.shapes() | {"line": (2,)}

    def predict(self, planes: Planes, features: Planes, workspace: Workspace | None = None) -> Floats:
        """Return log odds and offsets (N, 5) for crops (N, 64, 48, 3) with features (N, 9)."""
        outputs = self.outputs(planes, features, workspace).astype(np.float64)
        outputs[:, 0] += SCORES * features[:, 0]
        gain, offset = self.weights["line"].tolist()
        outputs[:, 0] = gain * outputs[:, 0] + offset
        return np.asarray(outputs * SCALES + USUAL)


def rescore(
    network: RescoringNetwork,
    grey: Grey,
    change: Grey,
    first: Detections,
    mount: Mount | None,
    least_score: float,
    workspace: Workspace | None = None,
) -> Detections:
    """Rescore the cascade's detections in an image (H, W) with the change of its greys (H, W).

    Boxes are the network's; scores lie between the network's and the cascade's.
    """
    if len(first.box) == 0:
        return first
    crops = cut_crops(grey, change, first.box, RescoringNetwork.ARCHITECTURE.crop)
    features = crop_features(first, crops, (grey.shape[0], grey.shape[1]), mount)
    predicted = network.predict(normalise_crops(crops), features, workspace)
    trusted = TRUSTED_WITHOUT_MOUNT if mount is None else TRUSTED
    score = first.score + trusted * (predicted[:, 0] - first.score)
    rescored = Detections(decode_boxes(first.box, predicted[:, 1:]), score, first.trees)
    return suppress(rescored.take(score >= least_score))


@cache
def shipped_rescoring() -> RescoringNetwork:
    """Read the network that comes with the tracker."""
    return RescoringNetwork.load(SHIPPED / FILE)
