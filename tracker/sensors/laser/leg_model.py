"""Learned model of people in a laser scan: networks for beams, offsets, and groups of votes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.tracker.networks.inference import DenseNetwork, one_thread
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.laser.beam_votes import FEATURES, Votes, group_votes, vote_places
from peopleboy.tracker.sensors.laser.scan_windows import SIZE, Floats, cut_windows

MODEL: Final = "legs"
FILE: Final = "legs.npz"

_NETWORKS: Final = {"beam": (SIZE, 1, 3), "offset": (SIZE, 2, 3), "person": (FEATURES, 1, 2)}
"""Inputs, outputs and number of layers of each network."""

LEAST_VOTE: Final = -2.5
"""Log-odds from which a beam votes."""


class LegDetections(NamedTuple):
    """M people in a scan.

    Attributes:
        places_m: (M, 2) forward and left in the robot's frame.
        scores: (M,) log-odds.
    """

    places_m: Floats
    scores: Floats


@dataclass(frozen=True, slots=True, eq=False)
class LegModel:
    """Networks that detect people in scans.

    Attributes:
        beam: log-odds that a beam hits a person.
        offset: of that person's middle from the hit point, along the beam and to the left [m].
        person: log-odds of a group of votes.
        about: description of the training data, for readers of the file.
    """

    beam: DenseNetwork
    offset: DenseNetwork
    person: DenseNetwork
    about: Mapping[str, str] = field(default_factory=dict)

    def detect(self, ranges: NDArray[np.uint16], calibration: ScanCalibration) -> LegDetections:
        """Detect people in a scan (N,) [mm], from left to right; 0 for no reading."""
        with one_thread():
            groups = group_votes(self.vote(ranges, calibration), calibration)
            scores = self.person.predict(groups.features)[:, 0]
        return LegDetections(groups.places_m, scores.astype(np.float64))

    def vote(self, ranges: NDArray[np.uint16], calibration: ScanCalibration) -> Votes:
        """Return the votes of the beams that may hit a person."""
        beams, inputs = cut_windows(ranges, calibration)
        scores = self.beam.predict(inputs)[:, 0].astype(np.float64)
        is_vote = scores > LEAST_VOTE
        beams, metres = beams[is_vote], ranges[beams[is_vote]] / 1000.0
        offsets = self.offset.predict(inputs[is_vote]).astype(np.float64)
        return Votes(vote_places(beams, metres, offsets, calibration), scores[is_vote], metres)

    def save(self, path: Path) -> None:
        """Write the networks; weights are rounded to 11 bits, which halves the file."""
        arrays = {
            f"{name}.{number}.{part}": array.astype(np.float16)
            for name in _NETWORKS
            for number, layer in enumerate(getattr(self, name).layers)
            for part, array in zip(("weights", "bias"), layer, strict=True)
        }
        WeightsArchive(arrays, self.about).save(path)

    @classmethod
    def load(cls, path: Path = SHIPPED / FILE) -> "LegModel":
        """Read and validate a model.

        Raises:
            BadInput: the file is missing or is not such a model.
        """
        specs = {name: _specs(name, *sizes) for name, sizes in _NETWORKS.items()}
        together = {key: spec for each in specs.values() for key, spec in each.items()}
        archive = WeightsArchive.load(path, MODEL, together)
        found = {
            name: [archive.arrays[key].astype(np.float32) for key in each] for name, each in specs.items()
        }
        networks = {
            name: DenseNetwork(list(zip(arrays[::2], arrays[1::2], strict=True)))
            for name, arrays in found.items()
        }
        return cls(**networks, about=archive.about)


def _specs(name: str, inputs: int, outputs: int, layers: int) -> dict[str, ArraySpec]:
    """Return the expected shapes of a network's arrays, weights and bias of layer after layer."""
    widths: list[int | str] = [inputs, *(f"{name} {number}" for number in range(1, layers)), outputs]
    return {
        f"{name}.{k}.{part}": ArraySpec((widths[k], widths[k + 1])[begin:], np.float16)
        for k in range(layers)
        for part, begin in (("weights", 0), ("bias", 1))
    }
