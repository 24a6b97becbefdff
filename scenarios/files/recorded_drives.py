"""Recorded drives: the commands of a robot that followed people, repeated without a tracker."""

from collections.abc import Sequence
from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import Final

import pyarrow as pa
import pyarrow.parquet as pq

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.percept import Percept

KEPT: Final = "drive.parquet"
"""Where a run keeps the drive that its robot repeated."""
_STEPS = pa.schema(
    [
        pa.field("linear_m_s", pa.float64()),
        pa.field("angular_rad_s", pa.float64()),
        pa.field("is_emergency", pa.bool_()),
    ]
)


class Repeat:
    """Gives recorded commands one after the other, and looks at nothing; after the last it stops."""

    mode = "repeat"
    reason = ""
    following = None

    def __init__(self, drive: Sequence[Command]) -> None:
        self._left = iter(drive)

    def command(self, percept: Percept) -> Command:  # noqa: ARG002
        """Return the next command."""
        return next(self._left, STOP)


def write_drive(path: Path, drive: Sequence[Command]) -> None:
    """Write commands, one a control step."""
    path.write_bytes(pack_drive(drive))


def pack_drive(drive: Sequence[Command]) -> bytes:
    """Return the file that holds these commands."""
    packed = BytesIO()
    rows = [asdict(command) for command in drive]
    pq.write_table(pa.Table.from_pylist(rows, schema=_STEPS), packed, compression="zstd")
    return packed.getvalue()


def read_drive(path: Path) -> tuple[Command, ...]:
    """Read commands, one a control step; they are the same to the bit as those written.

    Raises:
        BadInput: the file cannot be read as a drive.
    """
    try:
        rows = pq.read_table(path, schema=_STEPS).to_pylist()
    except (OSError, pa.ArrowException) as error:
        raise BadInput(f"{path}: cannot be read as a recorded drive: {error}") from error
    return tuple(Command(**row) for row in rows)
