"""Learned model of patches: presence of a person, exact position, and its uncertainty."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.networks.inference import DenseNetwork
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.panorama.figure_patch import PATCH, Map
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaName, PanoramaView

INPUTS = PATCH + 2
_FARTHEST_M = 8.0

MODEL: Final = "places"
FILES: Final[Mapping[PanoramaName, str]] = {"mirror": "places.npz", "all-round": "places-all-round.npz"}
# Outputs of each network, and how many layers it has.
_OUTPUTS: Final = {"presence": (1, 2), "place": (2, 3), "doubt": (2, 2)}


@dataclass(frozen=True, slots=True, eq=False)
class PlaceEstimates:
    """Outputs for N positions.

    Attributes:
        evidence: (N,) log-odds that a person is within reach of the position.
        offset_m: (N, 2) offset of that person: farther away, and to the left [m].
        deviation_m: (N, 2) standard deviations of the offset [m].
    """

    evidence: Map
    offset_m: Map
    deviation_m: Map


@dataclass(frozen=True, slots=True, eq=False)
class PlaceModel:
    """Networks that evaluate patches.

    Attributes:
        presence: log-odds that a person is there.
        place: offset of the person [m].
        doubt: logarithms of the offset's standard deviations [m].
        view: camera of their training images.
        about: description of the training data, for readers of the file.
    """

    presence: DenseNetwork
    place: DenseNetwork
    doubt: DenseNetwork
    view: PanoramaView
    about: Mapping[str, str] = field(default_factory=dict)

    def look(self, patches: Map, distance_m: NDArray[np.float64]) -> PlaceEstimates:
        """Return the outputs for patches (N, PATCH) at distances (N,)."""
        inputs = with_distance(patches, distance_m)
        return PlaceEstimates(
            evidence=self.presence.predict(inputs)[:, 0],
            offset_m=self.place.predict(inputs),
            deviation_m=np.exp(self.doubt.predict(inputs)),
        )

    def save(self, path: Path) -> None:
        """Write the networks."""
        arrays = {
            f"{name}.{number}.{part}": array
            for name in _OUTPUTS
            for number, layer in enumerate(getattr(self, name).layers)
            for part, array in zip(("weights", "bias"), layer, strict=True)
        }
        WeightsArchive(arrays, self.about, asdict(self.view)).save(path)

    @classmethod
    def load(cls, path: Path = SHIPPED / FILES["mirror"]) -> "PlaceModel":
        """Read and validate a model.

        Raises:
            BadInput: the file is missing or is not such a model.
        """
        specs = {name: _specs(name, *sizes) for name, sizes in _OUTPUTS.items()}
        together = {key: spec for each in specs.values() for key, spec in each.items()}
        archive = WeightsArchive.load(path, MODEL, together, PanoramaView.of_plain)
        found = {name: [archive.arrays[key] for key in each] for name, each in specs.items()}
        networks = {
            name: DenseNetwork(list(zip(arrays[::2], arrays[1::2], strict=True)))
            for name, arrays in found.items()
        }
        return cls(**networks, view=archive.camera, about=archive.about)


def _specs(name: str, outputs: int, layers: int) -> dict[str, ArraySpec]:
    """Return the expected shapes of a network's arrays, weights and bias of layer after layer."""
    widths: list[int | str] = [INPUTS, *(f"{name} {number}" for number in range(1, layers)), outputs]
    return {
        f"{name}.{k}.{part}": ArraySpec((widths[k], widths[k + 1])[begin:])
        for k in range(layers)
        for part, begin in (("weights", 0), ("bias", 1))
    }


def with_distance(patches: Map, distance_m: NDArray[np.float64]) -> Map:
    """Append distances (N,), in two forms, to patches (N, PATCH): inputs (N, INPUTS) of the networks."""
    inputs = np.empty((len(patches), INPUTS), np.float32)
    inputs[:, :PATCH] = patches
    inputs[:, PATCH] = 1.0 / distance_m
    inputs[:, PATCH + 1] = np.minimum(distance_m, _FARTHEST_M) / _FARTHEST_M
    return inputs
