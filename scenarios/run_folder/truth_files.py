"""Write and read the truth of further cameras and of things in a run."""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Final, TextIO

import numpy as np

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.image_files import millimetres, write_png
from peopleboy.scenarios.run_folder.run_files import WRITTEN_TRUTH, read_table, written_truth
from peopleboy.scenarios.run_folder.run_tables import (
    BOOL,
    FLOAT,
    INT,
    STRING,
    TRUTH,
    Row,
    TableColumns,
    box,
    numbers,
    plain,
    row_of,
    schema_of,
    truth_rows,
    write_table,
)
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.sim.truth.truth import Backgrounds
from peopleboy.tracker.evaluation.mot_files import read_truth, truth_line
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind

_WHOLE = ("whole_left_px", "whole_top_px", "whole_width_px", "whole_height_px")


def further_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Name the cameras with boxes beside `thermal`, of which truth.parquet and truth/gt.txt speak."""
    return tuple(name for name in with_boxes(cameras) if name != "thermal")


class CameraTruth:
    """Writes the truth of one camera, of the frames in which it took an image."""

    def __init__(self, folder: Path, camera: str) -> None:
        self._camera = camera
        self._table = folder / f"{camera}.parquet"
        self._rows: list[Row] = []
        self._lines = open_text(folder / f"{camera}.gt.txt")

    def write(self, tick: Tick) -> None:
        """Write what is true at one tick."""
        if self._camera in tick.truths:
            self._rows += truth_rows(tick, self._camera)
            self._lines.writelines(gt_lines(tick, self._camera))

    def flush(self) -> None:
        """Bring text and table to disk."""
        self._lines.flush()
        write_table(self._table, self._rows, TRUTH)

    def close(self) -> None:
        """Bring both to disk, and close the text."""
        self.flush()
        self._lines.close()


def truth_files(folder: Path, camera: str) -> tuple[Path, Path]:
    """Name the text and the table of a camera's truth in a run's folder."""
    if camera == "thermal":
        return folder / "truth" / "gt.txt", folder / "truth.parquet"
    return folder / "truth" / f"{camera}.gt.txt", folder / "truth" / f"{camera}.parquet"


def true_boxes(text: Path, table: Path, kind: BoxKind) -> TrueBoxes:
    """Read who was there: boxes round torsos are in the text, those round whole people in the table alone.

    Whole ones are those of the silhouette as if nothing hid it, also outside the image.

    Raises:
        BadInput: the file is missing or spoilt.
    """
    if kind is BoxKind.TORSO:
        return read_truth(text)
    columns = (*WRITTEN_TRUTH, "is_counted", "visible_fraction", *_WHOLE)
    people = written_truth(read_table(table, TRUTH, columns))
    people = people.filter(people["whole_left_px"].is_valid())
    return TrueBoxes(
        frame=people["frame"].to_numpy(),
        id=people["id"].to_numpy(),
        box=np.stack([people[name].to_numpy() for name in _WHOLE], axis=-1),
        counted=people["is_counted"].to_numpy(zero_copy_only=False),
        visible=people["visible_fraction"].to_numpy(),
    )


def gt_lines(tick: Tick, camera: str = "thermal") -> list[str]:
    """MOTChallenge truth of everybody whose silhouette reaches into a camera's image: a line a person."""
    return [
        truth_line(tick.frame, person.id, person.box, person.is_counted, person.visible_fraction)
        for person in tick.truths[camera].people
        if person.box is not None and person.is_in_image
    ]


def open_text(path: Path) -> TextIO:
    """Open a file of lines to write."""
    return path.open("w", encoding="utf-8", newline="\n")


_THING: Final[TableColumns] = {
    **plain(STRING, "name"),
    **numbers(("x_m", "y_m", "z_m"), attrgetter("position_m")),
    **plain(FLOAT, "heading_rad"),
    **plain(BOOL, "is_there", "is_moving"),
    **plain(STRING, "moved_by"),
    **plain(INT, "visible_px"),
    **box("", "visible_box"),
}
THINGS: Final = schema_of(_THING)


def things_camera(cameras: Mapping[str, CameraConfig]) -> str:
    """Name the camera in whose image things are described: the first depth camera, else `thermal`."""
    return next(iter(depth_cameras(cameras)), "thermal")


def depth_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Name the cameras that measure depth."""
    return tuple(name for name, config in cameras.items() if isinstance(config, DepthConfig))


class ThingFiles:
    """Writes the truth about things, of a run in which some are moved.

    Args:
        folder: truth/ of the run.
        cameras: of the robot.
        frames: whether images are written, and with them the backgrounds of depth cameras.
    """

    def __init__(self, folder: Path, cameras: Mapping[str, CameraConfig], *, frames: bool) -> None:
        self._folder = folder
        self._camera = things_camera(cameras)
        self._rows: list[Row] = []
        self._has_things = False
        self._backgrounds = {name: Backgrounds() for name in depth_cameras(cameras)} if frames else {}

    def write(self, tick: Tick) -> None:
        """Take in what is true at one tick."""
        if tick.truth.things and self._camera in tick.truths:
            self._has_things = True
            self._rows += [
                row_of(_THING, tick.frame, tick.truth.time_s, thing)
                for thing in tick.truths[self._camera].things
            ]
        for name, backgrounds in self._backgrounds.items():
            if name in tick.truths:
                backgrounds.update(tick.truths[name])

    def flush(self) -> None:
        """Bring everything to disk."""
        if self._has_things:
            write_table(self._folder / "things.parquet", self._rows, THINGS)
        for name, backgrounds in self._backgrounds.items():
            for kind, depth in (("clean", backgrounds.clean), ("ever", backgrounds.ever)):
                if depth is not None:
                    write_png(self._folder / f"{name}_{kind}.png", millimetres(depth))
