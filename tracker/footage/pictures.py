"""Footage as a row of arrays: a folder of pictures in natural order, or a video."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.picture_names import SUFFIXES, jumps, pictures_in
from peopleboy.wording import counted

Raw = NDArray[Any]  # (H, W) uint8, uint16 or float32, or (H, W, 3) uint8 RGB

OF_A_RUN: Final = "thermal"
INNER: Final = ("img", "img1", "color", OF_A_RUN)
"""Where benchmarks' sequences and runs of ours keep their pictures."""
_SIXTEEN_BIT: Final = ("I;16", "I;16B", "I;16L", "I")


class Footage(Protocol):
    """A row of pictures of one size.

    Attributes:
        name: the folder's, or the file's without its ending.
        rate_hz: pictures a second; None if nobody says.
        expected: how many pictures there should be; a damaged video has fewer.
        notes: what was taken as something else than it is, to be told once; complete after reading.
    """

    name: str
    rate_hz: float | None
    expected: int
    notes: list[str]

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one."""
        ...


def open_footage(path: Path) -> Footage:
    """Open a folder of pictures, a folder that keeps them in one of `INNER`, or a video.

    Raises:
        BadInput: there is none that can be read.
    """
    if path.is_dir():
        return PictureFolder(_home_of_pictures(path), path.name)
    if not path.is_file():
        raise BadInput(f"{path}: there is no such folder or video")
    return Video(path)


def _home_of_pictures(path: Path) -> Path:
    # Beside a run's frames lies its contact sheet, a picture too.
    if (path / "run.json").is_file():
        if not (path / OF_A_RUN).is_dir():
            raise BadInput(f"{path}: this run has no folder {OF_A_RUN}; `peopleboy run --frames` writes one")
        return path / OF_A_RUN
    inner = next((path / name for name in INNER if (path / name).is_dir()), path)
    return path if pictures_in(path) else inner


class PictureFolder:
    """The pictures of a folder, in natural order of their names.

    Attributes:
        paths: its files.

    Raises:
        BadInput: there are none, or the folder cannot be read.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self.name = name
        self.rate_hz: float | None = None
        self.notes: list[str] = []
        self.paths = pictures_in(folder)
        self.expected = len(self.paths)
        if not self.paths:
            raise BadInput(f"{folder}: there are no pictures here, {_where_else(folder)}")
        if gaps := [f"{before} to {after}" for before, after in jumps(self.paths)]:
            more = f" and {counted(len(gaps) - 3, 'time')} more" if len(gaps) > 3 else ""
            self.notes.append(
                f"numbers of pictures jump from {', '.join(gaps[:3])}{more}; frames are counted without gaps"
            )

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one, as `read_row` does."""
        return read_row(self.paths, self.notes)


class Video:
    """A video that OpenCV reads."""

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, path.stem
        self.notes: list[str] = []
        film = self._open()
        rate = film.get(cv2.CAP_PROP_FPS)
        self.rate_hz: float | None = float(rate) if np.isfinite(rate) and rate > 0 else None
        self.expected = max(int(film.get(cv2.CAP_PROP_FRAME_COUNT)), 0)
        is_read, _ = film.read()
        film.release()
        if not is_read:
            raise BadInput(f"{self.path}: no picture of this video can be decoded")

    def __iter__(self) -> Iterator[Raw]:
        """Decode one picture after the other, RGB."""
        film, count = self._open(), 0
        try:
            while True:
                is_read, picture = film.read()
                if not is_read:
                    break
                count += 1
                yield np.asarray(picture[..., ::-1])
        finally:
            film.release()
        if count < self.expected:
            self.notes.append(f"{self.path}: ended after {count} of {self.expected} pictures")

    def _open(self) -> cv2.VideoCapture:
        # FFmpeg's own lines about damaged files would stand before ours; OpenCV reads this as it opens.
        os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
        film = cv2.VideoCapture(str(self.path))
        if not film.isOpened():
            raise BadInput(
                f"{self.path}: cannot be read as a video: damaged, or of a codec that OpenCV lacks; "
                "a folder of pictures always works"
            )
        return film


def read_row(paths: Iterable[Path], notes: list[str]) -> Iterator[Raw]:
    """Read pictures one by one, each of the size and the depth of the first.

    Raises:
        BadInput: a picture is damaged, or of another size or depth than the first.
    """
    first: Raw | None = None
    for path in paths:
        picture = read_picture(path, notes)
        first = picture if first is None else first
        if picture.shape[:2] != first.shape[:2]:
            raise BadInput(
                f"{path}: all pictures must have one size, {size_of(first)} as the first, "
                f"got {size_of(picture)}"
            )
        if picture.dtype != first.dtype:
            raise BadInput(f"{path}: all pictures must be {first.dtype} as the first, got {picture.dtype}")
        yield picture


def read_picture(path: Path, notes: list[str]) -> Raw:
    """Read one picture: (H, W) uint8, uint16 or float32, or (H, W, 3) uint8.

    Raises:
        BadInput: it is damaged, of a kind that is not read, or has pixels that are no numbers.
    """
    try:
        with Image.open(path) as opened:
            picture = _as_array(opened, path, notes)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, BadInput):
            raise
        raise BadInput(f"{path}: {_what_is_wrong(path, error)}") from error
    if picture.dtype == np.float32 and not np.isfinite(picture).all():
        broken = counted(int((~np.isfinite(picture)).sum()), "pixel")
        raise BadInput(f"{path}: has {broken} without a finite number; fill or mask them before")
    return picture


def _what_is_wrong(path: Path, error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"cannot be read: {error.strerror}"
    if path.stat().st_size == 0:
        return "is empty; remove it, or repair it"
    if isinstance(error, UnidentifiedImageError):
        return f"is no {path.suffix[1:].upper()}, or damaged; remove it, or repair it"
    return f"cannot be read as a picture ({error}); remove it, or repair it"


def _as_array(opened: Image.Image, path: Path, notes: list[str]) -> Raw:
    mode = opened.mode
    if mode in _SIXTEEN_BIT:
        counts = np.array(opened)
        if counts.min() < 0 or counts.max() > 65535:
            raise BadInput(f"{path}: counts must be 0..65535, got {counts.min()}..{counts.max()}")
        return counts.astype(np.uint16)
    if mode == "F":
        return np.array(opened, dtype=np.float32)
    if mode in ("L", "1"):
        return np.array(opened.convert("L"))
    if mode in ("RGBA", "LA", "PA"):
        _note(notes, "pictures have an opacity channel; it is left out")
    return np.array(opened.convert("L" if mode == "LA" else "RGB"))


def _note(notes: list[str], text: str) -> None:
    if text not in notes:
        notes.append(text)


def _where_else(folder: Path) -> str:
    """Say which folder inside has pictures, or what a picture is."""
    for inner in sorted(path for path in folder.iterdir() if path.is_dir()):
        if count := len(pictures_in(inner)):
            return f"but {inner.name}/ has {count}; give {inner}"
    return f"wanted are {', '.join(SUFFIXES)}"


def size_of(picture: Raw) -> str:
    """Write a picture's size as WIDTHxHEIGHT."""
    return f"{picture.shape[1]}x{picture.shape[0]}"
