"""The files that tracking in footage leaves."""

from __future__ import annotations

import json
import math
import shutil
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.sheet import FILM_PX, TILE_PX, Annotated, OverlayFilm, Sheet, draw_frame
from peopleboy.scenarios.footage.views import Views
from peopleboy.scenarios.run_folder.tables import TRACKS, Row, track_row, write_table
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, track_line, write_truth
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.truth_files import KEPT_SINGLE, GivenTruth
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track, confirmed
from peopleboy.wording import counted


class FootageLog:
    """Writes the files of a folder as tracking goes on; use it as a context manager.

    Args:
        folder: to write to.
        options: what is tracked.
        views: the footage.
        truth: of it; None for none.
    """

    def __init__(self, folder: Path, options: TrackOptions, views: Views, truth: GivenTruth | None) -> None:
        self._folder, self._views, self._truth = folder, views, truth
        self._sheet = Sheet(options.footage.resolve().name, has_truth=truth is not None)
        self._means = f"at {views.rate_hz:g} Hz, tracker {options.tracker}"
        self._stack = ExitStack()
        self._film: OverlayFilm | None = None
        if options.film:
            self._film = self._stack.enter_context(OverlayFilm(folder / "overlay.mp4", views.rate_hz))
        self._results = self._stack.enter_context(
            (folder / "tracks.txt").open("w", encoding="utf-8", newline="\n")
        )
        self._rows: list[Row] = []
        self._ids: set[int] = set()
        self.frames = 0
        self.size = (0, 0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)

    @property
    def tracks(self) -> int:
        """How many people were confirmed."""
        return len(self._ids)

    def add(self, frame: Frame, tracks: tuple[Track, ...], explanation: object) -> None:
        """Write one frame."""
        self.frames += 1
        camera = self._views.camera
        height, width = self.size = frame.images[camera].shape[:2]
        self._rows += [track_row(self.frames, frame.time_s, track, explanation, camera) for track in tracks]
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
        """Write tables, pictures and scores."""
        write_table(self._folder / "tracks.parquet", self._rows, TRACKS)
        length = f"{counted(self.frames, 'frame')} {self._means}"
        self._sheet.save(self._folder / "contact_sheet.png", length)
        if self._truth is None:
            return None
        if self._truth.is_single and self._truth.truth.last_frame > self.frames:
            last = self._truth.truth.last_frame
            raise BadInput(
                f"{self._truth.path}: must have a line for each of the {self.frames} pictures, got {last}"
            )
        (self._folder / "truth").mkdir()
        if self._truth.is_single:
            shutil.copyfile(self._truth.path, self._folder / KEPT_SINGLE)
        else:
            write_truth(self._folder / "truth" / "gt.txt", self._truth.truth)
        return self._score(self._truth)

    def _score(self, given: GivenTruth) -> Scores:
        tracks = read_tracks(self._folder / "tracks.txt")
        scores = evaluate(given.truth, tracks, frames=self.frames, is_single=given.is_single)
        text = json.dumps(to_json(scores), indent=2) + "\n"
        (self._folder / "metrics.json").write_text(text, encoding="utf-8")
        return scores
