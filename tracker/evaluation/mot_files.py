"""Ground truth and tracks as MOTChallenge text: one line per box, comma separated, frames from 1.

Truth: frame, id, left, top, width, height, 1 if counted else 0, class, visible fraction. PeopleBoy writes
class 1 (person) only. Of the other classes of MOT16 to MOT20, distractors are read as uncounted. If the last
columns are missing, or -1 for unknown, all lines are counted and visible people. Lines of ten numbers end
with a world position instead of class and visible fraction, as in MOT15.

Results: frame, id, left, top, width, height, confidence, -1, -1, -1 (no world position). The last three may
be missing.

Detections: frame, -1, left, top, width, height, score, -1, -1, -1. What follows the height may be missing;
score -1 means that there is none, unless other scores are negative, too.

Values may be separated by white space instead, as in some trackers' results.

An empty file is a sequence without people, a tracker without tracks, or a detector without detections.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Ints, Rows, TrackBoxes, TrueBoxes, find_fault

TRUTH_COLUMNS = "frame, id, left, top, width, height, counted, class, visible fraction"
TRACKS_COLUMNS = "frame, id, left, top, width, height, confidence, x, y, z"
DETECTION_COLUMNS = "frame, -1, left, top, width, height, score"
PERSON = 1
DISTRACTORS = (2, 7, 8, 12)  # person on vehicle, static person, distractor, reflection
CLASSES = range(1, 14)
WIDTHS = range(6, 11)
"""Allowed numbers of values per line of truth, and of detections."""
TRACK_WIDTHS = range(7, 11)
"""Allowed numbers of values per line of results."""

_PLACED = 10  # values of a line with a position, of which the first 7 are read
_UNKNOWN = -1.0

Kind = TypeVar("Kind", bound=Rows)


def read_truth(path: Path, *, keeps_things: bool = False) -> TrueBoxes:
    """Read a truth file (`gt.txt`); distractors are uncounted, and objects are removed, as in TrackEval.

    Args:
        path: the file.
        keeps_things: whether objects are kept as uncounted, so that a box on one, such as on a bicycle with a
            person on it, is not a false positive.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    return truth_of(path, read_rows(path), keeps_things=keeps_things)


def read_rows(path: Path) -> Floats:
    """Read the lines of a truth file as numbers (N, 9), without interpreting them.

    Missing values are 1: counted, person, visible.

    Raises:
        BadInput: the file cannot be read, or a line is not numeric, or has another length than the first.
    """
    given = _read_table(path, TRUTH_COLUMNS, WIDTHS)
    columns = TRUTH_COLUMNS.count(",") + 1
    given = given[:, : 7 if given.shape[1] == _PLACED else columns]
    table = np.ones((len(given), columns))
    table[:, : given.shape[1]] = given
    others = table[:, 6:]
    others[others == _UNKNOWN] = 1.0
    return table


def truth_of(path: Path, table: Floats, *, keeps_things: bool = False) -> TrueBoxes:
    """Make ground truth from the rows (N, 9) of a file, as `read_truth` does.

    Raises:
        BadInput: a row is impossible (the message names its line).
    """
    kind = table[:, 7]
    for row in np.flatnonzero(~np.isin(kind, CLASSES))[:1]:
        raise BadInput(f"{path}:{row + 1}: class must be 1 (person) to 13, got {kind[row]:g}")
    is_distractor = (kind != PERSON) if keeps_things else np.isin(kind, DISTRACTORS)
    truth = _build(path, TrueBoxes, table, counted=table[:, 6], visible=table[:, 8])
    if (kind == PERSON).all():
        return truth
    counted = np.where(is_distractor, 0.0, table[:, 6])
    is_there = is_distractor | (kind == PERSON)
    people = table[is_there]
    return _build(path, TrueBoxes, people, counted=counted[is_there], visible=people[:, 8])


def read_tracks(path: Path) -> TrackBoxes:
    """Read a tracker's results (`tracks.txt`), without the world position in the last three columns.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    table = _read_table(path, TRACKS_COLUMNS, TRACK_WIDTHS)
    return _build(path, TrackBoxes, table, confidence=table[:, 6])


class DetectionRows(NamedTuple):
    """The detections of a sequence.

    Attributes:
        frame: (N,) from 1.
        box: (N, 4) [px] left, top, width, height; sizes above 0.
        score: (N,) in any scale; NaN for a detection without a score.
    """

    frame: Ints
    box: Floats
    score: Floats

    @property
    def last_frame(self) -> int:
        """The last frame with a detection; 0 without detections."""
        return int(self.frame.max(initial=0))


def read_detections(path: Path) -> DetectionRows:
    """Read a file of detections (`det.txt`).

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    table = _read_table(path, DETECTION_COLUMNS, WIDTHS)
    frame, box = table[:, 0], table[:, 2:6]
    score = table[:, 6] if table.shape[1] > DETECTION_COLUMNS.count(",") else np.full(len(table), _UNKNOWN)
    fault = find_fault({"frame": frame, "box": box, "confidence": score})
    if fault is not None:
        raise BadInput(f"{path}:{fault[0] + 1}: {fault[1]}")
    for row in np.flatnonzero((box[:, 2:] == 0.0).any(axis=1))[:1]:
        raise BadInput(f"{path}:{row + 1}: width and height must be above 0, got {box[row, 2:].tolist()}")
    is_unknown = (score == _UNKNOWN) & ((score >= 0.0) | (score == _UNKNOWN)).all()
    return DetectionRows(frame.astype(np.int64), box, np.where(is_unknown, np.nan, score))


def write_truth(path: Path, truth: TrueBoxes) -> None:
    """Write a truth file: boxes with 2 decimals, the visible fraction with 4; equal truth gives equal bytes.

    Raises:
        BadInput: the file cannot be written.
    """
    columns = (truth.frame, truth.id, truth.box, truth.counted, truth.visible)
    _write_lines(path, [truth_line(*row) for row in zip(*columns, strict=True)])


def write_tracks(path: Path, tracks: TrackBoxes) -> None:
    """Write a tracker's results: boxes with 2 decimals, the confidence with 4; equal tracks give equal bytes.

    Raises:
        BadInput: the file cannot be written.
    """
    columns = (tracks.frame, tracks.id, tracks.box, tracks.confidence)
    _write_lines(path, [track_line(*row) for row in zip(*columns, strict=True)])


def truth_line(frame: int, identity: int, box: Sequence[float], counted: bool, visible: float) -> str:
    """Return the line of one person in one frame, newline included."""
    return f"{_start(frame, identity, box)},{counted:d},1,{visible:.4f}\n"


def track_line(frame: int, identity: int, box: Sequence[float], confidence: float) -> str:
    """Return the line of one track in one frame, newline included."""
    return f"{_start(frame, identity, box)},{confidence:.4f},-1,-1,-1\n"


def detection_line(frame: int, box: Sequence[float], score: float) -> str:
    """Return the line of one detection in one frame, newline included."""
    return track_line(frame, -1, box, score)


def _read_table(path: Path, names: str, widths: range) -> Floats:
    """Read the lines as numbers; all must have the first line's length, which must be one of these."""
    try:
        lines = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise BadInput(f"{path}: cannot be read as MOTChallenge text: {reason}") from error
    while lines and not lines[-1].strip():
        lines.pop()  # the newline after the last line, and trailing empty lines
    count = len(_cells_of(lines[0])) if lines else widths[-1]
    if count in widths:
        widths = range(count, count + 1)
    table = [_parse_line(line, names, widths, f"{path}:{number}") for number, line in enumerate(lines, 1)]
    return np.array(table, dtype=np.float64).reshape(-1, count)


def _parse_line(line: str, names: str, widths: range, where: str) -> list[float]:
    cells = _cells_of(line)
    if len(cells) not in widths:
        wanted = f"{widths[0]} to {widths[-1]}" if len(widths) > 1 else f"{widths[0]}"
        raise BadInput(
            f"{where}: must have {wanted} numbers, comma separated ({names}), got {len(cells)}: {line[:60]!r}"
        )
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        raise BadInput(f"{where}: must be numbers ({names}), got {line[:60]!r}") from None


def _cells_of(line: str) -> list[str]:
    return line.split(",") if "," in line else line.split()


def _build(path: Path, kind: type[Kind], table: Floats, **others: Floats) -> Kind:
    """Make the record from the table; errors name the line of the first invalid row."""
    columns: dict[str, Any] = {"frame": table[:, 0], "id": table[:, 1], "box": table[:, 2:6], **others}
    fault = find_fault(columns)
    if fault is not None:
        raise BadInput(f"{path}:{fault[0] + 1}: {fault[1]}")
    return kind(**columns)


def _start(frame: int, identity: int, box: Sequence[float]) -> str:
    """Format the first columns of both kinds of file."""
    edges = ",".join(f"{edge:z.2f}" for edge in box)  # z: never -0.00
    return f"{frame},{identity},{edges}"


def _write_lines(path: Path, lines: list[str]) -> None:
    try:
        path.write_text("".join(lines), encoding="utf-8", newline="\n")
    except OSError as error:
        raise BadInput(f"{path}: cannot be written: {error.strerror}") from error
