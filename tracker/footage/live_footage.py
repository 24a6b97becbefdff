"""Images of a camera, a network stream or a pipe as they come, of which only the newest is kept."""

import math
import os
import re
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from threading import Condition, Thread
from typing import Final
from urllib.parse import urlsplit

import cv2
import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.image_sequences import open_capture
from peopleboy.tracker.footage.read_tiff import Raw
from peopleboy.wording import counted

STANDARD_INPUT: Final = "-"
_POLL_S: Final = 0.1  # how often `stop` is noticed while no image comes
_PIPE: Final = "pipe:0"  # FFmpeg's name of standard input
_NUMBER: Final = re.compile(r"\d+")
_DEVICE: Final = re.compile(r"/dev/video\d+")
_SIZE: Final = re.compile(r"([1-9]\d{0,4})x([1-9]\d{0,4})")


class PixelFormat(StrEnum):
    """Format of raw pixels, by FFmpeg's name; 16 bits are little-endian unless the name says otherwise."""

    GREY8 = "gray"
    GREY16 = "gray16"
    GREY16_BIG_ENDIAN = "gray16be"
    RGB = "rgb24"
    BGR = "bgr24"


_TYPES: Final = {PixelFormat.GREY16: "<u2", PixelFormat.GREY16_BIG_ENDIAN: ">u2"}


@dataclass(frozen=True, slots=True)
class RawFormat:
    """Layout of raw images, one after the other.

    Attributes:
        size: width and height [px].
        pixels: format of the pixels.
    """

    size: tuple[int, int]
    pixels: PixelFormat

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of an image."""
        width, height = self.size
        is_colour = self.pixels in (PixelFormat.RGB, PixelFormat.BGR)
        return (height, width, 3) if is_colour else (height, width)

    @property
    def size_bytes(self) -> int:
        """Bytes of an image."""
        return math.prod(self.shape) * np.dtype(_TYPES.get(self.pixels, "u1")).itemsize

    def image(self, content: bytes) -> Raw:
        """Return an image (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB."""
        image = np.frombuffer(content, _TYPES.get(self.pixels, "u1")).reshape(self.shape)
        if self.pixels is PixelFormat.BGR:
            image = image[..., ::-1]
        return image.astype(np.uint16 if self.pixels in _TYPES else np.uint8)


def parse_size(text: str) -> tuple[int, int]:
    """Parse a size, such as 640x512.

    Raises:
        BadInput: it is none.
    """
    found = _SIZE.fullmatch(text)
    if found is None:
        raise BadInput(f"--size must be WIDTHxHEIGHT in pixels, such as 640x512, got {text!r}")
    return int(found[1]), int(found[2])


@dataclass(frozen=True, slots=True)
class LiveSource:
    """Where images come from.

    Attributes:
        address: number or path of a camera, address of a stream, or "-" for standard input.
        raw: layout of raw images on standard input; None for encoded video.
    """

    address: str
    raw: RawFormat | None = None

    def __post_init__(self) -> None:
        """Check that only a pipe has raw images."""
        if self.raw is not None and self.address != STANDARD_INPUT:
            raise BadInput(
                f"{self.name}: --size and --pixels are for raw images on standard input; leave them out, or "
                "give -"
            )

    @property
    def name(self) -> str:
        """Name without user, password and query."""
        if self.address == STANDARD_INPUT:
            return "standard input"
        if "://" not in self.address:
            return f"camera {self.address}"
        parts = urlsplit(self.address)
        return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"

    def __str__(self) -> str:
        """Return the name, for messages."""
        return self.name

    def images(self) -> Iterator[Raw]:
        """Read images until the source ends.

        Raises:
            BadInput: the source cannot be opened, or ends within an image.
        """
        if self.raw is not None:
            yield from _read_raw(self.raw)
            return
        video = self._open()
        try:
            while True:
                is_read, image = video.read()
                if not is_read:
                    return
                yield np.asarray(image[..., ::-1])
        finally:
            video.release()

    def _open(self) -> cv2.VideoCapture:
        if self.address == STANDARD_INPUT:
            advice = "give --size and --pixels for raw images"
            return open_capture(_PIPE, f"{self.name}: cannot be read as a video; {advice}")
        where = int(self.address) if _NUMBER.fullmatch(self.address) else self.address
        return open_capture(
            where, f"{self.name}: cannot be opened; is it connected, and not in use by another program?"
        )


def is_live(text: str) -> bool:
    """Return whether the text names a live source: -, a camera's number or device, or a stream's address."""
    if text == STANDARD_INPUT or "://" in text:
        return True
    if _DEVICE.fullmatch(text):
        return True
    return _NUMBER.fullmatch(text) is not None and not Path(text).exists()


def _read_raw(raw: RawFormat) -> Iterator[Raw]:
    file = sys.stdin.fileno()
    while True:
        content = bytearray()
        # Unbuffered, so that the program can end while a read waits.
        while len(content) < raw.size_bytes and (part := os.read(file, raw.size_bytes - len(content))):
            content += part
        if not content:
            return
        if len(content) < raw.size_bytes:
            width, height = raw.size
            raise BadInput(
                f"standard input: ends within an image, after {len(content)} of its {raw.size_bytes} bytes; "
                f"are images {width}x{height} and {raw.pixels}?"
            )
        yield raw.image(bytes(content))


class LiveFootage:
    """The newest image of a live source, whenever one is asked for; others are dropped, not queued.

    Args:
        source: where images come from.
        rate_hz: rate of the images, which gives their times; None for the times at which they come.

    Attributes:
        received: number of images that came.
        dropped: number of those that were replaced by a newer one before they were asked for.
    """

    is_exact = False
    numbers: range | None = None
    expected = 0

    def __init__(self, source: LiveSource, rate_hz: float | None = None) -> None:
        self._source, self.rate_hz = source, rate_hz
        self.name = source.name
        self.notes: list[str] = []
        self.times_s: list[float] | None = []
        self.received = self.dropped = 0
        self._changed = Condition()
        self._newest: tuple[Raw, float] | None = None
        self._error: BaseException | None = None
        self._is_ended = self._is_stopped = False

    def __iter__(self) -> Iterator[Raw]:
        """Yield the newest images until the source ends or `stop` is called.

        Raises:
            BadInput: the source cannot be read, or no image came.
        """
        Thread(target=self._receive, daemon=True).start()
        times: list[float] = []
        self.times_s = times
        while (newest := self._wait()) is not None:
            image, time_s = newest
            times.append(time_s)
            yield image
        if self._error is not None and not (times and isinstance(self._error, BadInput)):
            raise self._error
        if not times:
            raise BadInput(f"{self.name}: no image came")
        if self._error is not None:
            self.notes.append(str(self._error))
        is_unpaced = 2 * self.dropped > self.received
        advice = "; track a recorded video as a file, or pace it by `ffmpeg -re`" if is_unpaced else ""
        self.notes.append(
            f"{self.name}: {self.dropped} of {counted(self.received, 'image')} dropped, since newer ones "
            f"came while others were processed{advice}"
        )

    def stop(self) -> None:
        """End the iteration after the image that is processed now."""
        self._is_stopped = True  # without the lock, since a signal handler may interrupt its holder

    def _wait(self) -> tuple[Raw, float] | None:
        """Return the newest image and its time since the first; None at the end."""
        with self._changed:
            while self._newest is None and not (self._is_ended or self._is_stopped):
                self._changed.wait(_POLL_S)
            newest, self._newest = self._newest, None
            return None if self._is_stopped else newest

    def _receive(self) -> None:
        start_s = None
        try:
            for image in self._source.images():
                now_s = time.monotonic()
                start_s = now_s if start_s is None else start_s
                time_s = now_s - start_s if self.rate_hz is None else self.received / self.rate_hz
                with self._changed:
                    if self._is_stopped:
                        return
                    self.received += 1
                    self.dropped += self._newest is not None
                    self._newest = image, time_s
                    self._changed.notify()
        except BaseException as error:  # raised where images are asked for
            self._error = error
        finally:
            self._is_ended = True
