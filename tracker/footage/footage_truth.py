"""Ground truth of recorded footage: VOT, OTB, MOTChallenge, KITTI and VisDrone."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.kitti_files import is_kitti
from peopleboy.tracker.evaluation.mot_files import WIDTHS, read_annotations
from peopleboy.tracker.evaluation.protocols import (
    CLASS,
    EMPTY,
    FLAG,
    RULES,
    VEHICLE,
    VISIBLE,
    Protocol,
    Surroundings,
    apply_protocol,
    named_protocol,
)
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.image_sequences import beside
from peopleboy.tracker.footage.sequence_info import NAME as INFO
from peopleboy.tracker.footage.sequence_info import sequence_name
from peopleboy.user_files import read_json, read_text

# Implausible truth causes a note rather than an error: it may be correct.

_MOST_OUTSIDE: Final = 0.1  # share of boxes that are entirely beyond the pictures' right or lower edge
_LEAST_SPREAD: Final = 0.25  # of the width: a smaller spread of boxes may be real


def frames_before(frame: Floats, numbers: range | None, path: Path, notes: list[str]) -> int:
    """Return the offset to subtract from frames of the truth, so that 1 is the first picture.

    Args:
        frame: (N,) frames of the truth.
        numbers: consecutive numbers in the pictures' names; None if there are none.
        path: of the truth file.
        notes: list to which a note is added if the numbers do not start with 1.
    """
    if numbers is None or numbers[0] == 1 or not len(frame):
        return 0
    first, last = numbers[0], numbers[-1]
    is_among = np.isin(frame, np.asarray(numbers)).all() and (first > 1 or frame.min() == first)
    if not is_among:
        notes.append(f"{path}: frame 1 is taken for the first picture, which has number {first}")
        return 0
    notes.append(
        f"{path}: frames are taken for the pictures' numbers, {first} to {last}; ours are counted from 1"
    )
    return first - 1


def doubts(truth: TrueBoxes, width: int, height: int) -> list[str]:
    """Add a note if boxes seem to belong to pictures of another size.

    Partly visible people are not counted, as most people near the camera are; nor are boxes that all lie in a
    small part of the upper left.
    """
    if not len(truth):
        return []
    left, top, wide, high = truth.box.T
    right, bottom = float((left + wide).max()), float((top + high).max())
    is_outside = (left > width) | (top > height)
    spread = right - float(left.min())
    if is_outside.mean() > _MOST_OUTSIDE:
        what = f"{is_outside.mean():.0%} of the boxes are outside"
    elif right <= width / 2.0 and bottom <= height / 2.0 and spread >= _LEAST_SPREAD * width:
        what = "all boxes are in the upper left quarter"
    else:
        return []
    return [
        f"truth: {what} of the pictures, which are {width}x{height}: they reach to "
        f"{right:.0f}, {bottom:.0f}; are they of pictures of another size?"
    ]


# Formats are recognised by the form of their lines: MOTChallenge, or one box or polygon per image.

_AS_POLYGON: Final = (8, 10)  # lengths of a line that occur in both formats


def cells_of(line: str) -> list[str]:
    """Split a line at commas, semicolons and white space."""
    return [cell for cell in re.split(r"[,;\s]+", line.strip()) if cell]


def is_motchallenge(lines: Sequence[str], path: Path) -> bool:
    """Return whether a file is in MOTChallenge's format, by its lines; an empty one is.

    Lines of 6, 7 and 9 numbers always are. Lines of 8 and 10 numbers can be the corners of a polygon; they
    are in MOTChallenge's format if all begin with two integers, frame and id, have a share as the seventh
    number, and are not upright rectangles.

    Raises:
        BadInput: the format is ambiguous: frames rise from 0 or 1 for each id, with another seventh number.
    """
    count = len(cells_of(lines[0])) if lines else WIDTHS[0]
    if count not in _AS_POLYGON:
        return count in WIDTHS
    table = _numbers(lines, count)
    if table is None or not _are_keys(table[:, :2]) or _are_upright(table):
        return False
    if (np.abs(table[:, 6]) <= 1.0).all():
        return True
    if _rise(table[:, :2]):
        raise BadInput(
            f"{path}: lines of {count} numbers that begin with whole ones may be MOTChallenge's or polygons; "
            "give the former's first six (frame, id, left, top, width, height), or x,y,w,h of one person"
        )
    return False


def _numbers(lines: Sequence[str], count: int) -> Floats | None:
    """Read all lines (N, count); None if a line has another length, or is not numeric."""
    rows = [cells_of(line) for line in lines]
    if any(len(row) != count for row in rows):
        return None
    try:
        return np.array(rows, dtype=np.float64)
    except ValueError:
        return None


def _are_keys(keys: Floats) -> bool:
    """Return whether rows (N, 2) can be frame and id; detections have -1."""
    return bool((keys == np.floor(keys)).all() and (keys >= (0.0, -1.0)).all())


def _are_upright(table: Floats) -> bool:
    """Return whether rows (N, count) are the corners of upright rectangles, from any corner on."""
    if table.shape[1] != 8:
        return False
    # Along one edge one of the differences to the next corner is 0, and along the next edge the other one.
    corners = table.reshape(-1, 4, 2)
    still = np.roll(corners, -1, axis=1) == corners  # (N, 4, 2)
    first_across = still[:, ::2, 1].all(axis=1) & still[:, 1::2, 0].all(axis=1)
    first_down = still[:, ::2, 0].all(axis=1) & still[:, 1::2, 1].all(axis=1)
    return bool((first_across | first_down).all())


def _rise(keys: Floats) -> bool:
    """Return whether the frames of each id rise, from 0 or 1 on in all."""
    frame, identity = keys[np.argsort(keys[:, 1], kind="stable")].T
    is_same = np.diff(identity) == 0.0
    return bool(frame.min() <= 1.0 and (np.diff(frame)[is_same] > 0.0).all())


KEPT_SINGLE: Final = Path("truth") / "groundtruth.txt"
"""Where a run keeps the original truth of a single person, as its format marks it as such."""
NAMES: Final = (
    "groundtruth.txt",
    "groundtruth_rect.txt",
    "gt/gt.txt",
    "gt.txt",
    "truth/gt.txt",
    str(KEPT_SINGLE),
)
"""Where the truth lies relative to the pictures: VOT, OTB, MOTChallenge (twice), a run of ours."""
_EXACT: Final = "truth.parquet"  # of a simulated run, in which people may be fully occluded


@dataclass(frozen=True, slots=True, eq=False)
class GivenTruth:
    """Ground truth of footage.

    Attributes:
        truth: the boxes.
        is_single: whether only one person is annotated.
        path: the file.
        notes: reinterpretations, to be reported once.
        protocol: which people are scored.
        around: what is annotated besides people.
        table: (N, 9) all annotations, with frames counted from the first picture; None for a single person.
    """

    truth: TrueBoxes
    is_single: bool
    path: Path
    notes: tuple[str, ...] = ()
    protocol: Protocol = Protocol.PEOPLEBOY
    around: Surroundings = EMPTY
    table: Floats | None = None

    @property
    def min_visible(self) -> float | None:
        """Least visible fraction by the protocol; None if all people are scored."""
        return RULES[self.protocol].min_visible

    def box_at(self, frame: int) -> tuple[float, float, float, float]:
        """Return the box of the first person in a frame.

        Raises:
            BadInput: there is none.
        """
        boxes = self.truth.box[self.truth.frame == frame]
        if not len(boxes):
            raise BadInput(f"{self.path}: frame {frame} has no box to start from")
        left, top, width, height = boxes[0].tolist()
        return left, top, width, height


def find_truth(footage: Path) -> Path | None:
    """Return the truth file next to the pictures, in their folder or the one above, or None."""
    places = [home / name for home in beside(footage) for name in NAMES]
    return next((path for path in places if path.is_file()), None)


def load_truth(
    path: Path,
    frames: int | None,
    numbers: range | None = None,
    protocol: Protocol | None = None,
    tracks: Path | None = None,
) -> GivenTruth:
    """Read a truth file; the format is recognised by its lines.

    Lines of 4 numbers are x, y, w, h (OTB, VOT), lines of 8 or more even numbers a polygon (VOT), one line
    per frame; NaN or an empty box marks a frame without the person. Lines of 6 to 10 numbers that begin with
    frame and id, an empty file and a gt.txt are MOTChallenge's or VisDrone's; lines with a word are KITTI's.

    Args:
        path: the file.
        frames: number of pictures, which the lines of a single person must match; None if unknown.
        numbers: those in the pictures' names, which MOTChallenge's frames may use; None if there are none.
        protocol: which people are scored; None for the protocol of the file's benchmark.
        tracks: file of the tracks that are scored, whose name may mention the benchmark.

    Raises:
        BadInput: the file cannot be read, or does not match the pictures.
    """
    if not path.exists():
        raise BadInput(f"{path}: no such file")
    try:
        lines = read_text(path, "utf-8-sig").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: cannot be read as truth; give a text file of boxes") from error
    while lines and not lines[-1].strip():
        lines.pop()
    if path.name == "gt.txt" or (lines and is_kitti(lines[0])) or is_motchallenge(lines, path):
        return _of_everybody(path, frames, numbers, protocol, tracks)
    boxes = [_box(line, f"{path}:{number}") for number, line in enumerate(lines, start=1)]
    if frames is not None and len(boxes) != frames:
        raise BadInput(f"{path}: must have a line for each of the {frames} pictures, got {len(boxes)}")
    return GivenTruth(_single(boxes), is_single=True, path=path)


def _of_everybody(
    path: Path, frames: int | None, numbers: range | None, asked: Protocol | None, tracks: Path | None
) -> GivenTruth:
    """Read the truth of all people. If none is ever visible, fractions are missing, except in our runs."""
    stated = asked or _protocol_of_run(path.parent.parent)
    named = stated or _named(path, tracks)
    rows, of_format, is_per_cent = read_annotations(path, named)
    notes, is_own = list[str](), stated is Protocol.PEOPLEBOY
    if is_per_cent:
        notes.append(f"{path}: the visible fraction is taken for per cent")
    if not len(rows) and not is_own:
        notes.append(f"{path}: it is empty: no person is visible in any frame")
    rows[:, 0] -= frames_before(rows[:, 0], numbers, path, notes)
    if len(rows) and not rows[:, VISIBLE].any() and not is_own:
        rows[:, VISIBLE] = 1.0
        notes.append(f"{path}: the visible fraction is 0 in all lines; it is taken as missing")
    protocol = stated or of_format or named or Protocol.MOT17
    if stated is None and _matters(rows):
        notes.append(_describe(path, protocol, rows, is_known=bool(of_format or named)))
    truth, around = apply_protocol(path, rows, RULES[protocol])
    last = int(rows[:, 0].max(initial=0.0))
    if frames is not None and last > frames:
        raise BadInput(f"{path}: must end with frame {frames}, the last picture, got {last}")
    return GivenTruth(
        truth,
        is_single=False,
        path=path,
        notes=tuple(notes),
        protocol=protocol,
        around=around,
        table=rows,
    )


def _protocol_of_run(folder: Path) -> Protocol | None:
    """Return the protocol that a run was scored by; None for a folder that is none of our runs."""
    if (folder / _EXACT).is_file():
        return Protocol.PEOPLEBOY
    try:
        about = read_json(folder / "run.json")
        return Protocol(about.get("protocol", Protocol.PEOPLEBOY))
    except (OSError, ValueError, AttributeError):
        return None


def _named(path: Path, tracks: Path | None) -> Protocol | None:
    """Return the protocol that a sequence's description or the paths of the files mention."""
    info = next((each for each in (home / INFO for home in path.parents[:2]) if each.is_file()), None)
    parts = [*(() if tracks is None else tracks.resolve().parts), *path.resolve().parts]
    return named_protocol([*parts, "" if info is None else sequence_name(info)])


def _matters(rows: Floats) -> bool:
    """Return whether protocols differ on rows (N, 9): other classes, or people flagged or hidden."""
    return bool((rows[:, FLAG:] != 1.0)[:, :2].any() or (rows[:, VISIBLE] == 0.0).any())


def _describe(path: Path, protocol: Protocol, rows: Floats, *, is_known: bool) -> str:
    why = "as its path or format says" if is_known else "as nothing names another benchmark"
    is_there = (rows[:, CLASS] == VEHICLE).any() and protocol is Protocol.MOT17
    also = f" (class {VEHICLE} is a distractor in mot20 only)" if is_there else ""
    return f"{path}: scored by the protocol {protocol}, {why}{also}; --protocol chooses another"


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
    """Make the truth of one person from a box (4,) per frame."""
    table = np.array(boxes, dtype=np.float64).reshape(-1, 4)
    is_there = np.isfinite(table).all(axis=1) & (table[:, 2:] > 0).all(axis=1)
    frame = np.flatnonzero(is_there) + 1
    ones = np.ones(len(frame))
    return TrueBoxes(
        frame=frame, id=ones.astype(np.int64), box=table[is_there], counted=ones > 0, visible=ones
    )
