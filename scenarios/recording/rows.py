"""Write a recording frame by frame, with rounded numbers, and send its rows as columns."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from peopleboy.scenarios.recording.recording_file import pack

APPLICATION: Final = "peopleboy"


def recording_id(title: str) -> str:
    """Return the id of a recording from its title; viewers merge recordings with the same id."""
    return title.replace(", ", "-").replace(" ", "-")


class RecordingWriter:
    """Writes a recording; use it as a context manager. Closing the file packs it.

    Rows are collected frame by frame and sent as columns, which takes a tenth of the time of sending single
    rows.

    Args:
        path: the file to write.
        title: name of the recording; the same title gives the same recording id.
        viewer: address of a viewer that shows it live; None for none.
        blueprint: layout of its views.
    """

    def __init__(
        self, path: Path, title: str, viewer: str | None = None, blueprint: rrb.Blueprint | None = None
    ) -> None:
        self._path = path
        self._now = (0, 0.0)
        self._frames = 0
        self._rows: dict[tuple[str, Any], list[tuple[tuple[int, float], Mapping[str, Any]]]] = {}
        self.stream = rr.RecordingStream(APPLICATION, recording_id=recording_id(title))
        sinks = [rr.FileSink(path)] if viewer is None else [rr.FileSink(path), rr.GrpcSink(viewer)]
        self.stream.set_sinks(*sinks, default_blueprint=blueprint)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Write the remaining rows, close the file, and pack it."""
        self._send()
        self.stream.disconnect()
        pack(self._path)

    def begin(self, frame: int, time_s: float) -> None:
        """Set the time of the rows that follow."""
        self._now = (frame, time_s)
        self._frames += 1

    def add(self, path: str, kind: Any, **values: Any) -> None:
        """Add a row to an entity; every name has the same number of values, which may be 0."""
        self._rows.setdefault((path, kind), []).append((self._now, values))

    def send_if_due(self, frames: int) -> None:
        """Send all rows if this many frames have been collected."""
        if self._frames >= frames:
            self._send()

    def _send(self) -> None:
        tables, self._rows, self._frames = self._rows, {}, 0
        for (path, kind), rows in tables.items():
            frames = rr.TimeColumn("frame", sequence=[frame for (frame, _), _ in rows])
            times = rr.TimeColumn("time", duration=np.array([time_s for (_, time_s), _ in rows]))
            columns = {name: _joined([values[name] for _, values in rows]) for name in rows[0][1]}
            lengths = [len(next(iter(values.values()))) for _, values in rows]
            content = kind.columns(**columns).partition(lengths)
            self.stream.send_columns(path, [frames, times], content, strict=True)


def _joined(rows: Sequence[Any]) -> Any:
    if isinstance(rows[0], np.ndarray):
        # An empty array may have a shape that does not match.
        return np.concatenate([row for row in rows if len(row)] or rows[:1])
    return [value for row in rows for value in row]


# Rounding to short binary fractions, finer than the screen resolution, halves the size of a body: LZ4, which
# rerun uses, compresses repeated bytes only, and the last digits of measured numbers never repeat.
# Powers of two, as other steps have long binary fractions.
PIXEL_STEP: Final = 1 / 4
METRE_STEP: Final = 1 / 128
TURN_STEP: Final = 1 / 128  # of a quaternion's components: within half a degree


def rounded(values: NDArray[np.floating], step: float) -> NDArray[np.float32]:
    """Round values of any shape to multiples of a step, which is a power of two."""
    # Adding zero turns -0 into 0, which has other bytes.
    short: NDArray[np.float32] = (np.rint(values / step) * step + 0.0).astype(np.float32)
    return short
