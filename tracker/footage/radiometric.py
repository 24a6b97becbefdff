"""Temperatures in the radiometric JPEG files of FLIR, which hide raw counts behind a picture for people."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput

SEQUENCES: Final = (".seq", ".csq", ".fff")
"""Files of FLIR that are refused."""
_SUFFIXES: Final = (".jpg", ".jpeg")
_START: Final = b"\xff\xd8"
_SEGMENT: Final = 0xE1  # application segment 1
_SCAN: Final = 0xDA  # where the picture begins
_NAME: Final = b"FLIR\x00"
_NOTE: Final = (
    "pictures are radiometric JPEGs, whose temperatures in degC are read; trackers that need temperatures "
    "take them by --scale 1,0"
)


def is_radiometric(path: Path) -> bool:
    """Return whether a file is a JPEG with a segment of FLIR."""
    if path.suffix.lower() not in _SUFFIXES or not path.is_file():
        return False
    with path.open("rb") as file:
        if file.read(2) != _START:
            return False
        while True:
            head = file.read(4)
            if len(head) < 4 or head[0] != 0xFF or head[1] == _SCAN:
                return False
            end = file.tell() + int.from_bytes(head[2:], "big") - 2
            if head[1] == _SEGMENT and file.read(len(_NAME)) == _NAME:
                return True
            file.seek(end)


def read_celsius(path: Path, notes: list[str]) -> NDArray[np.float32]:
    """Return the temperatures (H, W) [degC] of a radiometric JPEG, by its counts and Planck constants.

    Raises:
        BadInput: the package flyr is missing, or the file is damaged.
    """
    if find_spec("flyr") is None:
        raise BadInput(
            f"{path}: is a radiometric JPEG of FLIR; its temperatures need flyr: pip install "
            "'peopleboy[radiometric]'. For its colours alone, convert it to PNG"
        )
    flyr = import_module("flyr")
    try:
        celsius = np.asarray(flyr.unpack(str(path)).celsius, np.float32)
    except Exception as error:  # the package raises whatever a damaged file leads to
        raise BadInput(
            f"{path}: its segment of FLIR cannot be read ({error}); remove or repair it"
        ) from error
    if _NOTE not in notes:
        notes.append(_NOTE)
    return celsius


def refuse_sequence(path: Path) -> None:
    """Refuse a sequence file of FLIR.

    Raises:
        BadInput: it is one.
    """
    if path.suffix.lower() in SEQUENCES:
        raise BadInput(
            f"{path}: sequences of FLIR are not read; export it as 16-bit TIFF, for example by FLIR Research "
            "Studio, and give the folder"
        )
