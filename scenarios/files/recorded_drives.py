"""Recorded drives: commands of a robot that followed people, replayed without a tracker."""

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
"""File name in a run's folder of the drive that the robot replayed."""
_STEPS = pa.schema(
    [
        pa.field("linear_m_s", pa.float64()),
        pa.field("angular_rad_s", pa.float64()),
        pa.field("is_emergency", pa.bool_()),
    ]
)


class Repeat:
    """Behaviour that replays recorded commands, ignores all sensors, and stops after the last command."""

    mode = "repeat"
    reason = ""
    following = None

    def __init__(self, drive: Sequence[Command]) -> None:
        self._left = iter(drive)

    def command(self, percept: Percept) -> Command:  # noqa: ARG002
        """Return the next command."""
        return next(self._left, STOP)


def write_drive(path: Path, drive: Sequence[Command]) -> None:
    """Write commands, one per control step."""
    path.write_bytes(pack_drive(drive))


def pack_drive(drive: Sequence[Command]) -> bytes:
    """Return the contents of a file with these commands."""
    packed = BytesIO()
    rows = [asdict(command) for command in drive]
    pq.write_table(pa.Table.from_pylist(rows, schema=_STEPS), packed, compression="zstd")
    return packed.getvalue()


def read_drive(path: Path) -> tuple[Command, ...]:
    """Read commands, one per control step, bit-identical to those written.

    Raises:
        BadInput: the file cannot be read as a drive.
    """
    try:
        table = pq.read_table(path.absolute(), schema=_STEPS)
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())[:120]
        raise BadInput(f"{path}: cannot be read as a recorded drive: {reason}") from error
    if any(column.null_count for column in table.columns):
        raise BadInput(f"{path}: cannot be read as a recorded drive: has rows without a value")
    return tuple(Command(**row) for row in table.to_pylist())
