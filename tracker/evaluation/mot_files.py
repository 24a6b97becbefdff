"""Ground truth and tracks as MOTChallenge text: one line per box, comma separated, frames from 1.

Truth: frame, id, left, top, width, height, 1 if counted else 0, class, visible fraction. PeopleBoy writes
class 1 (person) only. If the last columns are missing, or -1 for unknown, all lines are counted and visible
people. Lines of ten numbers end with a world position instead of class and visible fraction, as in MOT15, or
are VisDrone's. A protocol says which classes and people are scored.

Results: frame, id, left, top, width, height, confidence, and what a tracker adds, which is not read. A
missing confidence is 1.

Detections: frame, -1, left, top, width, height, score, -1, -1, -1. What follows the height may be missing;
score -1 means that there is none, unless other scores are negative, too.

Values may be separated by white space instead, and a line may end with a comma. Truth and results in KITTI's
format are recognised by the word in the third column.

An empty file is a sequence without people, a tracker without tracks, or a detector without detections.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.kitti_files import is_kitti, kitti_tracks, kitti_truth, own_ids
from peopleboy.tracker.evaluation.protocols import (
    CLASSES,
    CROWD,
    DISTRACTOR,
    FLAG,
    PERSON,
    RULES,
    VISIBLE,
    Protocol,
    Rules,
    apply_protocol,
)
from peopleboy.tracker.evaluation.sequence import Ints, Rows, TrackBoxes, TrueBoxes, find_fault
from peopleboy.user_files import read_text

TRUTH_COLUMNS = "frame, id, left, top, width, height, counted, class, visible fraction"
TRACKS_COLUMNS = "frame, id, left, top, width, height, confidence, ..."
DETECTION_COLUMNS = "frame, -1, left, top, width, height, score"
WIDTHS = range(6, 11)
"""Allowed numbers of values per line of truth, and of detections."""
TRACK_WIDTHS = range(6, 33)
"""Allowed numbers of values per line of results, of which the first seven are read."""

_READ = 7  # values of a line of results, and of a line of truth with a position
_PLACED = 10  # values of a line with a position
_UNKNOWN = -1.0
_PER_CENT = 2.0  # least visible fraction in a file from which all are taken for per cent
_CLASSED_WIDTHS = (8, 9, 11)  # of results that have a class where others have a position

Kind = TypeVar("Kind", bound=Rows)


def read_truth(path: Path, rules: Rules = RULES[Protocol.PEOPLEBOY]) -> TrueBoxes:
    """Read the people of a truth file (`gt.txt`), by default as in a rendered run.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed (the message names the line).
    """
    return apply_protocol(path, read_annotations(path).table, rules)[0]


class Annotations(NamedTuple):
    """The lines of a truth file.

    Attributes:
        table: (N, 9) frame, id, left, top, width, height, flag, class of MOTChallenge, visible fraction.
        protocol: the protocol that the format belongs to; None for MOTChallenge's.
        is_per_cent: whether the visible fractions were given in per cent.
    """

    table: Floats
    protocol: Protocol | None = None
    is_per_cent: bool = False


def read_annotations(path: Path, protocol: Protocol | None = None) -> Annotations:
    """Read the lines of a truth file, without choosing among people. Missing values are 1.

    Args:
        path: the file.
        protocol: what the file belongs to, which settles what lines of ten numbers mean; None if unknown.

    Raises:
        BadInput: the file cannot be read, or a line is not numeric, or has another length than the first.
    """
    lines = _read_lines(path)
    if lines and is_kitti(lines[0]):
        return Annotations(kitti_truth(path, lines), Protocol.KITTI)
    given = _as_table(path, lines, TRUTH_COLUMNS, WIDTHS)
    columns = VISIBLE + 1
    if given.shape[1] == _PLACED:
        if protocol is Protocol.VISDRONE or (protocol is None and _is_visdrone(given)):
            return Annotations(_from_visdrone(given), Protocol.VISDRONE)
        given = given[:, : columns if _has_class(given, protocol) else _READ]
    table = np.ones((len(given), columns))
    table[:, : given.shape[1]] = given[:, :columns]
    others = table[:, FLAG:]
    others[others == _UNKNOWN] = 1.0
    visible = table[:, VISIBLE]
    if is_per_cent := bool(_PER_CENT <= visible.max(initial=0.0) <= 100.0):
        visible /= 100.0
    return Annotations(table, None, is_per_cent)


def _has_class(given: Floats, protocol: Protocol | None) -> bool:
    """Return whether lines of ten numbers (N, 10) have a class and a visible fraction, not a position."""
    if protocol is None or not RULES[protocol].has_classes or protocol is Protocol.PEOPLEBOY:
        return False
    is_share = (given[:, 8] >= 0.0) & (given[:, 8] <= 1.0)
    return bool((np.isin(given[:, 7], CLASSES) & is_share).all())


# VisDrone: frame, id, left, top, width, height, flag, category, truncation (0 or 1), occlusion (0 to 2).

_CATEGORIES: Final = range(12)
_REGION, _PEDESTRIAN, _PEOPLE, _OTHERS = 0, 1, 2, 11
_OCCLUDED: Final = np.array([1.0, 0.75, 0.25])  # middles of the ranges: none, up to a half, more than that


def _is_visdrone(given: Floats) -> bool:
    """Return whether lines of ten numbers (N, 10) are VisDrone's, and no positions."""
    kind, truncated, occluded = given[:, 7:].T
    allowed = np.isin(kind, _CATEGORIES) & np.isin(truncated, (0, 1)) & np.isin(occluded, (0, 1, 2))
    return bool(len(given) and allowed.all() and kind.any())


def _from_visdrone(given: Floats) -> Floats:
    """Return VisDrone's rows (N, 10) as annotations (N, 9) with classes of MOTChallenge."""
    table = given[:, :9].copy()
    category = given[:, 7]
    table[:, 1] = own_ids(given[:, 1], category == _REGION)
    table[:, 7] = np.select(
        [np.isin(category, (_PEDESTRIAN, _PEOPLE)), category == _REGION, category == _OTHERS],
        [PERSON, CROWD, DISTRACTOR],
        default=CLASSES[2],  # a car
    )
    table[:, 8] = _OCCLUDED[given[:, 9].clip(0, 2).astype(np.int64)]
    return table


def read_tracks(path: Path) -> TrackBoxes:
    """Read a tracker's results (`tracks.txt`), without what follows the confidence.

    Raises:
        BadInput: the file cannot be read, one of its lines is malformed, or a box is of another class than
            people (the message names the line).
    """
    lines = _read_lines(path)
    if lines and is_kitti(lines[0]):
        table = kitti_tracks(path, lines)
    else:
        table = _as_table(path, lines, TRACKS_COLUMNS, TRACK_WIDTHS)
        _check_class(path, table)
        table = table[:, :_READ]
    if table.shape[1] < _READ:
        table = np.column_stack([table, np.ones(len(table))])
    return _build(path, TrackBoxes, table, confidence=table[:, FLAG])


def _check_class(path: Path, table: Floats) -> None:
    """Refuse results of several classes, where the eighth value is one."""
    if table.shape[1] not in _CLASSED_WIDTHS:
        return
    for row in np.flatnonzero(table[:, 7] > PERSON)[:1]:
        raise BadInput(
            f"{path}:{row + 1}: class must be 1 (person), got {table[row, 7]:g}; remove the boxes of other "
            f"classes"
        )


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
    table = _as_table(path, _read_lines(path), DETECTION_COLUMNS, WIDTHS)
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


def write_annotations(path: Path, table: Floats) -> None:
    """Write annotations (N, 9) as a truth file, with the decimals of `write_truth`.

    Raises:
        BadInput: the file cannot be written.
    """
    lines = []
    for frame, identity, *box, flag, kind, visible in table.tolist():
        lines.append(truth_line(int(frame), int(identity), box, flag != 0.0, visible, int(kind)))
    _write_lines(path, lines)


def truth_line(
    frame: int, identity: int, box: Sequence[float], counted: bool, visible: float, kind: int = PERSON
) -> str:
    """Return the line of one person, or one object of another class, in one frame, newline included."""
    return f"{_start(frame, identity, box)},{counted:d},{kind},{visible:.4f}\n"


def track_line(frame: int, identity: int, box: Sequence[float], confidence: float) -> str:
    """Return the line of one track in one frame, newline included."""
    return f"{_start(frame, identity, box)},{confidence:.4f},-1,-1,-1\n"


def detection_line(frame: int, box: Sequence[float], score: float) -> str:
    """Return the line of one detection in one frame, newline included."""
    return track_line(frame, -1, box, score)


def _read_lines(path: Path) -> list[str]:
    """Read the lines of a text file, without empty ones at its end.

    Raises:
        BadInput: it cannot be read.
    """
    try:
        lines = read_text(path, "utf-8-sig").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise BadInput(f"{path}: cannot be read as MOTChallenge text: {reason}") from error
    while lines and not lines[-1].strip():
        lines.pop()  # the newline after the last line, and trailing empty lines
    return lines


def _as_table(path: Path, lines: Sequence[str], names: str, widths: range) -> Floats:
    """Read the lines as numbers; all must have the first line's length, which must be one of these."""
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
    """Split a line at commas, or else semicolons, or else white space; a separator may end it."""
    for separator in (",", ";"):
        if separator in line:
            return line.strip().removesuffix(separator).split(separator)
    return line.split()


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
