"""A closer look at who was found: a network that sees 1.6 times as finely tells where exactly somebody is."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.proposals.looks.convolution import Desk
from peopleboy.tracker.proposals.looks.crops import (
    NUMBERS,
    CropSize,
    Planes,
    crops_of,
    numbers_of,
    planes_of,
)
from peopleboy.tracker.proposals.looks.network import CropNetwork, Form, Layer
from peopleboy.tracker.proposals.placing import OFFSETS, moved
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.proposals.window import Floats

Grey = NDArray[np.uint8]

_LAYERS: Final = ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96), (3, 2, 128))
SCALES: Final = np.array([0.015, 0.03, 0.05, 0.03])
"""What a unit of each of the `placing.offsets` means that are told."""
USUAL: Final = np.array([0.0, 0.0, 0.0, 0.22])
"""What is told by a network that knows nothing."""

NETWORK: Final = Path(__file__).parent / "weights" / "closer_look.npz"
"""The network that comes with the tracker."""


class CloserLook(CropNetwork):
    """Tells where exactly somebody is; whether anybody is, it does not say."""

    FORM: ClassVar[Form] = Form(
        CropSize(96, 72, 1.3), NUMBERS - 1, tuple(Layer(*one) for one in _LAYERS), 160, OFFSETS
    )
    COMMAND: ClassVar[str] = "peopleboy train-detector --closer-look"

    def told(self, planes: Planes, numbers: Planes, desk: Desk | None = None) -> Floats:
        """Tell offsets (N, 4) of crops (N, 96, 72, 3) with numbers (N, 9), the score aside."""
        return np.asarray(self.last(planes, numbers[:, 1:], desk).astype(np.float64) * SCALES + USUAL)


def look_closer(
    network: CloserLook,
    grey: Grey,
    change: Grey,
    found: Proposals,
    mount: Mount | None,
    desk: Desk | None = None,
) -> Proposals:
    """Place those who were found in an image of which it is known by how much (H, W) greys changed."""
    if len(found.box) == 0:
        return found
    crops = crops_of(grey, change, found.box, CloserLook.FORM.crop)
    numbers = numbers_of(found, crops, (grey.shape[0], grey.shape[1]), mount)
    return found._replace(box=moved(found.box, network.told(planes_of(crops), numbers, desk)))


@cache
def shipped_closer_look() -> CloserLook:
    """Read the network that comes with the tracker."""
    return CloserLook.load(NETWORK)
