"""What was true in the image of one camera: truth/CAMERA.gt.txt and truth/CAMERA.parquet of a run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.tables import TRUTH, Row, truth_rows, write_table
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.tracker.evaluation.mot_files import truth_line


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
