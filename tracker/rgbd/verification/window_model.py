"""Linear support vector machines that tell humans by their windows, and their file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.rgbd.depth_view import Depth
from peopleboy.tracker.rgbd.verification.windows import (
    SIZES,
    Features,
    Image,
    Range,
    depth_features,
    features,
)
from peopleboy.tracker.track import Box
from peopleboy.tracker.weights_archive import opened_archive

COMMAND: Final = "peopleboy train-windows"
WEIGHTS: Final = Path(__file__).parent / "weights"
"""Where the models are that come with the tracker."""

_ABOUT: Final = "about"


def file_name(*, sees_depth: bool) -> str:
    """Name the file of a model."""
    return "colour_and_depth.npz" if sees_depth else "colour.npz"


def feature_length(kind: Range) -> int:
    """Tell how many numbers describe a window of one image: 36 for each block of 2 x 2 cells of 8 px."""
    width, height = SIZES[kind]
    return (width // 8 - 1) * (height // 8 - 1) * 36


@dataclass(frozen=True, slots=True, eq=False)
class WindowModel:
    """One linear machine for near windows and one for far ones.

    Attributes:
        weights: float32 (features + 1,) by range, the bias last; the features are those of colour, or of
            colour and then of depth.
        about: what they were learned from, for the reader.
    """

    weights: Mapping[Range, Features]
    about: Mapping[str, str] = field(default_factory=dict)

    @property
    def sees_depth(self) -> bool:
        """Whether it looks at depth, too."""
        return len(self.weights[Range.NEAR]) > feature_length(Range.NEAR) + 1

    def look(self, colour: Image, depth: Depth, z_m: float, window: Box, kind: Range) -> float:
        """Rate a window of an image: above 0 for a human.

        Args:
            colour: (H, W, 3) RGB.
            depth: (H, W) [mm] of the same pixels.
            z_m: depth of what the window is about [m].
            window: [px].
            kind: of window.
        """
        seen = features(colour, window, kind)
        if self.sees_depth:
            seen = np.concatenate([seen, depth_features(depth, z_m, window, kind)])
        return self.score(seen, kind)

    def score(self, features: Features, kind: Range) -> float:
        """Rate the features of a window: above 0 for a human, in distances from the margin."""
        weights = self.weights[kind]
        return float(features @ weights[:-1] + weights[-1])

    def save(self, path: Path) -> None:
        """Write a NumPy archive without pickles."""
        content: dict[str, Any] = {str(kind): weights for kind, weights in self.weights.items()}
        content[_ABOUT] = np.array(json.dumps(dict(self.about)))
        with path.open("wb") as file:
            np.savez_compressed(file, **content)

    @classmethod
    def load(cls, path: Path) -> WindowModel:
        """Read a model.

        Raises:
            BadInput: a file that is missing, is none, or holds machines for other windows.
        """
        with opened_archive(path, COMMAND) as archive:
            about = json.loads(str(archive[_ABOUT]))
            weights = {kind: np.asarray(archive[str(kind)]) for kind in Range}
        model = cls(weights, about)
        for kind, found in weights.items():
            _check(found, kind, path, images=1 + model.sees_depth)
        return model


def _check(weights: Features, kind: Range, path: Path, *, images: int) -> None:
    count, (width, height) = feature_length(kind), SIZES[kind]
    shape = (images * count + 1,)
    if weights.dtype != np.float32 or weights.shape != shape or not np.isfinite(weights).all():
        raise BadInput(
            f"{kind}: the machine of a {width} x {height} window has {count + 1} finite float32, or "
            f"{2 * count + 1} with depth, got {weights.shape} {weights.dtype}; `{COMMAND}` makes one",
            file=str(path),
        )


@lru_cache(maxsize=2)
def shipped_windows(*, sees_depth: bool) -> WindowModel:
    """Read the model that comes with the tracker, for colour alone or with depth."""
    return WindowModel.load(WEIGHTS / file_name(sees_depth=sees_depth))


def people_detector() -> WindowModel:
    """Take OpenCV's people detector for what is far, and the shipped one of colour for what is near."""
    far = np.asarray(cv2.HOGDescriptor.getDefaultPeopleDetector(), np.float32)
    near = shipped_windows(sees_depth=False).weights[Range.NEAR]
    return WindowModel({Range.NEAR: near, Range.FAR: far})
