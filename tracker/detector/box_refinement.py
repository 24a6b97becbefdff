"""Box refinement: a network that sees 1.6 times as finely corrects the boxes of the final detections."""

from __future__ import annotations

from functools import cache
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.detector.box_regression import OFFSETS, decode_boxes
from peopleboy.tracker.detector.crops import FEATURES, Planes, crop_features, cut_crops, normalise_crops
from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.detector.window import Floats
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.networks.inference import Architecture, CropNetwork, CropSize, NetworkLayer
from peopleboy.tracker.networks.weights_archive import SHIPPED

Grey = NDArray[np.uint8]

_LAYERS: Final = ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96), (3, 2, 128))
SCALES: Final = np.array([0.015, 0.03, 0.05, 0.03])
"""Units of the outputs: offsets as of `encode_boxes`."""
USUAL: Final = np.array([0.0, 0.0, 0.0, 0.22])
"""What outputs of 0 stand for."""

FILE: Final = "box-refinement.npz"


class BoxRefinementNetwork(CropNetwork):
    """Predicts offsets of boxes, and no scores."""

    ARCHITECTURE: ClassVar[Architecture] = Architecture(
        CropSize(96, 72, 1.3), FEATURES - 1, tuple(NetworkLayer(*one) for one in _LAYERS), 160, OFFSETS
    )
    MODEL: ClassVar[str] = "box-refinement"

    def predict(self, planes: Planes, features: Planes, workspace: Workspace | None = None) -> Floats:
        """Return offsets (N, 4) for crops (N, 96, 72, 3) with features (N, 9), the score aside."""
        outputs = self.outputs(planes, features, workspace)
        return np.asarray(outputs.astype(np.float64) * SCALES + USUAL)


def refine_boxes(
    network: BoxRefinementNetwork,
    grey: Grey,
    change: Grey,
    found: Detections,
    mount: Mount | None,
    workspace: Workspace | None = None,
) -> Detections:
    """Refine the boxes of detections in an image (H, W) with the change of its greys (H, W)."""
    if len(found.box) == 0:
        return found
    crops = cut_crops(grey, change, found.box, BoxRefinementNetwork.ARCHITECTURE.crop)
    features = crop_features(found, crops, (grey.shape[0], grey.shape[1]), mount)
    offsets = network.predict(normalise_crops(crops), features, workspace)
    return found._replace(box=decode_boxes(found.box, offsets))


@cache
def shipped_box_refinement() -> BoxRefinementNetwork:
    """Read the network that comes with the tracker."""
    return BoxRefinementNetwork.load(SHIPPED / FILE)
