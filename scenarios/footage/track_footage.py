"""Run a tracker over footage, and leave a folder like that of a run."""

from __future__ import annotations

import json
import math
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.sheet import FILM_PX, TILE_PX, Annotated, OverlayFilm, Sheet, draw_frame
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.out_folder import check_named
from peopleboy.scenarios.run_folder.tables import TRACKS, Row, track_row, write_table
from peopleboy.scenarios.run_folder.whole_folder import whole_folder
from peopleboy.sim.random_streams import stream
from peopleboy.tracker.boxes import Box, corners
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, track_line, write_truth
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.footage.grey import LEAST_SIDE_PX, Grey, Radiometry, grey_maker
from peopleboy.tracker.footage.pictures import Footage, open_footage
from peopleboy.tracker.footage.plausible import check_plausible
from peopleboy.tracker.footage.truth_files import KEPT_SINGLE, GivenTruth, find_truth, load_truth
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.track import Status, Track, confirmed
from peopleboy.tracker.trackers import FOOTAGE_TRACKER, Introducible, Tracker, explanation_of, make_tracker
from peopleboy.wording import counted

COLOUR_TRACKER: Final = "colour"
"""It differs from `thermal` by what colours add alone."""
DEFAULT_RATE_HZ: Final = 15.0
"""Pictures a second of a folder: those of the robot's cameras, for which the tracker is made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackOptions:
    """What to track, and how.

    Attributes:
        footage: folder of pictures, or a video.
        out: folder to leave.
        colour: folder or video that shows the same view in colour; None for none.
        radiometry: what is known of the pixels.
        rate_hz: pictures a second; None for the footage's own, or `DEFAULT_RATE_HZ`.
        tracker: name of the tracker.
        truth: a truth file; None to look for one beside the pictures.
        start: box of a person in the first picture, or "truth" for that of the truth; None to find people.
        seed: 0 or more; everything random follows from it.
        film: whether to write overlay.mp4.
        overwrite: whether an earlier run in the folder may be replaced.
    """

    footage: Path
    out: Path
    colour: Path | None = None
    radiometry: Radiometry = field(default_factory=Radiometry)
    rate_hz: float | None = None
    tracker: str = FOOTAGE_TRACKER
    truth: Path | None = None
    start: Box | str | None = None
    seed: int = 0
    film: bool = False
    overwrite: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Tracked:
    """What came of it.

    Attributes:
        frames: pictures read.
        per_second: pictures a second of wall time, reading and drawing included.
        tracks: number of track ids.
        scores: against the truth; None without one.
        notes: what was taken as something else than it is.
    """

    frames: int
    per_second: float
    tracks: int
    scores: Scores | None
    notes: tuple[str, ...]


def track_footage(options: TrackOptions, report: Callable[[int, int], None]) -> Tracked:
    """Track people in footage and write the folder, whole or not at all.

    Args:
        options: what, and how.
        report: called after each picture with its number and how many there should be.

    Raises:
        BadInput: footage, truth or an option cannot be used; nothing is written then.
    """
    _check_apart(options)
    footage = open_footage(options.footage)
    colour = None if options.colour is None else open_footage(options.colour)
    truth = _truth_of(options, footage)
    tracker = _tracker_of(options, truth)
    rate = options.rate_hz or footage.rate_hz or DEFAULT_RATE_HZ
    about = _about(options, rate)
    began = time.perf_counter()
    with whole_folder(options.out, about, overwrite=options.overwrite, kind="run") as folder:
        log = _Log(folder, options, truth, rate)
        with log:
            for frame in _frames(footage, colour, options, rate):
                log.add(frame, tracker.update(frame), explanation_of(tracker))
                report(log.frames, footage.expected)
        scores = log.finish()
        about |= {"frames": log.frames, "width": log.size[1], "height": log.size[0]}
        about["notes"] = [*footage.notes, *([] if colour is None else colour.notes)]
    per_second = log.frames / max(time.perf_counter() - began, 1e-9)
    return Tracked(log.frames, per_second, log.tracks, scores, tuple(about["notes"]))


def _check_apart(options: TrackOptions) -> None:
    check_named(options.out)
    for path in (options.footage, options.colour, options.truth):
        if path is not None and path.resolve().is_relative_to(options.out.resolve()):
            raise BadInput(f"{options.out}: would replace {path}, which is read; give another --out")


def _truth_of(options: TrackOptions, footage: Footage) -> GivenTruth | None:
    path = options.truth if options.truth is not None else find_truth(options.footage)
    if path is None:
        if options.start == "truth":
            raise BadInput(f"--start truth: {options.footage} has no truth beside it; give --truth FILE")
        return None
    return load_truth(path, footage.expected if options.footage.is_dir() else None)


def _tracker_of(options: TrackOptions, truth: GivenTruth | None) -> Tracker:
    tracker = make_tracker(options.tracker, stream(options.seed, "tracker"))
    for camera in tracker.cameras:
        if camera not in (THERMAL, COLOUR):
            raise BadInput(f"--tracker {options.tracker}: wants camera {camera!r}, which footage has not")
    if options.tracker == COLOUR_TRACKER and options.colour is None:
        raise BadInput("--tracker colour: needs --colour FOLDER; without it, give --tracker thermal")
    start = options.start
    if start == "truth" and truth is not None:
        start = truth.box_at(1)
    if start is not None and not isinstance(start, str):
        if not isinstance(tracker, Introducible):
            raise BadInput(
                f"--tracker {options.tracker}: cannot be told where a person is; leave --start out"
            )
        tracker.introduce(start)
    return tracker


def _about(options: TrackOptions, rate: float) -> dict[str, Any]:
    radiometry = options.radiometry
    return {
        "status": "complete",
        "footage": options.footage.name,
        "colour": None if options.colour is None else options.colour.name,
        "tracker": options.tracker,
        "seed": options.seed,
        "rate_hz": rate,
        "temperature_range_c": radiometry.span_c,
        "scale": radiometry.scale,
        "start": options.start,
        "versions": versions(),
    }


def _frames(footage: Footage, colour: Footage | None, options: TrackOptions, rate: float) -> Iterator[Frame]:
    """Yield what the tracker sees.

    Raises:
        BadInput: a picture that cannot be used, or a colour picture too few or too many.
    """
    to_grey = grey_maker(options.radiometry, is_robots=options.tracker != FOOTAGE_TRACKER)
    for number, (thermal, picture) in enumerate(zip_longest(footage, () if colour is None else colour)):
        if thermal is None or (colour is not None and picture is None):
            shorter, longer = (
                (options.footage, options.colour) if thermal is None else (options.colour, options.footage)
            )
            raise BadInput(f"{shorter}: ends after {number} pictures, before {longer}; both must be as long")
        if number == 0:
            _check_first(thermal, options, footage.notes)
        values = options.radiometry.values(thermal, footage.notes)
        if number == 0:
            check_plausible(options.radiometry, values)
        images: dict[str, NDArray[np.uint8]] = {THERMAL: to_grey(values)}
        if picture is not None:
            images[COLOUR] = _colour_picture(picture)
        yield Frame(images=images, time_s=number / rate)


def _check_first(thermal: NDArray[Any], options: TrackOptions, notes: list[str]) -> None:
    height, width = thermal.shape[:2]
    if min(height, width) < LEAST_SIDE_PX:
        least = f"{LEAST_SIDE_PX}x{LEAST_SIDE_PX}"
        raise BadInput(f"{options.footage}: pictures must be at least {least}, got {width}x{height}")
    if options.start is not None and not isinstance(options.start, str):
        _check_inside(options.start, width, height)
    if thermal.dtype != np.uint8 and not options.radiometry.is_known:
        notes.append(
            f"{thermal.dtype} pictures without --scale: degC are unknown, grey follows the scene's contrast"
        )


def _check_inside(box: Box, width: int, height: int) -> None:
    left, top, right, bottom = corners(box)
    if not (left >= 0 and top >= 0 and right <= width and bottom <= height):
        told = ",".join(f"{number:g}" for number in box)
        raise BadInput(f"--start {told}: X,Y,W,H must lie inside the pictures, which are {width}x{height}")


def _colour_picture(picture: NDArray[Any]) -> NDArray[np.uint8]:
    if picture.dtype != np.uint8:
        raise BadInput(f"--colour: pictures must be 8-bit, got {picture.dtype}")
    return np.repeat(picture[..., None], 3, axis=2) if picture.ndim == 2 else np.ascontiguousarray(picture)


class _Log:
    """Writes the files of a folder as tracking goes on."""

    def __init__(self, folder: Path, options: TrackOptions, truth: GivenTruth | None, rate_hz: float) -> None:
        self._folder, self._truth = folder, truth
        self._sheet = Sheet(options.footage.resolve().name, has_truth=truth is not None)
        self._means = f"at {rate_hz:g} Hz, tracker {options.tracker}"
        self._stack = ExitStack()
        self._film: OverlayFilm | None = None
        if options.film:
            self._film = self._stack.enter_context(OverlayFilm(folder / "overlay.mp4", rate_hz))
        self._results = self._stack.enter_context(
            (folder / "tracks.txt").open("w", encoding="utf-8", newline="\n")
        )
        self._rows: list[Row] = []
        self._ids: set[int] = set()
        self.frames = 0
        self.size = (0, 0)

    def __enter__(self) -> _Log:
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
        grey = frame.grey(THERMAL)
        self.size = grey.shape[0], grey.shape[1]
        self._rows += [track_row(self.frames, frame.time_s, track, explanation) for track in tracks]
        sure = [track for track in tracks if track.status is not Status.TENTATIVE]
        self._ids |= {track.id for track in sure}
        self._results.writelines(
            track_line(self.frames, track.id, box, track.confidence)
            for track, box in confirmed(tracks, THERMAL)
        )
        height, width = self.size
        if self._film is not None:
            self._film.add(self._drawn(grey, tracks, explanation, math.ceil(FILM_PX / height)))
        if self._sheet.wants(self.frames):
            self._sheet.add(self.frames, self._drawn(grey, tracks, explanation, TILE_PX / width))

    def _drawn(self, grey: Grey, tracks: tuple[Track, ...], explanation: object, scale: float) -> Picture:
        words = f"frame {self.frames}"
        return draw_frame(grey, tracks, self._people(), explanation, scale, words)

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
