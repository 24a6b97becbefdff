"""Collect rows of many tables frame by frame, round their numbers, and hand them on column by column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """The rows of one table, put one behind the other.

    Attributes:
        path: which table.
        kind: what its rows are, as given to `Rows.add`.
        frames: (R,) frame of each row.
        times_s: (R,) [s] time of each row.
        lengths: (R,) how many values of each column belong to each row.
        columns: all values by name.
    """

    path: str
    kind: Any
    frames: list[int]
    times_s: list[float]
    lengths: list[int]
    columns: dict[str, Any]


class RowBuffer:
    """Collects rows of a few values each, which costs a tenth of handing on every row by itself."""

    def __init__(self) -> None:
        self.frames = 0
        self._now = (0, 0.0)
        self._rows: dict[tuple[str, Any], list[tuple[tuple[int, float], Mapping[str, Any]]]] = {}

    def begin(self, frame: int, time_s: float) -> None:
        """Date the rows to come."""
        self._now = (frame, time_s)
        self.frames += 1

    def add(self, path: str, kind: Any, **values: Any) -> None:
        """Add one row to a table: under every name the same number of values, perhaps none."""
        self._rows.setdefault((path, kind), []).append((self._now, values))

    def take(self) -> Iterator[Columns]:
        """Hand on every table, and forget it."""
        tables, self._rows, self.frames = self._rows, {}, 0
        for (path, kind), rows in tables.items():
            yield Columns(
                path=path,
                kind=kind,
                frames=[frame for (frame, _), _ in rows],
                times_s=[time_s for (_, time_s), _ in rows],
                lengths=[len(next(iter(values.values()))) for _, values in rows],
                columns={name: _joined([values[name] for _, values in rows]) for name in rows[0][1]},
            )


def _joined(rows: Sequence[Any]) -> Any:
    if isinstance(rows[0], np.ndarray):
        # Of nothing there may be a shape that does not fit.
        return np.concatenate([row for row in rows if len(row)] or rows[:1])
    return [value for row in rows for value in row]


# Rounding to short binary fractions, finer than a screen shows, halves the bytes of a body: LZ4, by which
# rerun packs, finds only bytes that repeat, and the last digits of measured numbers never do.
# Powers of two: other steps leave long binary fractions.
PIXEL_STEP: Final = 1 / 4
METRE_STEP: Final = 1 / 128
TURN_STEP: Final = 1 / 128  # of a quaternion's parts: within half a degree


def rounded(values: NDArray[np.floating], step: float) -> NDArray[np.float32]:
    """Round values of any shape to multiples of a step, which is a power of two."""
    # Adding zero makes -0 into 0, whose bytes differ.
    short: NDArray[np.float32] = (np.rint(values / step) * step + 0.0).astype(np.float32)
    return short
