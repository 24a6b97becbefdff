"""Linear support vector machines that classify windows as human, and their file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.depth.depth_view import Depth, Image
from peopleboy.tracker.sensors.depth.human_windows import (
    SIZES,
    Features,
    WindowRange,
    depth_features,
    features,
    hog_descriptor,
)
from peopleboy.tracker.track import Box

MODEL: Final = "windows"


def file_name(*, sees_depth: bool) -> str:
    """Return the file name of a model."""
    return "windows-colour-and-depth.npz" if sees_depth else "windows-colour.npz"


def feature_length(kind: WindowRange) -> int:
    """Return the number of features of a window of one image: 36 for each block of 2 x 2 cells of 8 px."""
    width, height = SIZES[kind]
    return (width // 8 - 1) * (height // 8 - 1) * 36


@dataclass(frozen=True, slots=True, eq=False)
class WindowModel:
    """One linear classifier for near windows and one for far ones.

    Attributes:
        weights: float32 (features + 1,) by range, the bias last; the features are those of colour, or of
            colour followed by depth.
        about: description of the training data, for readers of the file.
    """

    weights: Mapping[WindowRange, Features]
    about: Mapping[str, str] = field(default_factory=dict)

    @property
    def sees_depth(self) -> bool:
        """Whether it uses depth, too."""
        return len(self.weights[WindowRange.NEAR]) > feature_length(WindowRange.NEAR) + 1

    def look(self, colour: Image, depth: Depth, z_m: float, window: Box, kind: WindowRange) -> float:
        """Return the score of a window of an image: above 0 for a human.

        Args:
            colour: (H, W, 3) RGB.
            depth: (H, W) [mm] of the same pixels.
            z_m: depth of the window's object [m].
            window: [px].
            kind: of window.
        """
        seen = features(colour, window, kind)
        if self.sees_depth:
            seen = np.concatenate([seen, depth_features(depth, z_m, window, kind)])
        return self.score(seen, kind)

    def score(self, features: Features, kind: WindowRange) -> float:
        """Return the score of a window's features: above 0 for a human, in distances from the margin."""
        weights = self.weights[kind]
        return float(features @ weights[:-1] + weights[-1])

    def save(self, path: Path) -> None:
        """Write the machines."""
        WeightsArchive({str(kind): weights for kind, weights in self.weights.items()}, self.about).save(path)

    @classmethod
    def load(cls, path: Path, *, sees_depth: bool) -> "WindowModel":
        """Read a model for colour alone, or for colour and depth.

        Raises:
            BadInput: the file is missing, invalid, or holds a model for other windows.
        """
        images = 1 + sees_depth
        specs = {str(kind): ArraySpec((images * feature_length(kind) + 1,)) for kind in WindowRange}
        archive = WeightsArchive.load(path, MODEL, specs)
        return cls({kind: archive.arrays[str(kind)] for kind in WindowRange}, archive.about)


@lru_cache(maxsize=2)
def shipped_windows(*, sees_depth: bool) -> WindowModel:
    """Read the shipped model, for colour alone or with depth."""
    return WindowModel.load(SHIPPED / file_name(sees_depth=sees_depth), sees_depth=sees_depth)


def people_detector() -> WindowModel:
    """Return OpenCV's people detector for far windows, with the shipped colour model for near ones."""
    far = np.asarray(hog_descriptor(SIZES[WindowRange.FAR]).getDefaultPeopleDetector(), np.float32)
    near = shipped_windows(sees_depth=False).weights[WindowRange.NEAR]
    return WindowModel({WindowRange.NEAR: near, WindowRange.FAR: far})
