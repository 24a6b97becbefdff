"""Image sequences as arrays: a folder of pictures in natural order, the pages of a file, or a video."""

import os
from collections.abc import Iterator, Sequence
from importlib import import_module
from importlib.util import find_spec
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
    step_of,
)
from peopleboy.tracker.footage.radiometric import refuse_sequence
from peopleboy.tracker.footage.read_picture import count_pages, read_pages, read_row
from peopleboy.tracker.footage.read_tiff import Raw
from peopleboy.tracker.footage.time_stamps import check_rising, time_stamps
from peopleboy.wording import counted

OF_A_RUN: Final = "thermal"
OF_COLOUR: Final = "color"
INNER: Final = ("img", "img1", OF_COLOUR, OF_A_RUN)
"""Where benchmark sequences and runs keep their pictures."""
PAGED: Final = (".tif", ".tiff")
"""Files that may hold several pictures."""
_UNEVEN: Final = 0.5  # share of a picture's duration by which it comes too early or too late
_LAST: Final = 0.9  # share of a video's length from which its last picture is near the end
_TEXT: Final = b"ansi"
_DEEP_GREY: Final = b"Y1\x00"  # followed by the number of bits, in FFmpeg's table of raw formats


class Footage(Protocol):
    """A sequence of pictures of one size.

    Attributes:
        name: the folder's, the file's without its suffix, or that of a live source.
        rate_hz: frame rate; None if unknown.
        expected: expected number of pictures; a damaged video has fewer.
        is_exact: whether that number is exact.
        numbers: consecutive numbers in the pictures' names; None if there are none.
        times_s: time of each picture since the first, as far as it was read; None for even times.
        notes: reinterpretations, to be reported once; complete after reading.
    """

    name: str
    rate_hz: float | None
    expected: int
    is_exact: bool
    numbers: range | None
    times_s: list[float] | None
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
    refuse_sequence(path)
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
    others = [] if inner.name != OF_COLOUR else [other for other in folders_in(path) if other != inner]
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
        self.times_s: list[float] | None = None
        paths, others = split_sequence(pictures_in(folder))
        if not paths:
            raise BadInput(f"{folder}: contains no images, {_where_else(folder)}")
        if others:
            self.notes.append(describe_left_out(paths, others))
        self.take(paths)
        if gaps := [f"{before} to {after}" for before, after in jumps(paths)]:
            more = f" and {counted(len(gaps) - 3, 'time')} more" if len(gaps) > 3 else ""
            self.notes.append(
                f"numbers of pictures jump from {', '.join(gaps[:3])}{more}; frames are counted without "
                f"gaps, "
                "and their times have them"
            )
        if (step := step_of(paths)) is not None and step > 1:
            self.notes.append(
                f"numbers of pictures count by {step}; they are taken for consecutive pictures at the "
                f"frame rate"
            )

    def take(self, paths: Sequence[Path]) -> None:
        """Read these pictures alone, in the order of the times in their names, if there are any."""
        times = time_stamps(paths)
        if times is not None:
            order = np.argsort(times, kind="stable")
            paths, times = [paths[k] for k in order], times[order]
            check_rising(paths, times)
            self.times_s = (times - times[0]).tolist()
            self.rate_hz = 1.0 / float(np.median(np.diff(times))) if len(times) > 1 else None
        self.paths = list(paths)
        self.expected = len(self.paths)
        self.numbers = numbers_in_a_row(self.paths)

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
        self.times_s: list[float] | None = None
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
        self.times_s: list[float] | None = None if self.rate_hz is None else []
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
        film, count = self._open(), 0
        clock = FrameClock(self.rate_hz)
        self.times_s = None if self.rate_hz is None else clock.times_s
        try:
            while True:
                is_read, picture = film.read()
                if not is_read:
                    break
                count += 1
                clock.add(film.get(cv2.CAP_PROP_POS_MSEC) / 1000.0)
                yield np.asarray(picture[..., ::-1])
        finally:
            film.release()
        for note in (self._describe_end(count, clock), describe_sizes(self.path)):
            if note:
                self.notes.append(f"{self.path}: {note}")

    def _describe_end(self, count: int, clock: "FrameClock") -> str:
        """Return why there are other pictures than the length of the video and its frame rate suggest."""
        lasts_s = self.expected / self.rate_hz if self.rate_hz else 0.0
        if count < 2 or (count < self.expected and clock.last_s < _LAST * lasts_s):
            return f"ended after {count} of {self.expected} pictures" if count < self.expected else ""
        if not clock.is_uneven:
            return ""
        rate_hz = (count - 1) / clock.last_s
        return (
            f"has {count} pictures at uneven times, {rate_hz:.3g} a second on average, which are used, "
            f"although "
            f"its frame rate says {self.rate_hz:g}; --rate-hz {rate_hz:.3g} takes them for evenly spaced ones"
        )

    def _open(self) -> cv2.VideoCapture:
        return open_capture(
            str(self.path),
            f"{self.path}: cannot be read as a video: damaged, or of a codec that OpenCV lacks; "
            "a folder of pictures always works",
        )


def open_capture(source: str | int, otherwise: str) -> cv2.VideoCapture:
    """Open a video, a stream or a camera.

    Args:
        source: path, address, or number of a camera.
        otherwise: message if it cannot be opened.

    Raises:
        BadInput: it cannot be opened.
    """
    # Hides FFmpeg's own messages about damaged files; OpenCV reads the variable when opening.
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # and those of OpenCV
    film = cv2.VideoCapture(source)
    if not film.isOpened() or _code(film, cv2.CAP_PROP_FOURCC) == _TEXT:  # FFmpeg draws text files
        raise BadInput(otherwise)
    return film


def describe_sizes(path: Path) -> str:
    """Return a note if the pictures of a video change their size, which OpenCV hides; empty without PyAV."""
    if find_spec("av") is None:
        return ""
    av = import_module("av")
    sizes: list[str] = []
    try:
        with av.open(str(path)) as film:
            stream = film.streams.video[0]
            stream.codec_context.skip_frame = "NONKEY"  # a new size begins with a key frame
            for picture in film.decode(stream):
                size = f"{picture.width}x{picture.height}"
                if size not in sizes:
                    sizes.append(size)
    except (av.FFmpegError, IndexError, ValueError):
        pass  # damage is noted elsewhere
    if len(sizes) < 2:
        return ""
    return f"its pictures change size, {', '.join(sizes)}; all are scaled to the first"


class FrameClock:
    """Times of a video's pictures: even ones, as long as the video's own times agree with them.

    Args:
        rate_hz: frame rate; None if unknown, so that no picture is due at any time.

    Attributes:
        times_s: time of each picture since the first.
        last_s: the video's own time of the last picture since the first.
        is_uneven: whether a picture came at another time than it was due.
    """

    def __init__(self, rate_hz: float | None) -> None:
        self._rate_hz = rate_hz
        self._first_s: float | None = None
        self._base_s, self._since = 0.0, 0
        self.times_s: list[float] = []
        self.last_s = 0.0
        self.is_uneven = False

    def add(self, own_s: float) -> None:
        """Add a picture with the video's own time."""
        self._first_s = own_s if self._first_s is None else self._first_s
        self.last_s = own_s - self._first_s
        if self._rate_hz is None:
            return
        due_s = self._base_s + self._since / self._rate_hz
        is_later = not self.times_s or self.last_s > self.times_s[-1]
        if abs(self.last_s - due_s) > _UNEVEN / self._rate_hz and is_later:
            self._base_s, self._since, due_s, self.is_uneven = self.last_s, 0, self.last_s, True
        self.times_s.append(due_s)
        self._since += 1


def _code(film: cv2.VideoCapture, which: int) -> bytes:
    """Return the four bytes of a code."""
    return int(film.get(which)).to_bytes(4, "little", signed=True)


def _where_else(folder: Path) -> str:
    """Return which inner folder has pictures, or the supported formats."""
    for inner in folders_in(folder):
        return f"but {inner.name}/ has {len(pictures_in(inner))}; give {inner}"
    return f"wanted are {', '.join(SUFFIXES)}"


def folders_in(folder: Path) -> list[Path]:
    """Return the inner folders with pictures, those of thermal ones first, those of depth last."""
    inner = [path for path in folder.iterdir() if path.is_dir() and pictures_in(path)]
    return sorted(inner, key=lambda path: (path.name.startswith("depth"), not _is_thermal(path), path.name))


def _is_thermal(folder: Path) -> bool:
    name = folder.name.lower()
    return name in ("i", "ir", "tir", "lwir") or name.startswith(("infrared", "thermal"))
