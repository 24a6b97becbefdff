"""Ground truth that comes with footage: VOT, OTB and MOTChallenge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.mot_files import read_rows, truth_of
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.pictures import beside
from peopleboy.tracker.footage.truth_doubts import frames_before
from peopleboy.tracker.footage.truth_lines import cells_of, is_motchallenge

KEPT_SINGLE: Final = Path("truth") / "groundtruth.txt"
"""Where a run of ours keeps truth of a single person, as it was given: the format says that it is one."""
NAMES: Final = (
    "groundtruth.txt",
    "groundtruth_rect.txt",
    "gt/gt.txt",
    "gt.txt",
    "truth/gt.txt",
    str(KEPT_SINGLE),
)
"""Where the truth lies beside or above the pictures: VOT, OTB, MOTChallenge (twice), a run of ours."""
_EXACT: Final = "truth.parquet"  # of a run of ours, in which people may be hidden all the time


@dataclass(frozen=True, slots=True, eq=False)
class GivenTruth:
    """The truth of some footage.

    Attributes:
        truth: the boxes.
        is_single: whether one person alone is annotated, whoever else is there.
        path: the file.
        notes: what was taken as something else than it is, to be told once.
    """

    truth: TrueBoxes
    is_single: bool
    path: Path
    notes: tuple[str, ...] = ()

    def box_at(self, frame: int) -> tuple[float, float, float, float]:
        """Give the box of the first person in a frame.

        Raises:
            BadInput: there is none.
        """
        boxes = self.truth.box[self.truth.frame == frame]
        if not len(boxes):
            raise BadInput(f"{self.path}: there is no box in frame {frame} to start from")
        left, top, width, height = boxes[0].tolist()
        return left, top, width, height


def find_truth(footage: Path) -> Path | None:
    """Look for truth beside the pictures, in their folder or the one above; None if there is none."""
    places = [home / name for home in beside(footage) for name in NAMES]
    return next((path for path in places if path.is_file()), None)


def load_truth(path: Path, frames: int | None, numbers: range | None = None) -> GivenTruth:
    """Read a truth file; its format follows from its lines.

    Lines of 4 numbers are x, y, w, h (OTB, VOT), of 8 or more even numbers a polygon (VOT), one line a frame,
    a line of NaN or of an empty box a frame without the person. Lines of 6 to 10 numbers that begin with
    frame and id, an empty file and a gt.txt are MOTChallenge's.

    Args:
        path: the file.
        frames: number of pictures, which lines of a single person must equal; None if unknown.
        numbers: those in the pictures' names, which frames of MOTChallenge may be; None if they tell none.

    Raises:
        BadInput: the file cannot be read, or does not belong to the pictures.
    """
    if not path.exists():
        raise BadInput(f"{path}: there is no such file")
    try:
        lines = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: cannot be read as truth; give a text file of boxes") from error
    while lines and not lines[-1].strip():
        lines.pop()
    if path.name == "gt.txt" or is_motchallenge(lines, path):
        return _of_everybody(path, frames, numbers)
    boxes = [_box(line, f"{path}:{number}") for number, line in enumerate(lines, start=1)]
    if frames is not None and len(boxes) != frames:
        raise BadInput(f"{path}: must have a line for each of the {frames} pictures, got {len(boxes)}")
    return GivenTruth(_single(boxes), is_single=True, path=path)


def _of_everybody(path: Path, frames: int | None, numbers: range | None) -> GivenTruth:
    """Read MOTChallenge's lines; nobody ever visible means that it was not told, but in runs of ours."""
    rows, notes, is_own = read_rows(path), list[str](), (path.parent.parent / _EXACT).is_file()
    if not len(rows) and not is_own:
        notes.append(f"{path}: it is empty, which says that nobody is there")
    rows[:, 0] -= frames_before(rows[:, 0], numbers, path, notes)
    if len(rows) and not rows[:, 8].any() and not is_own:
        rows[:, 8] = 1.0
        notes.append(f"{path}: the visible fraction is 0 in all lines; it is taken as not told")
    truth = truth_of(path, rows)
    if frames is not None and truth.last_frame > frames:
        raise BadInput(f"{path}: must end with frame {frames}, the last picture, got {truth.last_frame}")
    return GivenTruth(truth, is_single=False, path=path, notes=tuple(notes))


def _box(line: str, where: str) -> NDArray[np.float64]:
    """Read one line as left, top, width, height (4,)."""
    cells = cells_of(line)
    try:
        numbers = np.array([float(cell) for cell in cells], dtype=np.float64)
    except ValueError:
        raise BadInput(f"{where}: must be numbers (x,y,w,h or a polygon), got {line[:60]!r}") from None
    if len(numbers) == 4:
        return numbers
    if len(numbers) < 6 or len(numbers) % 2:
        raise BadInput(f"{where}: must be x,y,w,h or the corners of a polygon, got {len(numbers)} numbers")
    corners = numbers.reshape(-1, 2)
    return np.concatenate([corners.min(axis=0), np.ptp(corners, axis=0)])


def _single(boxes: list[NDArray[np.float64]]) -> TrueBoxes:
    """Make the truth of one person from a box (4,) a frame."""
    table = np.array(boxes, dtype=np.float64).reshape(-1, 4)
    is_there = np.isfinite(table).all(axis=1) & (table[:, 2:] > 0).all(axis=1)
    frame = np.flatnonzero(is_there) + 1
    ones = np.ones(len(frame))
    return TrueBoxes(
        frame=frame, id=ones.astype(np.int64), box=table[is_there], counted=ones > 0, visible=ones
    )
