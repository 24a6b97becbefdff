"""Reader of `seqinfo.ini`, the description of MOTChallenge's sequences."""

import csv
import math
from configparser import ConfigParser
from configparser import Error as ConfigError
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.image_sequences import beside
from peopleboy.tracker.frame import Odometry
from peopleboy.user_files import read_text

NAME: Final = "seqinfo.ini"
RATES_HZ: Final = (0.1, 1000.0)
"""Range of plausible frame rates."""


def find_info(footage: Path) -> Path | None:
    """Return the file next to the pictures, in their folder or the one above, or None."""
    return next((home / NAME for home in beside(footage) if (home / NAME).is_file()), None)


def rate_in(path: Path) -> float | None:
    """Return the frame rate; None if the file does not have it.

    Raises:
        BadInput: the file cannot be read, or the rate is invalid.
    """
    try:
        raw = _parse(path).get("Sequence", "frameRate", fallback=None)
    except (OSError, UnicodeDecodeError, ConfigError) as error:
        raise BadInput(f"{path}: cannot be read; mend or remove it, or give --rate-hz") from error
    if raw is None:
        return None
    low, high = RATES_HZ
    try:
        rate = float(raw)
    except ValueError:
        rate = 0.0
    if not low <= rate <= high:
        raise BadInput(
            f"{path}: frameRate must be {low:g}..{high:g} pictures a second, got {raw[:60]!r}; "
            "mend it, or give --rate-hz"
        )
    return rate


def sequence_name(path: Path) -> str:
    """Return the sequence's name; empty if the file does not have it, or cannot be read."""
    try:
        return _parse(path).get("Sequence", "name", fallback="")
    except (OSError, UnicodeDecodeError, ConfigError, BadInput):
        return ""


def _parse(path: Path) -> ConfigParser:
    parser = ConfigParser(interpolation=None)
    parser.read_string(read_text(path, "utf-8-sig"))
    return parser


# Odometry from a text file.

COLUMNS: Final = ("advance_m", "aside_m", "turn_deg")


def load_odometry(path: Path, pictures: int) -> list[Odometry]:
    """Read a CSV file whose first line is `COLUMNS`, followed by a line for each picture.

    Each line is the camera's motion since the previous picture; that of the first is ignored.

    Args:
        path: the file.
        pictures: number of pictures.

    Raises:
        BadInput: the file cannot be read, has other columns or another length, or a number is not finite.
    """
    try:
        lines = read_text(path, "utf-8-sig").split("\n")
        head, *rows = [row for row in csv.reader(lines) if row] or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise BadInput(f"{path}: cannot be read as odometry; give a CSV file") from error
    if tuple(name.strip() for name in head) != COLUMNS:
        raise BadInput(f"{path}: the first line must be {','.join(COLUMNS)}, got {','.join(head)[:60]!r}")
    if len(rows) != pictures:
        raise BadInput(f"{path}: must have a line for each of the {pictures} pictures, got {len(rows)}")
    return [_moved(row, f"{path}: picture {number}") for number, row in enumerate(rows, start=1)]


def _moved(row: list[str], where: str) -> Odometry:
    try:
        advance, aside, turn = (float(cell) for cell in row)
    except ValueError:
        raise BadInput(f"{where}: must be three numbers, got {','.join(row)[:60]!r}") from None
    if not all(math.isfinite(number) for number in (advance, aside, turn)):
        raise BadInput(f"{where}: numbers must be finite, got {','.join(row)!r}")
    return Odometry(advance_m=advance, aside_m=aside, turn_rad=math.radians(turn))
