"""What `seqinfo.ini` says, which lies beside the pictures of MOTChallenge's sequences."""

from __future__ import annotations

from configparser import ConfigParser
from configparser import Error as ConfigError
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.pictures import beside

NAME: Final = "seqinfo.ini"
RATES_HZ: Final = (0.1, 1000.0)
"""Of pictures that anybody takes."""


def find_info(footage: Path) -> Path | None:
    """Look for the file beside the pictures, in their folder or the one above; None if there is none."""
    return next((home / NAME for home in beside(footage) if (home / NAME).is_file()), None)


def rate_in(path: Path) -> float | None:
    """Read how many pictures a second there are; None if it is not said.

    Raises:
        BadInput: the file cannot be read, or the rate is none.
    """
    parser = ConfigParser(interpolation=None)
    try:
        parser.read_string(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, ConfigError) as error:
        raise BadInput(f"{path}: cannot be read; mend or remove it, or give --rate-hz") from error
    told = parser.get("Sequence", "frameRate", fallback=None)
    if told is None:
        return None
    low, high = RATES_HZ
    try:
        rate = float(told)
    except ValueError:
        rate = 0.0
    if not low <= rate <= high:
        raise BadInput(
            f"{path}: frameRate must be {low:g}..{high:g} pictures a second, got {told[:60]!r}; "
            "mend it, or give --rate-hz"
        )
    return rate
