"""What one camera took in a run, as a sequence of its own for formats that have one kind of image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.geometry.camera_geometry import CameraGeometry


@dataclass(frozen=True, slots=True)
class OneCamera:
    """The images of one camera in a run, counted from 1 without gaps.

    Attributes:
        run: which.
        name: of the camera.
        every: frames of the run from one image to the next.
    """

    run: FinishedRun
    name: str
    every: int

    @property
    def frames(self) -> Sequence[int]:
        """The run's frames in which it took an image."""
        return range(1, self.run.frames + 1, self.every)

    @property
    def rate_hz(self) -> int:
        """Images a second."""
        return self.run.rate_hz // self.every

    @property
    def camera(self) -> CameraGeometry:
        """Its geometry."""
        return self.run.robot.cameras[self.name].camera

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.camera.width, self.camera.height

    @property
    def truth_file(self) -> Path:
        """Its truth as MOTChallenge text, with the run's frames."""
        name = "gt.txt" if self.name == "thermal" else f"{self.name}.gt.txt"
        return self.run.folder / "truth" / name

    @property
    def tracks_file(self) -> Path:
        """What the tracker gave in its images as MOTChallenge text, with the run's frames; may be missing."""
        folder = self.run.folder
        return folder / "tracks.txt" if self.name == "thermal" else folder / "tracks" / f"{self.name}.txt"

    def number(self, frame: int) -> int:
        """The number of the image that it took in a frame of the run."""
        return (frame - 1) // self.every + 1


def one_camera(run: FinishedRun, name: str) -> OneCamera:
    """Find a camera of a run.

    Raises:
        BadInput: there is none of that name.
    """
    cameras = run.robot.cameras
    if name not in cameras:
        raise BadInput(
            f"{run.folder}: there is no camera {name!r}; give --camera one of {', '.join(cameras)}"
        )
    return OneCamera(run, name, run.rate_hz // (cameras[name].rate_hz or run.rate_hz))


def with_people(run: FinishedRun, name: str) -> OneCamera:
    """Find a camera of a run in whose images boxes make sense.

    Raises:
        BadInput: there is none of that name.
    """
    found = one_camera(run, name)
    if not kind_of(run.robot.cameras[name]).has_boxes:
        raise BadInput(f"{run.folder}: camera {name!r} has no boxes of people; give another --camera")
    return found
