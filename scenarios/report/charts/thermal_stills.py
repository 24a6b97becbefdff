"""What the thermal camera saw at some frames of a run, for people, with truth and tracks drawn in.

The images are those of the run's folder if it was run with frames, or else those of its recording. Without
both, the scene is played again with the commands that the robot was given, which takes as long as the run;
where that is not possible, as with another version or without a physics engine, boxes alone are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from enum import StrEnum
from importlib.util import find_spec
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture, Plate, draw_tracks, draw_truth, enlarge, show_thermal
from peopleboy.scenarios.report.findings.summary import RunFindings
from peopleboy.scenarios.run_folder.explained import read_explanation
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.tables import Row, track_of
from peopleboy.sim.cameras.kinds import SCENE
from peopleboy.tracker.frame import THERMAL

SCALE = 2
CROWD, CROWD_SCALE = 5, 4  # so many people need more room for what is written at them
_EMPTY = np.full((240, 320), 40, np.uint8)

Thermal = NDArray[np.uint8]


class Origin(StrEnum):
    """Where an image is from."""

    FRAMES = "the run's own image"
    RECORDING = "from the run's recording"
    REPLAY = "rendered again from scenario.yaml"
    CHANGED = "boxes only, as this scene cannot be rendered again as it was"
    NO_PHYSICS = "boxes only, as PyBullet is not installed"


class DrawnFrame(NamedTuple):
    """A picture of one frame, when it was taken, and where it is from."""

    picture: Picture
    time_s: float
    origin: Origin


class _Truth(NamedTuple):
    """What is drawn of a person's truth."""

    name: str
    box: tuple[float, float, float, float] | None
    visible_fraction: float


def show_frames(found: RunFindings, frames: Sequence[int]) -> dict[int, DrawnFrame]:
    """Draw some frames (from 1) of a run."""
    recorded = _recorded(found.run, frames)
    others = [frame for frame in frames if frame not in recorded]
    images, origins = images_of(found.run, others, f"{THERMAL}{SCENE}")
    images, origins = recorded | images, dict.fromkeys(recorded, Origin.RECORDING) | origins
    return {
        frame: DrawnFrame(_draw(found, frame, images.get(frame, _EMPTY)), found.run.time_s(frame), origin)
        for frame, origin in sorted(origins.items())
    }


def _recorded(run: FinishedRun, frames: Sequence[int]) -> dict[int, Thermal]:
    """Read what the recording has, if the run was not written image by image."""
    recording = run.folder / "recording.rrd"
    if run.about.images or not recording.is_file():
        return {}
    from peopleboy.scenarios.recording.files.recorded_images import recorded_images

    return recorded_images(recording, THERMAL, frames)


def images_of(
    run: FinishedRun, frames: Sequence[int], image: str
) -> tuple[dict[int, NDArray[np.uint8]], dict[int, Origin]]:
    """Get a camera's images, grey or RGB, at some frames (from 1) of a run, and where each is from."""
    stored = _stored(run, frames, image)
    missing = [frame for frame in frames if frame not in stored]
    has_physics = find_spec("pybullet") is not None
    again = _again(run, missing, image) if missing and has_physics else {}
    origins = dict.fromkeys(frames, Origin.CHANGED if has_physics else Origin.NO_PHYSICS)
    origins |= dict.fromkeys(again, Origin.REPLAY) | dict.fromkeys(stored, Origin.FRAMES)
    return stored | again, origins


def _draw(found: RunFindings, frame: int, image: Thermal) -> Picture:
    people = [_truth(row) for row in _rows(found.files.people, frame)]
    believed = _rows(found.files.beliefs, frame)
    tracks, explanation = (
        [track_of(row) for row in believed],
        read_explanation(found.run.about.tracker, believed),
    )
    plates: list[Plate] = []
    scale = CROWD_SCALE if len(found.people) >= CROWD else SCALE
    canvas = draw_tracks(enlarge(show_thermal(image), scale), tracks, scale, explanation, plates=plates)
    return draw_truth(canvas, people, scale, plates=plates)


def _stored(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, NDArray[np.uint8]]:
    """Read the images that are in the folder."""
    images = {}
    for frame in frames:
        path = run.folder / image / image_file(frame)
        found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.is_file() else None
        if found is not None:
            images[frame] = np.ascontiguousarray(found[..., ::-1] if found.ndim == 3 else found, np.uint8)
    return images


def _again(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, NDArray[np.uint8]]:
    """Play the scene again as far as the last frame wanted, or until it goes another way."""
    from peopleboy.scenarios.export.replay import replay

    images = {}
    with suppress(BadInput):
        for tick in replay(run):
            if tick.frame in frames and image in tick.observation.images:
                images[tick.frame] = tick.observation.images[image]
            if tick.frame >= max(frames):
                break
    return images


def _rows(table: Any, frame: int) -> list[Row]:
    rows: list[Row] = table.filter(np.asarray(table["frame"].to_numpy() == frame)).to_pylist()
    return rows


def _truth(row: Row) -> _Truth:
    box = (row["left_px"], row["top_px"], row["width_px"], row["height_px"])
    return _Truth(row["name"], None if row["left_px"] is None else box, row["visible_fraction"])
