"""Image sequences as arrays: a folder of pictures in natural order, the pages of a file, or a video."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Protocol

import cv2
import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.picture_names import (
    SUFFIXES,
    describe_left_out,
    jumps,
    numbers_in_a_row,
    pictures_in,
    split_sequence,
)
from peopleboy.tracker.footage.read_picture import Raw, count_pages, read_pages, read_row
from peopleboy.wording import counted

OF_A_RUN: Final = "thermal"
OF_COLOUR: Final = "color"
INNER: Final = ("img", "img1", OF_COLOUR, OF_A_RUN)
"""Where benchmark sequences and runs keep their pictures."""
PAGED: Final = (".tif", ".tiff")
"""Files that may hold several pictures."""
_LAST: Final = 0.9  # share of a video's length from which its last picture is near the end
_TEXT: Final = b"ansi"
_DEEP_GREY: Final = b"Y1\x00"  # followed by the number of bits, in FFmpeg's table of raw formats


class Footage(Protocol):
    """A sequence of pictures of one size.

    Attributes:
        name: the folder's, or the file's without its suffix.
        rate_hz: frame rate; None if unknown.
        expected: expected number of pictures; a damaged video has fewer.
        is_exact: whether that number is exact.
        numbers: consecutive numbers in the pictures' names; None if there are none.
        notes: reinterpretations, to be reported once; complete after reading.
    """

    name: str
    rate_hz: float | None
    expected: int
    is_exact: bool
    numbers: range | None
    notes: list[str]

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one."""
        ...


def open_footage(path: Path) -> Footage:
    """Open a folder of pictures, one that keeps them in one of `INNER`, a TIFF of many pages, or a video.

    Raises:
        BadInput: there is none that can be read.
    """
    if path.is_dir():
        return _open_folder(_home_of_pictures(path), path.name)
    if not path.is_file():
        raise BadInput(f"{path}: no such folder or video")
    if path.suffix.lower() in PAGED:
        return Pages(path, path.stem)
    if path.suffix.lower() in SUFFIXES:  # which a video reader would reduce to 8 bits
        raise BadInput(f"{path}: is one picture; give a folder of them")
    return Video(path)


def beside(footage: Path) -> list[Path]:
    """Return the folders that may hold related files: its own, and the one above inner pictures."""
    if not footage.is_dir():
        return []
    return [footage, footage.parent] if footage.name in INNER else [footage]


def _open_folder(folder: Path, name: str) -> Footage:
    film = PictureFolder(folder, name)
    (first, *others) = film.paths
    is_paged = not others and first.suffix.lower() in PAGED and count_pages(first) > 1
    return Pages(first, name) if is_paged else film


def _home_of_pictures(path: Path) -> Path:
    # A run's contact sheet is also a picture.
    if (path / "run.json").is_file():
        if not (path / OF_A_RUN).is_dir():
            raise BadInput(f"{path}: this run has no folder {OF_A_RUN}; `peopleboy run --frames` writes one")
        return path / OF_A_RUN
    inner = next((path / name for name in INNER if (path / name).is_dir()), path)
    if pictures_in(path):
        return path
    others = [] if inner.name != OF_COLOUR else [other for other in _folders_in(path) if other != inner]
    if others:
        raise BadInput(f"{path}: has pictures in {inner.name}/ and {others[0].name}/; give one of the two")
    return inner


class PictureFolder:
    """The pictures of a folder, in natural order of their names.

    Attributes:
        paths: its files, without a few of other names.

    Raises:
        BadInput: there are none, or those of two cameras, or the folder cannot be read.
    """

    is_exact = True

    def __init__(self, folder: Path, name: str) -> None:
        self.name = name
        self.rate_hz: float | None = None
        self.notes: list[str] = []
        self.paths, others = split_sequence(pictures_in(folder))
        self.expected = len(self.paths)
        if not self.paths:
            raise BadInput(f"{folder}: contains no images, {_where_else(folder)}")
        self.numbers = numbers_in_a_row(self.paths)
        if others:
            self.notes.append(describe_left_out(self.paths, others))
        if gaps := [f"{before} to {after}" for before, after in jumps(self.paths)]:
            more = f" and {counted(len(gaps) - 3, 'time')} more" if len(gaps) > 3 else ""
            self.notes.append(
                f"numbers of pictures jump from {', '.join(gaps[:3])}{more}; frames are counted without gaps"
            )

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one, as `read_row` does."""
        return read_row(self.paths, self.notes)


class Pages:
    """The pages of a TIFF.

    Raises:
        BadInput: it cannot be read.
    """

    is_exact = True
    numbers: range | None = None

    def __init__(self, path: Path, name: str) -> None:
        self._path, self.name = path, name
        self.rate_hz: float | None = None
        self.notes: list[str] = []
        self.expected = count_pages(path)

    def __iter__(self) -> Iterator[Raw]:
        """Read them one by one, as `read_pages` does."""
        return read_pages(self._path, self.notes)


class Video:
    """A video that OpenCV reads."""

    is_exact = False
    numbers: range | None = None

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, path.stem
        self.notes: list[str] = []
        film = self._open()
        rate = film.get(cv2.CAP_PROP_FPS)
        self.rate_hz: float | None = float(rate) if np.isfinite(rate) and rate > 0 else None
        self.expected = max(int(film.get(cv2.CAP_PROP_FRAME_COUNT)), 0)
        pixels = _code(film, cv2.CAP_PROP_CODEC_PIXEL_FORMAT)
        if pixels[:3] == _DEEP_GREY:
            self.notes.append(
                f"{path}: has {pixels[3]} bits a pixel, of which 8 are read; "
                f"`ffmpeg -i {path} frames/%06d.tiff` keeps them all"
            )
        is_read, _ = film.read()
        film.release()
        if not is_read:
            raise BadInput(f"{self.path}: no picture of this video can be decoded")

    def __iter__(self) -> Iterator[Raw]:
        """Decode one picture after the other, RGB."""
        film, count, last_s = self._open(), 0, 0.0
        try:
            while True:
                is_read, picture = film.read()
                if not is_read:
                    break
                count += 1
                last_s = film.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
                yield np.asarray(picture[..., ::-1])
        finally:
            film.release()
        if count < self.expected:
            self.notes.append(f"{self.path}: {self._describe_end(count, last_s)}")

    def _describe_end(self, count: int, last_s: float) -> str:
        """Return why there are fewer pictures than the length of the video and its frame rate suggest."""
        lasts_s = self.expected / self.rate_hz if self.rate_hz else 0.0
        if last_s < _LAST * lasts_s or count < 2:
            return f"ended after {count} of {self.expected} pictures"
        rate_hz = (count - 1) / last_s
        return (
            f"has {count} pictures at uneven times, {rate_hz:.3g} a second on average, which are taken for "
            f"evenly spaced ones; give --rate-hz {rate_hz:.3g}, as its frame rate says {self.rate_hz:g}"
        )

    def _open(self) -> cv2.VideoCapture:
        # Hides FFmpeg's own messages about damaged files; OpenCV reads the variable when opening.
        os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
        film = cv2.VideoCapture(str(self.path))
        if not film.isOpened() or _code(film, cv2.CAP_PROP_FOURCC) == _TEXT:  # FFmpeg draws text files
            raise BadInput(
                f"{self.path}: cannot be read as a video: damaged, or of a codec that OpenCV lacks; "
                "a folder of pictures always works"
            )
        return film


def _code(film: cv2.VideoCapture, which: int) -> bytes:
    """Return the four bytes of a code."""
    return int(film.get(which)).to_bytes(4, "little", signed=True)


def _where_else(folder: Path) -> str:
    """Return which inner folder has pictures, or the supported formats."""
    for inner in _folders_in(folder):
        return f"but {inner.name}/ has {len(pictures_in(inner))}; give {inner}"
    return f"wanted are {', '.join(SUFFIXES)}"


def _folders_in(folder: Path) -> list[Path]:
    """Return the inner folders with pictures, those of depth last."""
    inner = [path for path in folder.iterdir() if path.is_dir() and pictures_in(path)]
    return sorted(inner, key=lambda path: (path.name.startswith("depth"), path.name))
