"""Segmentation of people in panoramas, image after image."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.networks.mask_network import BLOCK, DILATIONS, INPUTS, OUTPUTS, TOGETHER, MaskNetwork
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.panorama.background_memory import compare, first_memory, learn, move_along
from peopleboy.tracker.sensors.panorama.floor_rows import FloorRows, floor_rows
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaName, PanoramaView, view_of

Linear = NDArray[np.float32]

_SHORTEST_S = 0.01
_LEAST_WAY_M, _LEAST_TURN_RAD = 1e-3, 5e-4  # smaller motions are noise of standing wheels

MODEL: Final = "foreground"
FILES: Final[Mapping[PanoramaName, str]] = {
    "mirror": "foreground.npz",
    "all-round": "foreground-all-round.npz",
}

_SPECS: Final = {
    "first": ArraySpec((INPUTS, "units")),
    "rows": ArraySpec(("rows", "units")),
    "between": ArraySpec((len(DILATIONS), 9, "units", "units")),
    "biases": ArraySpec((len(DILATIONS), "units")),
    "last": ArraySpec(("units + inputs", OUTPUTS)),
    "bias": ArraySpec((OUTPUTS,)),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForegroundModel:
    """A network, and the camera of its training images.

    Attributes:
        network: separates people from background.
        view: of the camera.
        about: description of the training data, for readers of the file.
    """

    network: MaskNetwork
    view: PanoramaView
    about: dict[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the model."""
        arrays = {each.name: getattr(self.network, each.name) for each in fields(MaskNetwork)}
        WeightsArchive(arrays, self.about, asdict(self.view)).save(path)

    @classmethod
    def load(cls, path: Path) -> "ForegroundModel":
        """Read a model.

        Raises:
            BadInput: the file cannot be read, or is not such a model.
        """
        archive = WeightsArchive.load(path, MODEL, _SPECS, PanoramaView.of_plain)
        network, view = MaskNetwork(**archive.arrays), archive.camera
        rows, units = network.rows.shape
        is_whole = units % TOGETHER == 0 and view.width_px % BLOCK == 0
        if not is_whole or view.height_px != BLOCK * rows or len(network.last) != units + INPUTS:
            raise BadInput(f"layers do not fit: {units} units, images of {view.size}", file=str(path))
        return cls(network=network, view=view, about=dict(archive.about))


class Foreground:
    """Separates people from background, on a standing or moving robot.

    It works from the first image on, even with people in it. A background model that moves with the robot
    gives the novelty, and a network classifies pixels by it and by appearance. The background is not updated
    with pixels classified as people.

    Attributes:
        network: the classifier.
        squares: (INPUTS, H / BLOCK, W / BLOCK) features of the last image.
        novelty: (H, W) difference from the background, 0..1; lower where the background is young.
    """

    def __init__(self, model: ForegroundModel | None = None) -> None:
        """Make one with the shipped network, unless another one is given."""
        model = shipped_foreground() if model is None else model
        self.network = model.network
        self.squares: Linear = np.zeros((0, 0, 0), np.float32)
        self.novelty: Linear = np.zeros((0, 0), np.float32)
        self._view = model.view
        self._calibration: Calibration | None = None
        self._rows: FloorRows | None = None
        self._memory: Linear | None = None
        self._moved = Pose2()  # since the memory was last warped
        self._time_s = 0.0

    def update(
        self, image: NDArray[np.uint8], time_s: float, odometry: Odometry | None, calibration: Calibration
    ) -> Linear:
        """Process an image and return the segmentation.

        Args:
            image: (H, W, 3) uint8 RGB panorama.
            time_s: when it was taken [s].
            odometry: motion of the robot since the last image; None if unknown, which resets the background.
            calibration: of the panoramic camera.

        Returns:
            (H, W) probability of each pixel to be on a person.

        Raises:
            BadInput: the network was trained with another mirror, or on images of another size.
        """
        floor = self._floor(calibration, image)
        memory = self._brought_along(image, odometry, floor)
        self.squares, self.novelty = compare(image, memory)
        foreground = self.network.predict(self.squares)
        learn(memory, image, foreground, max(time_s - self._time_s, _SHORTEST_S))
        self._memory, self._time_s = memory, time_s
        return foreground

    @property
    def background(self) -> NDArray[np.uint8]:
        """Background model, (H, W, 3) RGB; black before the first image."""
        shape = (self._view.height_px, self._view.width_px, 3)
        if self._memory is None:
            return np.zeros(shape, np.uint8)
        return np.clip(np.rint(self._memory[:3].transpose(1, 2, 0)), 0, 255).astype(np.uint8)

    def _brought_along(self, image: NDArray[np.uint8], odometry: Odometry | None, floor: FloorRows) -> Linear:
        """Warp the background to the robot's pose, if it moved noticeably."""
        if self._memory is None or odometry is None:
            self._moved = Pose2()
            return first_memory(image)
        self._moved = moved = self._moved.integrate(odometry.motion)
        if math.hypot(moved.x, moved.y) < _LEAST_WAY_M and abs(moved.heading) < _LEAST_TURN_RAD:
            return self._memory
        self._moved = Pose2()
        return move_along(self._memory, Odometry.from_motion(moved), floor)

    def _floor(self, calibration: Calibration, image: NDArray[np.uint8]) -> FloorRows:
        """Return the floor geometry; a camera that the network was not trained on is refused."""
        (height, width), known = image.shape[:2], self._view
        is_same = calibration is self._calibration and (width, height) == (known.width_px, known.height_px)
        if self._rows is None or not is_same:
            why = known.refusal(view_of(calibration, width, height))
            if why:
                raise BadInput(f"{why}; no other network is available")
            self._calibration, self._rows = calibration, floor_rows(calibration, height)
        return self._rows


@cache
def shipped_foreground(camera: PanoramaName = "mirror") -> ForegroundModel:
    """Read the shipped model of a view, once."""
    return ForegroundModel.load(SHIPPED / FILES[camera])
