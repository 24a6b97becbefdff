"""Write the images of a run's cameras: of one camera as a sequence of its own, or of all with their labels.

Labels are images beside what each camera saw, for each pixel the person, the part of the body, and the depth:

RUN/CAMERA/000001.png, ...                   every image of every camera, as `run --frames` leaves them
RUN/truth/CAMERA/instance/000001.png         8 bits: number of the person seen, 0 for none
RUN/truth/CAMERA/body_part/000001.png        8 bits: number of the part of the body, 0 for none
RUN/truth/CAMERA/depth/000001.png            16 bits: true depth [mm], 0 for nothing and beyond 65 m
RUN/truth/numbers.json                       the name of each person and part
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import (
    image_file,
    make_image_folders,
    millimetres,
    write_images,
    write_png,
)
from peopleboy.scenarios.run_folder.run_files import truth_files
from peopleboy.sim.cameras.kinds import Stored, kind_of
from peopleboy.sim.geometry.pinhole import CameraGeometry
from peopleboy.sim.people.person import PART_CLASSES
from peopleboy.sim.truth.truth import Box, Truth


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
        return truth_files(self.run.folder, self.name)[0]

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


def write_camera_images(shots: OneCamera, play: Play, place: Callable[[int], Path]) -> None:
    """Copy a camera's images if the run has written them, else render them again.

    Args:
        shots: the camera and its run.
        play: gives the run's ticks.
        place: names the file of an image by its number, from 1.

    Raises:
        BadInput: a file cannot be written, or the run does not come out as it was.
    """
    written = [shots.run.folder / shots.name / image_file(frame) for frame in shots.frames]
    if all(path.is_file() for path in written):
        for number, path in enumerate(written, start=1):
            place(number).write_bytes(path.read_bytes())
        return
    for tick in play(shots.run):
        if tick.frame in shots.frames:
            write_png(place(shots.number(tick.frame)), tick.observation.images[shots.name])


CORNER_PX: Final = 0.5
SEEN, HIDDEN, OUTSIDE = 2, 1, 0  # of keypoints, in both

Keypoint = tuple[float, float, int]


def from_corner(box: Box | None) -> list[float] | None:
    """Count a box's pixels from the image's corner, to a thousandth."""
    if box is None:
        return None
    left, top, width, height = box
    return [round(edge, 3) for edge in (left + CORNER_PX, top + CORNER_PX, width, height)]


def keypoints_from_corner(
    joints_px: Sequence[Sequence[float]], is_visible: Sequence[bool], size: tuple[int, int]
) -> list[Keypoint]:
    """Return u, v and 2 for a joint that is seen, 1 for a hidden one, and zeros for one outside the image.

    Args:
        joints_px: (17, 2) u, v from the middle of the first pixel; NaN behind the camera.
        is_visible: (17,) whether each is seen.
        size: width and height of the image [px].
    """
    width, height = size
    found: list[Keypoint] = []
    for (u, v), is_seen in zip(joints_px, is_visible, strict=True):
        is_inside = -CORNER_PX < u < width - CORNER_PX and -CORNER_PX < v < height - CORNER_PX
        point = (round(u + CORNER_PX, 3), round(v + CORNER_PX, 3), SEEN if is_seen else HIDDEN)
        found.append(point if is_inside else (0.0, 0.0, OUTSIDE))
    return found


KINDS: Final = ("instance", "body_part", "depth")


def write_label_images(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write the images of each run, and what is true of each pixel.

    Raises:
        BadInput: a file cannot be written, or a run does not come out as it was.
    """
    for run in runs:
        own = folder / run.name
        cameras = run.robot.cameras
        make_image_folders(own, cameras)
        for place in (own / "truth" / camera / kind for camera in cameras for kind in KINDS):
            place.mkdir(parents=True)
        (own / "truth" / "numbers.json").write_text(json.dumps(_numbers(run), indent=2), encoding="utf-8")
        for tick in play(run):
            write_images(own, tick.frame, tick.observation, cameras)
            for camera, truth in tick.truths.items():
                for kind, image in label_images(truth).items():
                    write_png(own / "truth" / camera / kind / image_file(tick.frame), image)


def label_images(truth: Truth) -> dict[str, Stored]:
    """Return what is true of each pixel (H, W), by kind: numbers of 8 bits, and depth of 16 [mm]."""
    return dict(zip(KINDS, (truth.instance, truth.body_part, millimetres(truth.depth_m)), strict=True))


def _numbers(run: FinishedRun) -> Mapping[str, Mapping[str, int]]:
    people = {person.name: number for number, person in enumerate(run.world.people, start=1)}
    return {"instance": people, "body_part": PART_CLASSES}
