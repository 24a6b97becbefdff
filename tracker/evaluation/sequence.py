"""Boxes of one sequence: ground truth, or the output of a tracker; and sums over sequences."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Track, confirmed

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

DTYPES = {"frame": np.int64, "id": np.int64, "counted": np.bool_}  # every other column is float64
LARGEST = 2**53  # larger integers are not exact in float64, which all columns pass through
FARTHEST = 1e6  # [px] no image is larger, and areas of larger boxes would overflow


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Rows:
    """Boxes of a sequence: one row per frame and id.

    Rows may be given in any order; they are copied, sorted by frame, then id, and read-only.

    Attributes:
        frame: (N,) from 1.
        id: (N,) 0 or more, unique within a frame.
        box: (N, 4) [px] left, top, width, height; sizes 0 or more.

    Raises:
        BadInput: a column has the wrong shape, or a value is invalid.
    """

    source: ClassVar[str] = "boxes"

    frame: Ints
    id: Ints
    box: Floats

    def __post_init__(self) -> None:
        columns = as_columns({name: getattr(self, name) for name in self._columns()})
        fault = find_fault(columns)
        if fault is not None:
            raise BadInput(f"{self.source}: row {fault[0]}: {fault[1]}")
        order = np.lexsort((columns["id"], columns["frame"]))
        for name, column in columns.items():
            settled: NDArray[Any] = column[order].astype(DTYPES.get(name, np.float64))
            settled.setflags(write=False)
            object.__setattr__(self, name, settled)

    def __repr__(self) -> str:
        """Show the numbers of boxes and ids."""
        ids = len(np.unique(self.id))
        return f"{type(self).__name__}({len(self)} boxes, {ids} ids, last frame {self.last_frame})"

    def __len__(self) -> int:
        return len(self.frame)

    def take(self, rows: Ints | Bools) -> Self:
        """Return some rows: indices (M,), or a mask (N,)."""
        taken: dict[str, Any] = {name: getattr(self, name)[rows] for name in self._columns()}
        return replace(self, **taken)

    @classmethod
    def from_rows(cls, rows: Iterable[Sequence[Any]]) -> Self:
        """Make one from rows, each with one value per column, in the order of the fields."""
        columns = zip(*rows, strict=True)
        return cls(**{name: np.array(next(columns, ())) for name in cls._columns()})

    @classmethod
    def _columns(cls) -> list[str]:
        """Return the names of the columns."""
        return [each.name for each in fields(cls) if each.default is MISSING]

    def number_ids(self) -> tuple[Ints, Ints]:
        """Return the number from 0 of each row's id (N,), and the number of rows of each id (K,)."""
        _, number, rows = np.unique(self.id, return_inverse=True, return_counts=True)
        return number, rows

    @property
    def last_frame(self) -> int:
        """The last frame with a row; 0 without rows."""
        return int(self.frame[-1]) if len(self) else 0


@dataclass(frozen=True, slots=True, eq=False, repr=False, kw_only=True)
class TrueBoxes(Rows):
    """The people of one sequence, the *targets*: one row per frame and person.

    Attributes:
        counted: (N,) False for people that a tracker need not find (nearer than 3 m, farther than 10 m).
        visible: (N,) in 0..1, the visible fraction of the person.
        around_px: columns of a full turn in a panoramic image; boxes, including the candidates', may then
            cross its seam. None otherwise.
    """

    source: ClassVar[str] = "truth"

    counted: Bools
    visible: Floats
    around_px: float = math.inf


@dataclass(frozen=True, slots=True, eq=False, repr=False, kw_only=True)
class TrackBoxes(Rows):
    """The output of a tracker in one sequence, the *candidates*: one row per frame and track id.

    Attributes:
        confidence: (N,) finite; not used by the metrics.
    """

    source: ClassVar[str] = "tracks"

    confidence: Floats

    @classmethod
    def from_tracks(cls, frames: Iterable[Iterable[Track]], camera: str = THERMAL) -> Self:
        """Make one from the confirmed tracks of each frame, starting with frame 1.

        Args:
            frames: return values of the tracker's `update`, frame by frame.
            camera: camera of the boxes.
        """
        return cls.from_rows(
            (number, track.id, box, track.confidence)
            for number, tracks in enumerate(frames, 1)
            for track, box in confirmed(tracks, camera)
        )


def as_columns(values: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """Copy the values into float columns of one length: `box` (N, 4), all others (N,).

    Raises:
        BadInput: a column has another shape.
    """
    rows = np.size(values["frame"])
    columns = {}
    for name, value in values.items():
        column = np.array(value, dtype=np.float64)
        shape = (rows, 4) if name == "box" else (rows,)
        if rows == 0 and column.size == 0:
            column = column.reshape(shape)
        if column.shape != shape:
            raise BadInput(f"column '{name}' must have shape {shape}, got {column.shape}")
        columns[name] = column
    return columns


def find_fault(columns: Mapping[str, Floats]) -> tuple[int, str] | None:
    """Return the index of the first invalid row, and a message."""
    broken = [(int(np.argmin(good)), rule, name) for name, good, rule in _rules(columns) if not good.all()]
    if not broken:
        return None
    row, rule, name = min(broken, key=lambda fault: fault[0])
    value = ", ".join(f"{number:.15g}" for number in np.atleast_1d(columns[name][row]))
    return row, f"{rule}, got {value}"


def _rules(columns: Mapping[str, Floats]) -> list[tuple[str, Bools, str]]:
    """Return the rules: column, rows (N,) that satisfy it, and message."""
    is_near = np.asarray((np.abs(columns["box"]) <= FARTHEST).all(axis=1))
    is_size = np.asarray((columns["box"][:, 2:] >= 0.0).all(axis=1))
    rules: list[tuple[str, Bools, str]] = [
        ("frame", _is_whole(columns["frame"], least=1), "frame must be a whole number from 1"),
        ("box", is_near, f"left, top, width, height must be within +-{FARTHEST:.0e} pixels"),
        ("box", is_size, "width and height must be 0 or more"),
    ]
    if "id" in columns:
        rules.insert(1, ("id", _is_whole(columns["id"], least=0), "id must be a whole number from 0"))
        once = _is_first(columns["frame"], columns["id"])
        rules.append(("id", once, "an id must occur once in a frame"))
    if "visible" in columns:
        visible, counted = columns["visible"], columns["counted"]
        rules.append(("visible", (visible >= 0.0) & (visible <= 1.0), "the visible fraction must be 0 to 1"))
        rules.append(("counted", np.isin(counted, (0.0, 1.0)), "counted must be 0 or 1"))
    if "confidence" in columns:
        rules.append(("confidence", np.isfinite(columns["confidence"]), "the confidence must be finite"))
    return rules


def _is_whole(values: Floats, least: int) -> Bools:
    """Return which values (N,) are whole numbers of at least `least`."""
    return np.asarray((values >= least) & (values <= LARGEST) & (values == np.floor(values)))


def _is_first(frame: Floats, identity: Floats) -> Bools:
    """Return which rows (N,) are the first of their frame and id."""
    order = np.lexsort((np.arange(len(frame)), identity, frame))
    frames, identities = frame[order], identity[order]
    repeats = (frames[1:] == frames[:-1]) & (identities[1:] == identities[:-1])
    first = np.ones(len(frame), dtype=np.bool_)
    first[order[1:][repeats]] = False
    return first


# Numerators and denominators of metrics that add up over sequences.


@dataclass(frozen=True, slots=True, eq=False)
class Sums:
    """A record of sums: adding two gives the record of both sequences combined."""

    def __add__(self, other: Self) -> Self:
        names = [field.name for field in fields(self)]
        return type(self)(*(getattr(self, name) + getattr(other, name) for name in names))


def percent(numerator: float, denominator: float) -> float:
    """Return the ratio in percent, at most 100; NaN (undefined) if the denominator is 0."""
    return min(100.0, 100.0 * numerator / denominator) if denominator else math.nan


def sum_by(group: Ints, values: Floats, groups: int) -> Floats:
    """Sum the values (N,) of each group: (groups,), given the group (N,) of each value."""
    # Without values, bincount returns integers.
    return np.bincount(group, values, groups).astype(np.float64)
