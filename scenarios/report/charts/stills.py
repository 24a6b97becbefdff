"""What a run is scored by saw at some frames, for people, with truth and tracks drawn in.

That is the thermal camera, or another one in whose images alone the tracker gave boxes. The images are those
of the run's folder if it was run with frames, or else those of its recording. Without both, the scene is
played again with the commands that the robot was given, which takes as long as the run; where that is not
possible, as with another version or without a physics engine, boxes alone are drawn.
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
from peopleboy.scenarios.drawing.overlay import (
    Picture,
    Plate,
    as_picture,
    box_parts,
    draw_tracks,
    draw_tracks_of,
    draw_truth,
    enlarge,
)
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.run_tables import Row, read_explanation
from peopleboy.sim.cameras.kinds import kind_of, layers_of
from peopleboy.sim.geometry.pinhole import CameraGeometry
from peopleboy.tracker.boxes import Box
from peopleboy.tracker.frame import THERMAL

SCALE = 2
CROWD, CROWD_SCALE = 5, 4  # so many people need more room for what is written at them
_WIDE_PX = 480  # of an image; wider ones are enlarged the less
_DARK = 40  # grey of a picture whose image is lost

Image = NDArray[Any]


class Origin(StrEnum):
    """Where an image is from."""

    FRAMES = "the run's own image"
    RECORDING = "from the run's recording"
    REPLAY = "rendered again from scenario.yaml"
    CHANGED = "boxes only, as this scene cannot be rendered again as it was"
    NO_PHYSICS = "boxes only, as PyBullet is not installed"


class DrawnFrame(NamedTuple):
    """A picture of one frame, by which camera and when it was taken, and where it is from."""

    picture: Picture
    camera: str
    time_s: float
    origin: Origin


class _Truth(NamedTuple):
    """What is drawn of a person's truth."""

    name: str
    box: Box | None
    visible_fraction: float


def show_frames(found: RunFindings, frames: Sequence[int]) -> dict[int, DrawnFrame]:
    """Draw some frames (from 1) of a run; of a slow camera, what it saw last."""
    camera, run = found.camera, found.run
    taken = {frame: _newest(frame, run.rate_hz, found.view.rate_hz) for frame in frames}
    wanted = sorted(set(taken.values()))
    recorded = _recorded(run, camera, wanted)
    layer = next(one for one in layers_of(found.view) if one.suffix == kind_of(found.view).shown)
    others = [frame for frame in wanted if frame not in recorded]
    images, origins = images_of(run, others, f"{camera}{layer.suffix}")
    shown = recorded | {frame: layer.show(image) for frame, image in images.items()}
    origins = dict.fromkeys(recorded, Origin.RECORDING) | origins
    drawn = {frame: _draw(found, frame, shown.get(frame)) for frame in wanted}
    return {
        frame: DrawnFrame(drawn[at], camera, run.time_s(at), origins[at])
        for frame, at in sorted(taken.items())
    }


def _newest(frame: int, rate_hz: int, images_hz: int | None) -> int:
    """Return the frame (from 1) at which a camera took its newest image."""
    step = rate_hz // (images_hz or rate_hz)
    return (frame - 1) // step * step + 1


def _recorded(run: FinishedRun, camera: str, frames: Sequence[int]) -> dict[int, Image]:
    """Read what the recording has, if the run was not written image by image."""
    recording = run.folder / "recording.rrd"
    if run.about.images or not recording.is_file():
        return {}
    from peopleboy.scenarios.recording.recording_file import recorded_images

    return {**recorded_images(recording, camera, frames)}


def images_of(
    run: FinishedRun, frames: Sequence[int], image: str
) -> tuple[dict[int, Image], dict[int, Origin]]:
    """Get a camera's images at some frames (from 1) of a run, as it gives them, and where each is from."""
    stored = _stored(run, frames, image)
    missing = [frame for frame in frames if frame not in stored]
    has_physics = find_spec("pybullet") is not None
    again = _again(run, missing, image) if missing and has_physics else {}
    origins = dict.fromkeys(frames, Origin.CHANGED if has_physics else Origin.NO_PHYSICS)
    origins |= dict.fromkeys(again, Origin.REPLAY) | dict.fromkeys(stored, Origin.FRAMES)
    return stored | again, origins


def _draw(found: RunFindings, frame: int, image: Image | None) -> Picture:
    geometry, plates = found.view.camera, list[Plate]()
    people = [
        _Truth(row["name"], part, row["visible_fraction"])
        for row in _rows(found.seen, frame)
        for part in _parts(row, geometry)
    ]
    size = (geometry.height, geometry.width)
    scale = (CROWD_SCALE if len(found.people) >= CROWD else SCALE) * min(_WIDE_PX / geometry.width, 1.0)
    canvas = enlarge(as_picture(np.full(size, _DARK, np.uint8) if image is None else image), scale)
    tracks = found.files.tracks_by_frame()[frame]
    if found.camera == THERMAL:
        explanation = read_explanation(found.run.about.tracker, _rows(found.files.beliefs, frame))
        canvas = draw_tracks(canvas, tracks, scale, explanation, plates=plates)
    else:
        canvas = draw_tracks_of(
            found.camera, canvas, tracks, {found.camera: found.view}, scale, plates=plates
        )
    return draw_truth(canvas, people, scale, plates=plates)


def _stored(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, Image]:
    """Read the images that are in the folder."""
    images = {}
    for frame in frames:
        path = run.folder / image / image_file(frame)
        found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.is_file() else None
        if found is not None:
            images[frame] = np.ascontiguousarray(found[..., ::-1] if found.ndim == 3 else found)
    return images


def _again(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, Image]:
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


def _parts(row: Row, camera: CameraGeometry) -> tuple[Box | None, ...]:
    box = (row["left_px"], row["top_px"], row["width_px"], row["height_px"])
    return (None,) if row["left_px"] is None else box_parts(box, camera)
