"""Choose and read the reference boxes of a run: in which camera's image, around torsos or whole people."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import cameras_of
from peopleboy.scenarios.run_folder.floor_places import BELIEFS, is_on_floor_alone
from peopleboy.scenarios.run_folder.run_files import read_table
from peopleboy.scenarios.run_folder.run_tables import TRACKS
from peopleboy.scenarios.run_folder.truth_files import true_boxes, truth_files
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.tracker.evaluation.mot_files import read_tracks
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind, width_per_height
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.trackers import TRACKERS

# The way from the width of the truth's boxes to that of those of the other kind from which on boxes are such;
# trackers of torsos come to 0.45 of it in 210 runs, and to 0.52 if their ellipses are wide.
_NEAR_OTHER: Final = 0.75
_LEAST_APART: Final = 0.1  # of the widths' logarithms; else nobody can tell
_WIDEST: Final = 2.0  # widths of whole people, than which no tracker's boxes are wider
CALLED: Final = {BoxKind.TORSO: "torsos", BoxKind.WHOLE: "whole people"}


@dataclass(frozen=True, slots=True)
class BoxReference:
    """What boxes are held against.

    Attributes:
        camera: in whose images they are.
        boxes: what the truth's are drawn round.
    """

    camera: str = THERMAL
    boxes: BoxKind = BoxKind.TORSO

    def __str__(self) -> str:
        """Say it in words."""
        return f"{CALLED[self.boxes]} in {self.camera} images"

    def to_json(self) -> dict[str, str]:
        """Return it as metrics.json has it."""
        return {"camera": self.camera, "boxes": str(self.boxes)}


def read_reference_boxes(folder: Path, by: BoxReference) -> tuple[TrueBoxes, TrackBoxes]:
    """Read the truth of a run and the boxes that its tracker gave; in a panorama they go on over the seam.

    Raises:
        BadInput: no boxes were given in images of this camera, or a file is spoilt.
    """
    text, table = truth_files(folder, by.camera)
    if by.camera == THERMAL:
        return true_boxes(text, table, by.boxes), read_tracks(folder / "tracks.txt")
    cameras, given = cameras_of(folder), folder / "tracks" / f"{by.camera}.txt"
    if by.camera not in cameras:
        raise BadInput(f"{folder}: there is no camera {by.camera!r}; choose from {', '.join(cameras)}")
    for path in (text, given):
        if not path.is_file():
            raise BadInput(f"{path}: there is no such file; no boxes were given in camera {by.camera!r}")
    around = around_px(cameras[by.camera].camera)
    return replace(true_boxes(text, table, by.boxes), around_px=around), read_tracks(given)


def kind_of_boxes(folder: Path, camera: str, tracker: str | None, said: BoxKind) -> BoxKind:
    """Return what a tracker's boxes in a camera's images are drawn round: as it was said of the run.

    Ours are said to be round torsos, and are so in flat images; in panoramas they are round whole people.

    Args:
        folder: of the run.
        camera: its name.
        tracker: its name; None for one that has no name.
        said: of the run.
    """
    if tracker not in TRACKERS.shipped or camera == THERMAL:
        return said
    config = cameras_of(folder).get(camera)
    is_round = config is not None and math.isfinite(around_px(config.camera))
    return BoxKind.WHOLE if is_round else said


def own_camera(folder: Path) -> str:
    """Name the camera by which a run is scored: `thermal`, or the only one in whose images there are boxes.

    A tracker that gives no box in `thermal`, but places, is scored on the floor.
    """
    cameras = boxed_cameras(folder)
    if THERMAL in cameras or len(cameras) != 1:
        return THERMAL
    beliefs = read_table(folder / "tracks.parquet", TRACKS, BELIEFS)
    return THERMAL if is_on_floor_alone(beliefs) else cameras[0]


def boxed_cameras(folder: Path) -> tuple[str, ...]:
    """Name the cameras in whose images the tracker of a run gave boxes."""
    further = sorted((folder / "tracks").glob("*.txt"))
    named = [(THERMAL, folder / "tracks.txt"), *((path.stem, path) for path in further)]
    return tuple(camera for camera, path in named if path.is_file() and path.stat().st_size)


def notes_on(folder: Path, by: BoxReference, truth: TrueBoxes, tracks: TrackBoxes) -> tuple[str, ...]:
    """Return where the boxes are if not where they are looked for, and whether they are of another kind."""
    cameras = boxed_cameras(folder)
    if not cameras:
        return ()
    where = ", ".join(cameras)
    if by.camera not in cameras:
        return (f"all boxes are in images of {where}; evaluate RUN --camera {cameras[0]} scores them there",)
    away = f"all boxes are in images of {where}, and scored there; behaviours see boxes in thermal alone"
    return tuple(
        note
        for note in (away if THERMAL not in cameras else "", _of_other_kind(folder, by, truth, tracks))
        if note
    )


def _of_other_kind(folder: Path, by: BoxReference, truth: TrueBoxes, tracks: TrackBoxes) -> str:
    """Say so if boxes are wider than any people, or nearly as wide as the truth's of the other kind."""
    other = BoxKind.TORSO if by.boxes is BoxKind.WHOLE else BoxKind.WHOLE
    there = true_boxes(*truth_files(folder, by.camera), other)
    given, wide, elsewhere = (width_per_height(rows) for rows in (tracks, truth, there))
    if not all(one > 0.0 for one in (given, wide, elsewhere)):
        return ""
    if given > _WIDEST * max(wide, elsewhere):
        return (
            f"boxes are {given:.2f} as wide as high, and whole people {max(wide, elsewhere):.2f}; "
            "they must be left, top, width and height, and no corners"
        )
    if abs(math.log(elsewhere / wide)) < _LEAST_APART:
        return ""
    if math.log(given / wide) / math.log(elsewhere / wide) < _NEAR_OTHER:
        return ""
    return (
        f"boxes are {given:.2f} as wide as high, the truth's {CALLED[by.boxes]} {wide:.2f} and its "
        f"{CALLED[other]} {elsewhere:.2f}; --boxes {other} holds them against those"
    )
