"""Which pixels of the panorama are people, image after image."""

from __future__ import annotations

import math
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
from peopleboy.tracker.panoramic.background_memory import compare, first_memory, learn, move_along
from peopleboy.tracker.panoramic.floor_rows import FloorRows, floor_rows
from peopleboy.tracker.panoramic.panorama_view import PanoramaView, view_of

Linear = NDArray[np.float32]

_SHORTEST_S = 0.01
_LEAST_WAY_M, _LEAST_TURN_RAD = 1e-3, 5e-4  # less is the noise of wheels that stand

MODEL: Final = "foreground"
FILE: Final = "foreground.npz"

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
    """A network, and the camera whose images it was trained on.

    Attributes:
        network: that separates people from background.
        view: of the camera.
        about: what it was trained on, for the reader of the file.
    """

    network: MaskNetwork
    view: PanoramaView
    about: dict[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the model."""
        arrays = {each.name: getattr(self.network, each.name) for each in fields(MaskNetwork)}
        WeightsArchive(arrays, self.about, asdict(self.view)).save(path)

    @classmethod
    def load(cls, path: Path) -> ForegroundModel:
        """Read a model.

        Raises:
            BadInput: the file cannot be read, or is no such model.
        """
        archive = WeightsArchive.load(path, MODEL, _SPECS, PanoramaView.of_plain)
        network, view = MaskNetwork(**archive.arrays), archive.camera
        rows, units = network.rows.shape
        is_whole = units % TOGETHER == 0 and view.width_px % BLOCK == 0
        if not is_whole or view.height_px != BLOCK * rows or len(network.last) != units + INPUTS:
            raise BadInput(f"layers do not fit: {units} units, images of {view.size}", file=str(path))
        return cls(network=network, view=view, about=dict(archive.about))


class Foreground:
    """Separates people from background, on a robot that stands or drives.

    It works from the first image on, whoever is in it. A background that moves with the robot shows what
    is new, and a network judges that by what it looks like; what it takes for people the background leaves
    out.

    Attributes:
        network: that judges.
        squares: (INPUTS, H / BLOCK, W / BLOCK) what it knew of the last image.
        novelty: (H, W) how unlike the background each pixel of that is, 0..1; less if that is young.
    """

    def __init__(self, model: ForegroundModel | None = None) -> None:
        """Begin, with the network that comes with the tracker if no other is given."""
        model = shipped_foreground() if model is None else model
        self.network = model.network
        self.squares: Linear = np.zeros((0, 0, 0), np.float32)
        self.novelty: Linear = np.zeros((0, 0), np.float32)
        self._view = model.view
        self._calibration: Calibration | None = None
        self._rows: FloorRows | None = None
        self._memory: Linear | None = None
        self._moved = Pose2()  # since the memory was brought along
        self._time_s = 0.0

    def update(
        self, image: NDArray[np.uint8], time_s: float, odometry: Odometry | None, calibration: Calibration
    ) -> Linear:
        """Take in an image, and tell people from background.

        Args:
            image: (H, W, 3) uint8 RGB panorama.
            time_s: when it was taken [s].
            odometry: how the robot moved since the last image; None if unknown, which makes all begin anew.
            calibration: of the panoramic camera.

        Returns:
            (H, W) for each pixel the probability that it is a person.

        Raises:
            BadInput: the network was taught with another mirror, or on images of another size.
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
        """What it takes for the scene without people, (H, W, 3) RGB; all black before the first image."""
        shape = (self._view.height_px, self._view.width_px, 3)
        if self._memory is None:
            return np.zeros(shape, np.uint8)
        return np.clip(np.rint(self._memory[:3].transpose(1, 2, 0)), 0, 255).astype(np.uint8)

    def _brought_along(self, image: NDArray[np.uint8], odometry: Odometry | None, floor: FloorRows) -> Linear:
        """Bring the background to where the robot is now, as soon as it makes a difference."""
        if self._memory is None or odometry is None:
            self._moved = Pose2()
            return first_memory(image)
        self._moved = moved = self._moved.integrate(odometry.motion)
        if math.hypot(moved.x, moved.y) < _LEAST_WAY_M and abs(moved.heading) < _LEAST_TURN_RAD:
            return self._memory
        self._moved = Pose2()
        return move_along(self._memory, Odometry.from_motion(moved), floor)

    def _floor(self, calibration: Calibration, image: NDArray[np.uint8]) -> FloorRows:
        """Return how the floor lies; a camera that the network does not know is refused."""
        (height, width), known = image.shape[:2], self._view
        is_same = calibration is self._calibration and (width, height) == (known.width_px, known.height_px)
        if self._rows is None or not is_same:
            why = known.refusal(view_of(calibration, width, height))
            if why:
                raise BadInput(f"{why}; there is none for another")
            self._calibration, self._rows = calibration, floor_rows(calibration, height)
        return self._rows


@cache
def shipped_foreground() -> ForegroundModel:
    """Read the model that comes with the tracker, once."""
    return ForegroundModel.load(SHIPPED / FILE)
