"""Truth and tracks as MOTChallenge text: one line per box, comma separated, frames from 1.

Truth: frame, id, left, top, width, height, 1 if counted else 0, class, visible fraction. Ours has
class 1 (person) alone; of the other classes of MOT16 to MOT20, those that do not count are read as such.
Results: frame, id, left, top, width, height, confidence, -1, -1, -1 (no world position).
An empty file is a sequence without people, or a tracker that found nobody.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Rows, TrackBoxes, TrueBoxes, find_fault

TRUTH_COLUMNS = "frame, id, left, top, width, height, counted, class, visible fraction"
TRACKS_COLUMNS = "frame, id, left, top, width, height, confidence, x, y, z"
PERSON = 1
DISTRACTORS = (2, 7, 8, 12)  # person on vehicle, static person, distractor, reflection
CLASSES = range(1, 14)

Kind = TypeVar("Kind", bound=Rows)


def read_truth(path: Path, *, keeps_things: bool = False) -> TrueBoxes:
    """Read a truth file (`gt.txt`); distractors do not count, and things are left out, as in TrackEval.

    Args:
        path: the file.
        keeps_things: whether things stay, without counting, so that a box on one, such as on a bicycle with
            somebody on it, is not wrong either.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    table = _read_table(path, TRUTH_COLUMNS)
    kind = table[:, 7]
    for row in np.flatnonzero(~np.isin(kind, CLASSES))[:1]:
        raise BadInput(f"{path}:{row + 1}: class must be 1 (person) to 13, got {kind[row]:g}")
    is_distractor = (kind != PERSON) if keeps_things else np.isin(kind, DISTRACTORS)
    truth = _build(path, TrueBoxes, table, counted=table[:, 6], visible=table[:, 8])
    if (kind == PERSON).all():
        return truth
    table[is_distractor, 6] = 0.0
    people = table[is_distractor | (kind == PERSON)]
    return _build(path, TrueBoxes, people, counted=people[:, 6], visible=people[:, 8])


def read_tracks(path: Path) -> TrackBoxes:
    """Read a tracker's results (`tracks.txt`); the world position in the last three columns is not kept.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    table = _read_table(path, TRACKS_COLUMNS)
    return _build(path, TrackBoxes, table, confidence=table[:, 6])


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
    """Give the line of one person in one frame, newline included."""
    return f"{_start(frame, identity, box)},{counted:d},1,{visible:.4f}\n"


def track_line(frame: int, identity: int, box: Sequence[float], confidence: float) -> str:
    """Give the line of one track in one frame, newline included."""
    return f"{_start(frame, identity, box)},{confidence:.4f},-1,-1,-1\n"


def _read_table(path: Path, names: str) -> Floats:
    """Read the lines as numbers (N, number of names)."""
    columns = names.count(",") + 1
    try:
        lines = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise BadInput(f"{path}: cannot be read as MOTChallenge text: {reason}") from error
    if not lines[-1]:
        lines.pop()  # the newline that ends the last line
    table = [_parse_line(line, names, columns, f"{path}:{number}") for number, line in enumerate(lines, 1)]
    return np.array(table, dtype=np.float64).reshape(-1, columns)


def _parse_line(line: str, names: str, columns: int, where: str) -> list[float]:
    cells = line.split(",")
    if len(cells) != columns:
        raise BadInput(f"{where}: must have {columns} numbers ({names}), got {len(cells)}: {line[:60]!r}")
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        raise BadInput(f"{where}: must be numbers ({names}), got {line[:60]!r}") from None


def _build(path: Path, kind: type[Kind], table: Floats, **others: Floats) -> Kind:
    """Build the record from the table, naming the line of the first impossible row."""
    columns: dict[str, Any] = {"frame": table[:, 0], "id": table[:, 1], "box": table[:, 2:6], **others}
    fault = find_fault(columns)
    if fault is not None:
        raise BadInput(f"{path}:{fault[0] + 1}: {fault[1]}")
    return kind(**columns)


def _start(frame: int, identity: int, box: Sequence[float]) -> str:
    """Format the columns that both kinds of file begin with."""
    edges = ",".join(f"{edge:z.2f}" for edge in box)  # z: never -0.00
    return f"{frame},{identity},{edges}"


def _write_lines(path: Path, lines: list[str]) -> None:
    try:
        path.write_text("".join(lines), encoding="utf-8", newline="\n")
    except OSError as error:
        raise BadInput(f"{path}: cannot be written: {error.strerror}") from error
