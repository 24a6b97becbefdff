"""Learned model of people in a laser scan: each beam votes for a position, and votes become detections."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.tracker.networks.inference import DenseNetwork, one_thread
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.laser.scan_windows import SIZE, Floats, Inputs, cut_windows

MODEL: Final = "legs"
FILE: Final = "legs.npz"

FEATURES: Final = 9
"""Features of a group of votes; see `group_votes`."""
_NETWORKS: Final = {"beam": (SIZE, 1, 3), "offset": (SIZE, 2, 3), "person": (FEATURES, 1, 2)}
"""Inputs, outputs and number of layers of each network."""

LEAST_VOTE: Final = -2.5
"""Log-odds from which a beam votes."""
APART_M: Final = 0.4
"""Votes nearer to each other are of one person."""


class Votes(NamedTuple):
    """Votes of V beams.

    Attributes:
        places_m: (V, 2) forward and left in the robot's frame.
        scores: (V,) log-odds.
        ranges_m: (V,) of the beams.
    """

    places_m: Floats
    scores: Floats
    ranges_m: Floats


class VoteGroups(NamedTuple):
    """Votes of each of M people.

    Attributes:
        places_m: (M, 2) forward and left in the robot's frame.
        features: (M, FEATURES).
    """

    places_m: Floats
    features: Inputs


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


def vote_places(
    beams: NDArray[np.int64], metres: Floats, offsets: Floats, calibration: ScanCalibration
) -> Floats:
    """Return positions (V, 2) in the robot's frame, at offsets (V, 2) from where beams of ranges (V,) end."""
    bearing = calibration.bearings[beams]
    ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    reach = (metres + offsets[:, 0])[:, None] * ahead + offsets[:, 1:] * left
    return np.asarray(calibration.position_m[:2] + reach, np.float64)


def group_votes(votes: Votes, calibration: ScanCalibration) -> VoteGroups:
    """Group votes about the strongest ones, each with all others within `APART_M` that are still free.

    The features of a group are: greatest, mean and summed log-odds and probability of its votes, their
    spread [m], number, width of the beams [m], and range [10 m].
    """
    order = np.argsort(-votes.scores, kind="stable")
    places, features = np.empty((len(order), 2)), np.empty((len(order), FEATURES), np.float32)
    count = _group(
        votes.places_m[order], votes.scores[order], votes.ranges_m[order], calibration.step_rad, places,
        features,
    )  # fmt: skip
    return VoteGroups(places[:count], features[:count])


@njit(cache=True, nogil=True)
def _group(at: Floats, score: Floats, near: Floats, step_rad: float, places: Floats, features: Inputs) -> int:
    count, is_free = 0, np.ones(len(at), np.bool_)
    for first in range(len(at)):
        if not is_free[first]:
            continue
        total, x, y, squares, members, logs, shares = 0.0, 0.0, 0.0, 0.0, 0, 0.0, 0.0
        for k in range(first, len(at)):
            off = (at[k, 0] - at[first, 0]) ** 2 + (at[k, 1] - at[first, 1]) ** 2
            if not is_free[k] or off > APART_M**2:
                continue
            is_free[k] = False
            weight = 1.0 / (1.0 + np.exp(-score[k]))
            total += weight
            x += weight * at[k, 0]
            y += weight * at[k, 1]
            squares += weight * off
            members += 1
            logs += score[k]
            shares += weight * near[k]
        places[count, 0], places[count, 1] = x / total, y / total
        reach = shares / total
        features[count, 0] = score[first] / 4.0
        features[count, 1] = logs / members / 4.0
        features[count, 2] = total / members
        features[count, 3] = np.log(total)
        features[count, 4] = np.sqrt(squares / total) / APART_M
        features[count, 5] = np.log(members) / 4.0
        features[count, 6] = members * reach * step_rad
        features[count, 7] = total * reach * step_rad
        features[count, 8] = reach / 10.0
        count += 1
    return count
