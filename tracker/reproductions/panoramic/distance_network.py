"""The distance network of the 2003 paper: three inputs, four hidden units, one output."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.reproductions.panoramic.position_filter import MotionNoise
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaView

Floats = NDArray[np.float64]

MODEL: Final = "distance"
CUES: Final = 3
# Outputs for the nearest and the farthest distance: a sigmoid never reaches 0 or 1.
LOW, HIGH = 0.1, 0.9

_SPECS: Final = {
    "hidden": ArraySpec(("units", CUES + 1), np.float64),
    "output": ArraySpec(("units + 1",), np.float64),
    "cue_ranges": ArraySpec((CUES, 2), np.float64),
    "distance_range_m": ArraySpec((2,), np.float64),
    "step_m2": ArraySpec((2, 2), np.float64),
    "measurement_m2": ArraySpec((2, 2), np.float64),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DistanceNetwork:
    """A trained network.

    Attributes:
        hidden: (units, 4) weights of the three scaled cues, and the bias.
        output: (units + 1,) weights of the hidden units, and the bias.
        cue_ranges: (3, 2) least and greatest training value of each cue [px], scaled to 0 and 1.
        distance_range_m: nearest and farthest training distance [m], scaled to 0.1 and 0.9.
    """

    hidden: Floats
    output: Floats
    cue_ranges: Floats
    distance_range_m: tuple[float, float]

    def predict(self, cues: Floats) -> Floats:
        """Return the distances (N,) [m] for cues (N, 3) [px]."""
        units = sigmoid(with_bias(scaled(cues, self.cue_ranges)) @ self.hidden.T)
        nearest, farthest = self.distance_range_m
        share = (sigmoid(with_bias(units) @ self.output) - LOW) / (HIGH - LOW)
        return np.asarray(nearest + share * (farthest - nearest), np.float64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DistanceModel:
    """A network with the camera and filter values of its training.

    Attributes:
        network: maps cues to a distance.
        view: camera of its training images.
        noise: Q and R estimated from the training samples, without a velocity.
        about: description of the training data, for readers of the file.
    """

    network: DistanceNetwork
    view: PanoramaView
    noise: MotionNoise
    about: Mapping[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the model."""
        network, noise = self.network, self.noise
        arrays = {
            "hidden": network.hidden,
            "output": network.output,
            "cue_ranges": network.cue_ranges,
            "distance_range_m": np.array(network.distance_range_m),
            "step_m2": noise.step_m2,
            "measurement_m2": noise.measurement_m2,
        }
        WeightsArchive(arrays, self.about, asdict(self.view)).save(path)

    @classmethod
    def load(cls, path: Path) -> "DistanceModel":
        """Read and validate a model.

        Raises:
            BadInput: the file is missing or is not such a model.
        """
        archive = WeightsArchive.load(path, MODEL, _SPECS, PanoramaView.of_plain)
        arrays = archive.arrays
        if len(arrays["output"]) != len(arrays["hidden"]) + 1:
            raise BadInput("output must have one weight more than hidden has rows", file=str(path))
        if (np.diff(np.vstack([arrays["cue_ranges"], arrays["distance_range_m"]])) <= 0.0).any():
            raise BadInput("ranges must go from less to more", file=str(path))
        nearest, farthest = arrays["distance_range_m"].tolist()
        return cls(
            network=DistanceNetwork(
                hidden=arrays["hidden"],
                output=arrays["output"],
                cue_ranges=arrays["cue_ranges"],
                distance_range_m=(nearest, farthest),
            ),
            view=archive.camera,
            noise=MotionNoise(step_m2=arrays["step_m2"], measurement_m2=arrays["measurement_m2"]),
            about=archive.about,
        )


def file_name(scenario: str) -> str:
    """Return the file name of a model trained on a scenario."""
    return f"distance-{scenario}.npz"


def shipped_models(folder: Path = SHIPPED) -> dict[Path, DistanceModel]:
    """Read the shipped models, one per mirror.

    Raises:
        BadInput: there is none.
    """
    found = {path: DistanceModel.load(path) for path in sorted(folder.glob(file_name("*")))}
    if not found:
        raise BadInput(
            f"tracker panoramic-paper: {folder.name} has no network yet; "
            f"`peopleboy train {MODEL} --ship` makes one"
        )
    return found


def scaled(cues: Floats, ranges: Floats) -> Floats:
    """Scale cues (N, 3) from their ranges (3, 2) to 0..1."""
    return np.asarray((cues - ranges[:, 0]) / (ranges[:, 1] - ranges[:, 0]), np.float64)


def with_bias(inputs: Floats) -> Floats:
    """Append a column of ones."""
    return np.hstack([inputs, np.ones((len(inputs), 1))])


def sigmoid(x: Floats) -> Floats:
    """Return the logistic function of x."""
    return np.asarray(1.0 / (1.0 + np.exp(-x)), np.float64)
