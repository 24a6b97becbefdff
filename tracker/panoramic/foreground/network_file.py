"""What was learned of people in panoramas, as a file of plain arrays."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.panoramic.foreground.layers import BLOCK, DILATIONS
from peopleboy.tracker.panoramic.foreground.mask_network import (
    INPUTS,
    OUTPUTS,
    TOGETHER,
    MaskNetwork,
)
from peopleboy.tracker.panoramic.panorama_view import PanoramaView
from peopleboy.tracker.weights_archive import NO_ARCHIVE

SHIPPED: Final = Path(__file__).parent / "networks" / "foreground.npz"
"""The network that comes with the tracker."""

_WORDS = "words"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForegroundModel:
    """A network, and the camera whose images it was taught on.

    Attributes:
        network: that tells people from background.
        view: of the camera.
        about: what it was taught on, for the reader of the file.
    """

    network: MaskNetwork
    view: PanoramaView
    about: dict[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the model as NumPy's .npz; its words are JSON in an array of text."""
        words = json.dumps({"about": self.about, "camera": asdict(self.view)})
        arrays: dict[str, Any] = {each.name: getattr(self.network, each.name) for each in fields(MaskNetwork)}
        with path.open("wb") as file:  # by a name alone, NumPy would add its ending
            np.savez(file, **(arrays | {_WORDS: np.array(words)}))

    @classmethod
    def load(cls, path: Path) -> ForegroundModel:
        """Read a model.

        Raises:
            BadInput: the file cannot be read, or is no such model.
        """
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                words = json.loads(str(arrays[_WORDS]))
                weights = {each.name: arrays[each.name] for each in fields(MaskNetwork)}
                view = PanoramaView.of_plain(words["camera"])
                about = {str(key): str(value) for key, value in words["about"].items()}
        except (OSError, AttributeError, *NO_ARCHIVE) as error:
            raise BadInput(f"{path}: is no network for panoramas: {_in_one_line(error)}") from error
        _check_weights(path, weights, view)
        return cls(network=MaskNetwork(**weights), view=view, about=about)


def _check_weights(path: Path, weights: dict[str, NDArray[Any]], view: PanoramaView) -> None:
    """Refuse layers that fit neither each other nor the image, and numbers that are none."""
    units, layers = weights["rows"].shape[-1] if weights["rows"].ndim else 0, len(DILATIONS)
    shapes = {
        "first": (INPUTS, units),
        "rows": (view.height_px // BLOCK, units),
        "between": (layers, 9, units, units),
        "biases": (layers, units),
        "last": (units + INPUTS, OUTPUTS),
        "bias": (OUTPUTS,),
    }
    if units == 0 or units % TOGETHER or view.height_px % BLOCK or view.width_px % BLOCK:
        raise BadInput(f"{path}: is no network for panoramas: {units} units, images of {view.size}")
    for name, shape in shapes.items():
        array = weights[name]
        if array.shape != shape or array.dtype != np.float32 or not np.isfinite(array).all():
            found = f"{array.shape} {array.dtype}"
            raise BadInput(f"{path}: {name} must be {shape} float32 and finite, got {found}")


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
