"""What the thermal camera saw at some frames of a run, with truth and tracks drawn in.

The images are those of the run's folder if it was run with frames. Else the scene is played again with the
commands that the robot was given, which gives the same images; where that is not possible any more, as with
another version, boxes alone are drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture, Plate, draw_tracks, draw_truth, enlarge, show_thermal
from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.run_folder.tables import track_of

SCALE = 2
_EMPTY_GREY = 40

Thermal = NDArray[np.uint8]


class Origin(StrEnum):
    """Where an image is from."""

    FRAMES = "the run's own image"
    REPLAY = "rendered again from scenario.yaml"
    NONE = "boxes only, as this scene cannot be rendered again as it was"


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A picture of one frame, and where it is from."""

    picture: Picture
    origin: Origin


@dataclass(frozen=True, slots=True)
class _Truth:
    """What is drawn of a person's truth."""

    name: str
    box: tuple[float, float, float, float] | None
    visible_fraction: float


def show_frames(run: FinishedRun, frames: Sequence[int]) -> dict[int, Shown]:
    """Draw some frames (from 1) of a run."""
    images = _stored(run, frames)
    origin = Origin.FRAMES
    if len(images) < len(frames):
        images, origin = dict(_replay(run, frames)), Origin.REPLAY
    return {frame: _draw(run, frame, images.get(frame), origin) for frame in frames}


def _draw(run: FinishedRun, frame: int, image: Thermal | None, origin: Origin) -> Shown:
    if image is None:
        image, origin = np.full((240, 320), _EMPTY_GREY, np.uint8), Origin.NONE
    people = [_truth(row) for row in _rows(run.people, frame)]
    tracks = [track_of(row) for row in _rows(run.beliefs, frame)]
    plates: list[Plate] = []
    canvas = draw_tracks(enlarge(show_thermal(image), SCALE), tracks, SCALE, plates=plates)
    return Shown(draw_truth(canvas, people, SCALE, plates=plates), origin)


def _stored(run: FinishedRun, frames: Sequence[int]) -> dict[int, Thermal]:
    """Read the images that are in the folder."""
    images = {}
    for frame in frames:
        path = run.folder / "thermal" / f"{frame:06d}.png"
        image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) if path.is_file() else None
        if image is not None:
            images[frame] = np.asarray(image, np.uint8)
    return images


def _replay(run: FinishedRun, frames: Sequence[int]) -> Iterator[tuple[int, Thermal]]:
    """Play the scene again as far as the last frame wanted; yields nothing more once it goes another way."""
    try:
        for tick in replay(open_run(run.folder)):
            if tick.frame in frames:
                yield tick.frame, tick.observation.images["thermal"]
            if tick.frame >= max(frames):
                return
    except BadInput:
        return


def _rows(table: Any, frame: int) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = table.filter(np.asarray(table["frame"].to_numpy() == frame)).to_pylist()
    return rows


def _truth(row: Mapping[str, Any]) -> _Truth:
    box = None if row["left_px"] is None else _box(row)
    return _Truth(row["name"], box, row["visible_fraction"])


def _box(row: Mapping[str, Any]) -> tuple[float, float, float, float]:
    return row["left_px"], row["top_px"], row["width_px"], row["height_px"]
