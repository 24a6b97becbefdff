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
from peopleboy.tracker.rgbd.verification.windows import SIZES, Features, Range
from peopleboy.tracker.weights_archive import opened_archive

COMMAND: Final = "peopleboy train-windows"
SHIPPED: Final = Path(__file__).parent / "weights" / "windows.npz"
"""The model that comes with the tracker."""

_ABOUT: Final = "about"


def feature_length(kind: Range) -> int:
    """Tell how many numbers describe a window: 36 for each block of 2 x 2 cells of 8 px."""
    width, height = SIZES[kind]
    return (width // 8 - 1) * (height // 8 - 1) * 36


@dataclass(frozen=True, slots=True, eq=False)
class WindowModel:
    """One linear machine for near windows and one for far ones.

    Attributes:
        weights: float32 (features + 1,) by range, the bias last.
        about: what they were learned from, for the reader.
    """

    weights: Mapping[Range, Features]
    about: Mapping[str, str] = field(default_factory=dict)

    def score(self, features: Features, kind: Range) -> float:
        """Rate a window: above 0 for a human, in distances from the margin."""
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
        for kind, found in weights.items():
            _check(found, kind, path)
        return cls(weights, about)


def _check(weights: Features, kind: Range, path: Path) -> None:
    length = feature_length(kind) + 1
    if weights.dtype != np.float32 or weights.shape != (length,) or not np.isfinite(weights).all():
        width, height = SIZES[kind]
        raise BadInput(
            f"{kind}: the machine of a {width} x {height} window has {length} finite float32, "
            f"got {weights.shape} {weights.dtype}; `{COMMAND}` makes one",
            file=str(path),
        )


@lru_cache(maxsize=1)
def shipped_windows() -> WindowModel:
    """Read the model that comes with the tracker."""
    return WindowModel.load(SHIPPED)


def people_detector(near: WindowModel) -> WindowModel:
    """Take OpenCV's people detector for what is far, and a learned one for what is near."""
    far = np.asarray(cv2.HOGDescriptor.getDefaultPeopleDetector(), np.float32)
    return WindowModel({Range.NEAR: near.weights[Range.NEAR], Range.FAR: far})
