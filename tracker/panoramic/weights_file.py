"""Learned weights as a file: named arrays, the camera that they hold for, and what they were learned from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.panoramic.panorama_view import PanoramaView
from peopleboy.tracker.weights_archive import opened_archive

VIEW: Final = "camera"
ABOUT: Final = "about"


@dataclass(frozen=True, slots=True, eq=False)
class Weights:
    """What was learned.

    Attributes:
        arrays: float32, by name.
        view: of the camera whose images it was learned from.
        about: from what and how, for the reader.
    """

    arrays: Mapping[str, NDArray[np.float32]]
    view: PanoramaView
    about: Mapping[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write a NumPy archive without pickles."""
        texts = {VIEW: json.dumps(asdict(self.view)), ABOUT: json.dumps(dict(self.about))}
        content: dict[str, Any] = {name: np.array(text) for name, text in texts.items()}
        content |= {name: array.astype(np.float32) for name, array in self.arrays.items()}
        with path.open("wb") as file:
            np.savez_compressed(file, **content)

    @classmethod
    def load(cls, path: Path, command: str) -> Weights:
        """Read an archive, which the command of that name makes.

        Raises:
            BadInput: a file that is missing, or is none, or holds what is no finite float32.
        """
        with opened_archive(path, command) as archive:
            found = {name: archive[name] for name in archive}
            view = PanoramaView.of_plain(json.loads(str(found.pop(VIEW))))
            about = json.loads(str(found.pop(ABOUT)))
        for name, array in found.items():
            if array.dtype != np.float32 or not np.isfinite(array).all():
                raise BadInput(f"{name} must be finite float32, got {array.dtype}", file=str(path))
        return cls(found, view, about)
