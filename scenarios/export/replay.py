"""Replay a run, and write the images of one camera as a sequence, or of all cameras with labels.

The world is built again, and the robot repeats the recorded commands. A run stores images only on request,
and never masks; but the same scenario, seed and versions give the same bytes. No tracker is needed: commands
and tracks are those of the run.

Label images give the person, the body part and the depth of each pixel:

RUN/CAMERA/000001.png, ...                   every image of every camera, as `run --frames` leaves them
RUN/truth/CAMERA/instance/000001.png         8 bits: number of the person seen, 0 for none
RUN/truth/CAMERA/body_part/000001.png        8 bits: number of the part of the body, 0 for none
RUN/truth/CAMERA/depth/000001.png            16 bits: true depth [mm], 0 for nothing and beyond 65 m
RUN/truth/numbers.json                       the name of each person and part
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.loop.faults import FaultySensors
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.image_files import (
    image_file,
    make_image_folders,
    millimetres,
    write_images,
    write_png,
)
from peopleboy.scenarios.run_folder.run_files import truth_files
from peopleboy.scenarios.run_folder.run_tables import Row, truth_rows
from peopleboy.sim.cameras.kinds import Stored, kind_of
from peopleboy.sim.geometry.pinhole import CameraGeometry
from peopleboy.sim.people.body_model import PART_CLASSES
from peopleboy.sim.truth.truth import Box, Truth

Play = Callable[[FinishedRun], Iterator[Tick]]

# Tolerances of a replay; labels are exact to a hundredth of a pixel.
_COMPARED = ("id", "x_m", "y_m", "left_px", "top_px", "width_px", "height_px", "visible_px", "whole_px")
_TOLERANCE = 0.01


def replay(run: FinishedRun) -> Iterator[Tick]:
    """Yield the ticks of a finished run, with images and masks, and those explanations that were stored.

    Of a run with chosen frames, only their ticks are yielded.

    Raises:
        BadInput: the replay differs from the run, or PyBullet is not installed.
    """
    from peopleboy.sim.world import (
        SimulatedWorld,  # here, as stored data can be exported without PyBullet
    )

    files = run.files()
    tracks, people = files.tracks_by_frame(), files.people_by_frame()
    explanations = files.explanations_by_frame(run.about.tracker)
    kept, skips = set(run.kept_frames), run.is_sampled and not run.scenario.needs_every_frame
    last = max(kept, default=0)
    with SimulatedWorld(run.world) as world:
        stage = FaultySensors(world, run.scenario.faults)
        for row in files.robot.to_pylist()[:last]:
            frame = row["frame"]
            command = _command(row)
            if frame in kept:
                tick = Tick(
                    frame=frame,
                    observation=stage.observe(),
                    truths=stage.truths(),
                    tracks=tuple(tracks[frame]),
                    explanation=explanations[frame],
                    mode=row["mode"],
                    command=command,
                )
                _compare(tick, row, people.get(frame, []), run)
                yield tick
            elif skips:
                world.sense()
            else:
                stage.observe()
            if frame < last:
                stage.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def counted(report: Callable[[int], None]) -> Play:
    """Return a `replay` that reports each tick by its number, which continues over all runs."""
    number = count(1)

    def play(run: FinishedRun) -> Iterator[Tick]:
        for tick in replay(run):
            report(next(number))
            yield tick

    return play


def _command(row: Row) -> Command:
    return Command(
        linear_m_s=row["command_linear_m_s"],
        angular_rad_s=row["command_angular_rad_s"],
        is_emergency=row["command_is_emergency"],
    )


def _compare(tick: Tick, robot: Row, people: Sequence[Row], run: FinishedRun) -> None:
    pose = tick.truth.robot
    was, now = (robot["x_m"], robot["y_m"], robot["heading_rad"]), (pose.x, pose.y, pose.heading)
    is_same = np.allclose(was, now, rtol=0.0, atol=_TOLERANCE) and np.array_equal(
        *_aligned(_numbers(people), _numbers(truth_rows(tick)))
    )
    if not is_same:
        raise BadInput(
            f"{run.folder}: frame {tick.frame} of the replay differs from the run{_why(run)}; run it again"
        )


def _aligned(
    was: NDArray[np.float64], now: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return both tables, with values within the tolerance made equal."""
    if was.shape != now.shape:
        return was, now
    is_close = np.isclose(was, now, rtol=0.0, atol=_TOLERANCE, equal_nan=True)
    return np.where(is_close, 0.0, was), np.where(is_close, 0.0, now)


def _numbers(rows: Sequence[Row]) -> NDArray[np.float64]:
    table = [[np.nan if row[name] is None else row[name] for name in _COMPARED] for row in rows]
    return np.array(table, np.float64).reshape(len(rows), len(_COMPARED))


def _why(run: FinishedRun) -> str:
    """Describe the packages whose version has changed since the run."""
    before, now = run.about.versions, versions()
    changed = [f"{name} {was}, now {now[name]}" for name, was in before.items() if now.get(name, was) != was]
    return f" (made with {'; '.join(changed)})" if changed else ""


@dataclass(frozen=True, slots=True)
class OneCamera:
    """The images of one camera in a run, counted from 1 without gaps.

    Attributes:
        run: the run.
        name: name of the camera.
        every: frames of the run from one image to the next.
    """

    run: FinishedRun
    name: str
    every: int

    @property
    def frames(self) -> Sequence[int]:
        """The frames of the run to use in which the camera took an image."""
        kept = self.run.kept_frames
        if isinstance(kept, range):
            return kept[:: self.every]
        return [frame for frame in kept if (frame - 1) % self.every == 0]

    @property
    def rate_hz(self) -> int:
        """Images per second."""
        return self.run.rate_hz // self.every

    @property
    def camera(self) -> CameraGeometry:
        """Geometry of the camera."""
        return self.run.robot.cameras[self.name].camera

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.camera.width, self.camera.height

    @property
    def truth_file(self) -> Path:
        """File of its ground truth as MOTChallenge text, with frames of the run."""
        return truth_files(self.run.folder, self.name)[0]

    @property
    def tracks_file(self) -> Path:
        """File of the tracks in its images as MOTChallenge text, with frames of the run; may be missing."""
        folder = self.run.folder
        return folder / "tracks.txt" if self.name == "thermal" else folder / "tracks" / f"{self.name}.txt"

    def number(self, frame: int) -> int:
        """Return the number of the image that it took in a frame of the run."""
        return (frame - 1) // self.every + 1


def one_camera(run: FinishedRun, name: str) -> OneCamera:
    """Find a camera of a run.

    Raises:
        BadInput: the camera is unknown.
    """
    cameras = run.robot.cameras
    if name not in cameras:
        raise BadInput(f"{run.folder}: unknown camera {name!r}; choose from {', '.join(cameras)}")
    return OneCamera(run, name, run.rate_hz // (cameras[name].rate_hz or run.rate_hz))


def with_people(run: FinishedRun, name: str) -> OneCamera:
    """Find a camera of a run that has boxes of people.

    Raises:
        BadInput: the camera is unknown.
    """
    found = one_camera(run, name)
    if not kind_of(run.robot.cameras[name]).has_boxes:
        raise BadInput(f"{run.folder}: camera {name!r} has no boxes of people; give another --camera")
    return found


def write_camera_images(shots: OneCamera, play: Play, place: Callable[[int], Path]) -> None:
    """Copy a camera's images if the run has written them, else render them again.

    Args:
        shots: the camera and its run.
        play: returns the ticks of the run.
        place: returns the file of an image from its number, from 1.

    Raises:
        BadInput: a file cannot be written, or the replay differs from the run.
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
SEEN, HIDDEN, OUTSIDE = 2, 1, 0  # visibility flags of keypoints, in COCO and YOLO

Keypoint = tuple[float, float, int]


def from_corner(box: Box | None) -> list[float] | None:
    """Return a box with pixels counted from the image's corner, rounded to a thousandth."""
    if box is None:
        return None
    left, top, width, height = box
    return [round(edge, 3) for edge in (left + CORNER_PX, top + CORNER_PX, width, height)]


def keypoints_from_corner(
    joints_px: Sequence[Sequence[float]], is_visible: Sequence[bool], size: tuple[int, int]
) -> list[Keypoint]:
    """Return u, v and a flag for each joint: 2 for visible, 1 for hidden; zeros for joints outside the image.

    Args:
        joints_px: (17, 2) u, v from the middle of the first pixel; NaN behind the camera.
        is_visible: (17,) whether each joint is visible.
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
    """Write the images of each run, and the ground truth of each pixel.

    Raises:
        BadInput: a file cannot be written, or the replay differs from the run.
    """
    for run in runs:
        own = folder / run.name
        cameras = run.robot.cameras
        make_image_folders(own, cameras)
        for place in (own / "truth" / camera / kind for camera in cameras for kind in KINDS):
            place.mkdir(parents=True)
        (own / "truth" / "numbers.json").write_text(
            json.dumps(_label_numbers(run), indent=2), encoding="utf-8"
        )
        for tick in play(run):
            write_images(own, tick.frame, tick.observation, cameras)
            for camera, truth in tick.truths.items():
                for kind, image in label_images(truth).items():
                    write_png(own / "truth" / camera / kind / image_file(tick.frame), image)


def label_images(truth: Truth) -> dict[str, Stored]:
    """Return the ground truth of each pixel (H, W), by kind: 8-bit numbers, and 16-bit depth [mm]."""
    return dict(zip(KINDS, (truth.instance, truth.body_part, millimetres(truth.depth_m)), strict=True))


def _label_numbers(run: FinishedRun) -> Mapping[str, Mapping[str, int]]:
    people = {person.name: number for number, person in enumerate(run.world.people, start=1)}
    return {"instance": people, "body_part": PART_CLASSES}
