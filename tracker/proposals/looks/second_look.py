"""A second look at what trees propose: a small network tells whether somebody is there, and where."""

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
    SCORES,
    CropSize,
    Planes,
    crops_of,
    numbers_of,
    planes_of,
)
from peopleboy.tracker.proposals.looks.network import CropNetwork, Form, Layer
from peopleboy.tracker.proposals.placing import OFFSETS, moved
from peopleboy.tracker.proposals.suppression import Proposals, suppress
from peopleboy.tracker.proposals.window import Floats

Grey = NDArray[np.uint8]

_LAYERS: Final = ((5, 2, 24), (3, 2, 48), (3, 1, 64), (3, 2, 96), (3, 1, 96), (1, 1, 32))
SCALES: Final = np.array([1.0, 0.02, 0.06, 0.08, 0.03])
"""What a unit of each that is told means: log odds, and `placing.offsets`."""
USUAL: Final = np.array([0.0, 0.0, 0.0, 0.0, 0.22])
"""What is told by a network that knows nothing."""

NETWORK: Final = Path(__file__).parent / "weights" / "second_look.npz"
"""The network that comes with the tracker."""

BELIEVED: Final = 0.5
"""Share of what the second look adds to the log odds of the first that is believed.

In rendered images all of it would be right; in those of real cameras the network is too sure of itself.
"""
BELIEVED_OF_STRANGERS: Final = 0.3
"""The same of a camera whose mount is not known, which is no robot's own."""


class SecondLook(CropNetwork):
    """Tells whether somebody is there; its weight `line` is gain and offset that make scores log odds."""

    FORM: ClassVar[Form] = Form(
        CropSize(64, 48, 1.4), NUMBERS, tuple(Layer(*one) for one in _LAYERS), 128, 1 + OFFSETS
    )
    COMMAND: ClassVar[str] = "peopleboy train-detector --second-look"

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Give the shapes of all weights."""
        return cls.FORM.shapes() | {"line": (2,)}

    def told(self, planes: Planes, numbers: Planes, desk: Desk | None = None) -> Floats:
        """Tell of crops (N, 64, 48, 3) with numbers (N, 9) log odds and offsets (N, 5).

        Log odds are those of the first look and what is added to them.
        """
        last = self.last(planes, numbers, desk).astype(np.float64)
        last[:, 0] += SCORES * numbers[:, 0]
        gain, offset = self.weights["line"].tolist()
        last[:, 0] = gain * last[:, 0] + offset
        return np.asarray(last * SCALES + USUAL)


def look_again(
    network: SecondLook,
    grey: Grey,
    change: Grey,
    first: Proposals,
    mount: Mount | None,
    least_score: float,
    desk: Desk | None = None,
) -> Proposals:
    """Look again at what was proposed in an image of which it is known by how much (H, W) greys changed.

    Boxes are those of the second look; scores lie between both.
    """
    if len(first.box) == 0:
        return first
    crops = crops_of(grey, change, first.box, SecondLook.FORM.crop)
    numbers = numbers_of(first, crops, (grey.shape[0], grey.shape[1]), mount)
    told = network.told(planes_of(crops), numbers, desk)
    believed = BELIEVED_OF_STRANGERS if mount is None else BELIEVED
    score = first.score + believed * (told[:, 0] - first.score)
    again = Proposals(moved(first.box, told[:, 1:]), score, first.trees)
    return suppress(again.taken(score >= least_score))


@cache
def shipped_network() -> SecondLook:
    """Read the network that comes with the tracker."""
    return SecondLook.load(NETWORK)
