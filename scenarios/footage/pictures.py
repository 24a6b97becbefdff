"""Footage as a row of arrays: a folder of pictures in natural order, or a video."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from bad_input import BadInput

Raw = NDArray[Any]  # (H, W) uint8, uint16 or float32, or (H, W, 3) uint8 RGB

SUFFIXES: Final = (".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp")
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
    """Open a folder of pictures, the folder `img` of a benchmark's sequence, or a video.

    Raises:
        BadInput: there is none that can be read.
    """
    if path.is_dir():
        for inner in ("img", "img1", "color"):
            if not _pictures_in(path) and (path / inner).is_dir():
                return PictureFolder(path / inner, path.name)
        return PictureFolder(path, path.name)
    if not path.is_file():
        raise BadInput(f"{path}: there is no such folder or video")
    return Video(path)


def natural_order(name: str) -> list[tuple[int, str]]:
    """Give a key by which frame 2 comes before frame 10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


class PictureFolder:
    """The pictures of a folder, in natural order of their names."""

    def __init__(self, folder: Path, name: str) -> None:
        self.name = name
        self.rate_hz: float | None = None
        self.notes: list[str] = []
        self._paths = _pictures_in(folder)
        self.expected = len(self._paths)
        if not self._paths:
            raise BadInput(f"{folder}: there are no pictures here; wanted are {', '.join(SUFFIXES)}")

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one, each of the size of the first.

        Raises:
            BadInput: a picture is damaged, or of another size than the first.
        """
        first: Raw | None = None
        for path in self._paths:
            picture = read_picture(path, self.notes)
            first = picture if first is None else first
            if picture.shape[:2] != first.shape[:2]:
                raise BadInput(
                    f"{path}: all pictures must have one size, {_size(first)} as the first, "
                    f"got {_size(picture)}"
                )
            if picture.dtype != first.dtype:
                raise BadInput(
                    f"{path}: all pictures must be {first.dtype} as the first, got {picture.dtype}"
                )
            yield picture


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


def read_picture(path: Path, notes: list[str]) -> Raw:
    """Read one picture: (H, W) uint8, uint16 or float32, or (H, W, 3) uint8.

    Raises:
        BadInput: it is damaged, of a kind that is not read, or has pixels that are no numbers.
    """
    try:
        with Image.open(path) as opened:
            picture = _as_array(opened, path, notes)
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        if isinstance(error, BadInput):
            raise
        raise BadInput(f"{path}: cannot be read as a picture: {error}") from error
    if picture.dtype == np.float32 and not np.isfinite(picture).all():
        broken = int((~np.isfinite(picture)).sum())
        raise BadInput(f"{path}: {broken} pixels are not finite numbers; fill or mask them before")
    return picture


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
        _note(notes, "pictures have a fourth channel, opacity; it is left out")
    return np.array(opened.convert("L" if mode == "LA" else "RGB"))


def _note(notes: list[str], text: str) -> None:
    if text not in notes:
        notes.append(text)


def _pictures_in(folder: Path) -> list[Path]:
    found = [path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file()]
    return sorted(found, key=lambda path: natural_order(path.name))


def _size(picture: Raw) -> str:
    return f"{picture.shape[1]}x{picture.shape[0]}"
