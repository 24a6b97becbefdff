"""What a tracker made of footage, as pictures: a contact sheet, and a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Final

import cv2
import numpy as np
from PIL import Image

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.contact_sheet import HEAD_PX, MARGIN_PX, PAGE, draw_head
from peopleboy.scenarios.drawing.overlay import (
    Picture,
    Plate,
    draw_tracks,
    draw_truth,
    enlarge,
)
from peopleboy.tracker.boxes import Box
from peopleboy.tracker.track import Track

FILM_PX: Final = 480
TILE_PX: Final = 400
_KEPT: Final = 24
_MOMENTS: Final = 12
_COLUMNS: Final = 4
_GAP_PX: Final = 6
_WIDTH_PX: Final = 2 * MARGIN_PX + _COLUMNS * TILE_PX + (_COLUMNS - 1) * _GAP_PX
_QUALITY: Final = "20"  # CRF: 0 loses nothing, 18 nothing to be seen


@dataclass(frozen=True, slots=True)
class Annotated:
    """A person of the given truth, as it is drawn."""

    name: str
    box: Box | None
    visible_fraction: float = 1.0


def draw_frame(
    picture: Picture,
    tracks: Sequence[Track],
    people: Sequence[Annotated],
    explanation: object,
    scale: float,
    words: str,
    *,
    camera: str,
) -> Picture:
    """Draw one frame `scale` times enlarged: tracks solid, truth dashed, and a word in the corner.

    Boxes are those in the image of `camera`, which `picture` (H, W, 3) shows.
    """
    plates: list[Plate] = []
    large = enlarge(picture, scale)
    tracked = draw_tracks(large, tracks, scale, explanation, plates=plates, camera=camera)
    drawn = draw_truth(tracked, people, scale, plates=plates)
    for shade, thickness in (((20, 20, 20), 3), ((240, 240, 240), 1)):
        cv2.putText(drawn, words, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, shade, thickness, cv2.LINE_AA)
    return drawn


class Sheet:
    """Keeps moments spread evenly over footage whose length nobody needs to know.

    Args:
        title: what stands above them.
        has_truth: whether truth is drawn too.
    """

    def __init__(self, title: str, *, has_truth: bool) -> None:
        self._title, self._has_truth = title, has_truth
        self._kept: list[tuple[int, Picture]] = []
        self._step = 1

    def wants(self, frame: int) -> bool:
        """Tell whether this frame, from 1, is one to be drawn."""
        return (frame - 1) % self._step == 0

    def add(self, frame: int, picture: Picture) -> None:
        """Keep a frame drawn `TILE_PX` wide; once there are many, every second one is let go."""
        self._kept.append((frame, picture))
        if len(self._kept) > _KEPT:
            self._step *= 2
            self._kept = [(number, kept) for number, kept in self._kept if self.wants(number)]

    def save(self, path: Path, length: str) -> None:
        """Write the sheet as a PNG; how long the footage is, and the tracker, stand above it."""
        chosen = np.unique(np.linspace(0, len(self._kept) - 1, _MOMENTS).round().astype(int))
        tiles = [self._kept[number][1] for number in chosen]
        rows, height = -(-len(tiles) // _COLUMNS), tiles[0].shape[0]
        page = Image.new("RGB", (_WIDTH_PX, HEAD_PX + rows * (height + _GAP_PX) - _GAP_PX + MARGIN_PX), PAGE)
        draw_head(page, self._title, length, has_truth=self._has_truth)
        for number, tile in enumerate(tiles):
            row, column = divmod(number, _COLUMNS)
            left, top = MARGIN_PX + column * (TILE_PX + _GAP_PX), HEAD_PX + row * (height + _GAP_PX)
            page.paste(Image.fromarray(tile), (left, top))
        page.save(path, compress_level=3)


class OverlayFilm:
    """Writes overlay.mp4 frame by frame, H.264, which every browser shows; use it as a context manager.

    Raises:
        BadInput: the package that encodes is not installed.
    """

    def __init__(self, path: Path, rate_hz: float) -> None:
        try:
            import av
        except ImportError as error:
            raise BadInput("--film needs the package av: pip install av") from error
        self._file: Any = av.open(str(path), "w", options={"movflags": "+faststart"})
        rate = round(max(rate_hz, 1.0))
        self._stream: Any = self._file.add_stream(
            "libx264", rate=rate, options={"crf": _QUALITY, "preset": "veryfast"}
        )
        self._stream.pix_fmt = "yuv420p"
        self._frame_of: Any = av.VideoFrame.from_ndarray
        self._is_new = True

    def __enter__(self) -> OverlayFilm:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._file.mux(self._stream.encode(None))
        self._file.close()

    def add(self, picture: Picture) -> None:
        """Add a frame; a last odd row or column is cut off, as H.264 wants it."""
        height, width = (side // 2 * 2 for side in picture.shape[:2])
        if self._is_new:
            self._stream.height, self._stream.width = height, width
            self._is_new = False
        even = np.ascontiguousarray(picture[:height, :width])
        self._file.mux(self._stream.encode(self._frame_of(even, format="rgb24")))
