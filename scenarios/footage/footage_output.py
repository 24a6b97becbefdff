"""Write the output of tracked footage: log, contact sheet and video."""

import json
import math
import shutil
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

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
from peopleboy.scenarios.export.video import FilmWriter
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import Views
from peopleboy.scenarios.run_folder.run_tables import TRACKS, TableFile, track_row
from peopleboy.tracker.boxes import Box
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, track_line, write_annotations
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.footage_truth import KEPT_SINGLE, GivenTruth
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track, confirmed
from peopleboy.wording import counted

FILM_PX: Final = 480
TILE_PX: Final = 400
_KEPT: Final = 24
_MOMENTS: Final = 12
_COLUMNS: Final = 4
_GAP_PX: Final = 6
_WIDTH_PX: Final = 2 * MARGIN_PX + _COLUMNS * TILE_PX + (_COLUMNS - 1) * _GAP_PX


@dataclass(frozen=True, slots=True)
class Annotated:
    """A person in the given ground truth, as drawn."""

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
    """Draw one frame, enlarged by `scale`: tracks solid, ground truth dashed, and a label in the corner.

    Boxes are in the image of `camera`, which `picture` (H, W, 3) shows.
    """
    plates: list[Plate] = []
    large = enlarge(picture, scale)
    tracked = draw_tracks(large, tracks, scale, explanation, plates=plates, camera=camera)
    drawn = draw_truth(tracked, people, scale, plates=plates)
    for shade, thickness in (((20, 20, 20), 3), ((240, 240, 240), 1)):
        cv2.putText(drawn, words, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, shade, thickness, cv2.LINE_AA)
    return drawn


class Sheet:
    """Collect frames spread evenly over footage of unknown length.

    Args:
        title: heading of the sheet.
        has_truth: whether ground truth is drawn as well.
    """

    def __init__(self, title: str, *, has_truth: bool) -> None:
        self._title, self._has_truth = title, has_truth
        self._kept: list[tuple[int, Picture]] = []
        self._step = 1

    def wants(self, frame: int) -> bool:
        """Return whether this frame, counted from 1, should be drawn."""
        return (frame - 1) % self._step == 0

    def add(self, frame: int, picture: Picture) -> None:
        """Add a frame drawn `TILE_PX` wide; when there are too many, every second one is dropped."""
        self._kept.append((frame, picture))
        if len(self._kept) > _KEPT:
            self._step *= 2
            self._kept = [(number, kept) for number, kept in self._kept if self.wants(number)]

    def save(self, path: Path, length: str) -> None:
        """Write the sheet as a PNG; `length` describes footage and tracker in the heading."""
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


class FootageLog:
    """Write the files of a folder while tracking; use it as a context manager.

    Args:
        folder: output folder.
        options: options of the tracking.
        views: the footage.
        truth: ground truth of the footage; None for none.
    """

    def __init__(self, folder: Path, options: TrackOptions, views: Views, truth: GivenTruth | None) -> None:
        self._folder, self._views, self._truth = folder, views, truth
        self._sheet = Sheet(options.name, has_truth=truth is not None)
        self._tracker = options.shown_tracker
        self._stack = ExitStack()
        self._film: FilmWriter | None = None
        if options.video:
            path, rate_hz = folder / "overlay.mp4", round(max(views.rate_hz, 1.0))
            self._film = self._stack.enter_context(FilmWriter(path, rate_hz, "--video"))
        self._results = self._stack.enter_context(
            (folder / "tracks.txt").open("w", encoding="utf-8", newline="\n")
        )
        self._table = TableFile(folder / "tracks.parquet", TRACKS)
        self._ids: set[int] = set()
        self.frames = 0
        self.size = (0, 0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)

    @property
    def tracks(self) -> int:
        """Number of confirmed track ids."""
        return len(self._ids)

    def add(self, frame: Frame, tracks: tuple[Track, ...], explanation: object) -> None:
        """Write one frame."""
        self.frames += 1
        camera = self._views.camera
        height, width = self.size = frame.images[camera].shape[:2]
        rows = (track_row(self.frames, frame.time_s, track, explanation, camera) for track in tracks)
        self._table.add(rows)
        sure = [track for track in tracks if track.status is not Status.TENTATIVE]
        self._ids |= {track.id for track in sure}
        self._results.writelines(
            track_line(self.frames, track.id, box, track.confidence)
            for track, box in confirmed(tracks, camera)
        )
        if self._film is not None:
            self._film.add(self._drawn(frame, tracks, explanation, math.ceil(FILM_PX / height)))
        if self._sheet.wants(self.frames):
            self._sheet.add(self.frames, self._drawn(frame, tracks, explanation, TILE_PX / width))

    def _drawn(self, frame: Frame, tracks: tuple[Track, ...], explanation: object, scale: float) -> Picture:
        picture, words = self._views.picture(frame), f"frame {self.frames}"
        return draw_frame(
            picture, tracks, self._people(), explanation, scale, words, camera=self._views.camera
        )

    def _people(self) -> list[Annotated]:
        if self._truth is None:
            return []
        truth = self._truth.truth
        here = np.flatnonzero(truth.frame == self.frames)
        return [Annotated(f"truth {truth.id[row]}", tuple(truth.box[row].tolist())) for row in here]

    def finish(self) -> Scores | None:
        """Write tables, contact sheet and scores."""
        self._table.close()
        rate = f"at {self._views.rate_hz:.3g} Hz"
        length = f"{counted(self.frames, 'frame')} {rate}, tracker {self._tracker}"
        self._sheet.save(self._folder / "contact_sheet.png", length)
        if self._truth is None:
            return None
        if self._truth.is_single and self._truth.truth.last_frame > self.frames:
            last = self._truth.truth.last_frame
            raise BadInput(
                f"{self._truth.path}: must have a line for each of the {self.frames} images, got {last}"
            )
        (self._folder / "truth").mkdir()
        if self._truth.table is None:
            shutil.copyfile(self._truth.path, self._folder / KEPT_SINGLE)
        else:
            write_annotations(self._folder / "truth" / "gt.txt", self._truth.table)
        return self._score(self._truth)

    def _score(self, given: GivenTruth) -> Scores:
        tracks = read_tracks(self._folder / "tracks.txt")
        scores = evaluate(
            given.truth,
            tracks,
            frames=self.frames,
            min_visible=given.min_visible,
            around=given.around,
            is_single=given.is_single,
        )
        text = json.dumps(to_json(scores), indent=2) + "\n"
        (self._folder / "metrics.json").write_text(text, encoding="utf-8")
        return scores
