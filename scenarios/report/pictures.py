"""The pictures of a page: the worst moments of its runs, and their contact sheets."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.contact_sheet import read_tiles
from peopleboy.scenarios.drawing.overlay import encode_jpeg
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.report.charts.stills import DrawnFrame, Origin, images_of, show_frames
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.run_findings import BadMoment, RunFindings, worst_moments
from peopleboy.scenarios.report.findings.sentences import seconds
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.tracker.attention.attend import Focus
from peopleboy.tracker.attention.people.attentive_config import AttentiveConfig
from peopleboy.tracker.attention.people.attentive_explanation import Attended
from peopleboy.tracker.attention.people.person_views import LOOKED_AT, PersonView, box_in
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Box, Status

_JPEG_QUALITY, _TILE_QUALITY = 80, 72
_MOMENTS = 6  # of one run; of two side by side, each has half as many
_RUNS_SHOWN = 4  # of many runs, of which the worst moment is shown

_Stills = Mapping[str, Mapping[int, DrawnFrame]]  # by label of the column, then frame


class PagePicture(NamedTuple):
    """A picture inside the page: its data address, what it shows in words, and what is written below."""

    address: str
    words: str
    caption: str


class PicturedMoment(NamedTuple):
    """A bad moment, whose it is, its pictures, and where they are from."""

    moment: BadMoment
    whose: str
    pictures: Sequence[PagePicture]
    origins: Sequence[Origin]


def pictured_moments(columns: Sequence[Column]) -> list[PicturedMoment]:
    """Show the worst moments: of single runs in time, of many runs the worst of the worst runs.

    Single runs of the same scene are shown side by side at each moment.
    """
    singles = [column for column in columns if column.is_single]
    crowds = [column for column in columns if not column.is_single]
    count = max(_MOMENTS // max(len(singles), 1), 2)
    moments = {column.label: worst_moments(column.found, count) for column in singles}
    is_shared, is_beside = are_same_scene(columns), len(columns) > 1
    everything = [moment for of_run in moments.values() for moment in of_run]
    stills = {
        column.label: _stills(column.found, everything if is_shared else moments[column.label])
        for column in singles
    }
    shown = [
        _pictured(moment, label, stills if is_shared else {label: stills[label]}, is_beside)
        for label, of_run in moments.items()
        for moment in of_run
    ]
    return shown + [moment for column in crowds for moment in _of_many(column, is_beside)]


def contact_sheet(run: FinishedRun) -> list[PagePicture]:
    """The tiles of a run's contact sheet; none if it is gone."""
    try:
        tiles = [(tile.picture, tile.words) for tile in read_tiles(run.folder / "contact_sheet.png")]
    except BadInput:
        return []
    return [PagePicture(page_jpeg(np.asarray(picture), _TILE_QUALITY), said, said) for picture, said in tiles]


def _stills(found: RunFindings, moments: Sequence[BadMoment]) -> dict[int, DrawnFrame]:
    frames = sorted({frame for moment in moments for frame in moment.frames})
    return show_frames(found, [frame for frame in frames if frame <= found.run.frames])


def _of_many(column: Column, is_beside: bool) -> list[PicturedMoment]:
    label, moments = column.label, [(worst_moments(found, _MOMENTS), found) for found in column.runs]
    worst = [(max(of, key=lambda moment: moment.badness), found) for of, found in moments if of]
    worst.sort(key=lambda pair: -pair[0].badness)
    return [
        _pictured(moment, f"{label}, {found.run.title}", {label: _stills(found, [moment])}, is_beside)
        for moment, found in worst[:_RUNS_SHOWN]
    ]


def _pictured(moment: BadMoment, whose: str, stills: _Stills, is_beside: bool) -> PicturedMoment:
    """Return a moment its pictures; where columns stand beside each other, they are distinguished."""
    seen = [(label, of[frame]) for frame in moment.frames for label, of in stills.items() if frame in of]
    pictures = []
    for label, still in seen:
        words = f"{moment.title}, {still.camera} image at {still.time_s:.1f} s, {label}"
        caption = f"{seconds(still.time_s)}{f', {label}' if is_beside else ''}"
        caption += "" if still.camera == THERMAL else f", {still.camera}"
        pictures.append(PagePicture(page_jpeg(still.picture, _JPEG_QUALITY), words, caption))
    return PicturedMoment(moment, whose, pictures, list(dict.fromkeys(still.origin for _, still in seen)))


def page_jpeg(image: NDArray[np.uint8], quality: int) -> str:
    """Return an image as an address for a page."""
    return f"data:image/jpeg;base64,{base64.b64encode(encode_jpeg(image, quality)).decode()}"


# A strip of a page: where attention would look when its person was learned, lost, away, and found again.

_ATTENTIVE: Final = "attentive"  # how the names of such trackers begin
_QUALITY: Final = 80
_THICK: Final = 2


class _Learned(NamedTuple):
    frame: int
    number: int
    camera: str
    box: Box


def attention_strip(found: RunFindings) -> list[PagePicture]:
    """Draw the key moments of the person on whom attention is: each image beside the score of every place.

    There are none for other trackers, for people who were never seen well, and where no images can be had.
    """
    if not found.run.about.tracker.startswith(_ATTENTIVE):
        return []
    try:
        learned = _learned(found)
    except BadInput:
        return []
    if learned is None:
        return []
    moments = {learned.frame: "learned", **_absence(found, learned)}
    images, _ = images_of(found.run, list(moments), learned.camera)
    if learned.frame not in images:
        return []
    return list(_pictures(found, learned, moments, images))


def _learned(found: RunFindings) -> _Learned | None:
    """Find the person who was seen well first, and the first image in which it was known."""
    calibrations = calibrations_of(found.run.robot.cameras)
    camera = next((name for name in LOOKED_AT if name in calibrations), None)
    seen: dict[int, int] = {}
    for number, tracks in sorted(found.files.tracks_by_frame().items()):
        frame = Frame(images={}, calibrations=calibrations, time_s=found.run.time_s(number))
        for track in tracks:
            box = box_in(camera, track, frame) if camera and track.status is Status.TRACKED else None
            if camera is not None and box is not None:
                seen[track.id] = seen.get(track.id, 0) + 1
                if seen[track.id] >= AttentiveConfig().learned_images:
                    return _Learned(number, track.id, camera, box)
    return None


def _absence(found: RunFindings, learned: _Learned) -> dict[int, str]:
    """Name the frames of the person's longest absence: its start, its middle, and its end."""
    who = f"track {learned.number}"
    lines = [line for line in found.run.events if line.frame > learned.frame]
    ends = [one.frame for one in lines if one.kind == "re-identified" and who == (one.other or one.who)]
    lost = [one.frame for one in lines if one.kind == "lost" and one.who == who]
    away = [(next((end for end in ends if end > start), found.run.frames), start) for start in lost]
    if not away:
        return {found.run.frames: "at the end"}
    end, start = max(away, key=lambda one: one[0] - one[1])
    return {start: "lost", (start + end) // 2: "away", end: "found again" if end in ends else "at the end"}


def _pictures(
    found: RunFindings, learned: _Learned, moments: Mapping[int, str], images: Mapping[int, NDArray[np.uint8]]
) -> Iterator[PagePicture]:
    start = Attended.learned(learned.number, PersonView(learned.camera, images[learned.frame], learned.box))
    for frame, what in moments.items():
        if frame in images:
            focus = Attended(start.number, start.camera, start.model, images[frame]).focus()
            caption = f"{seconds(found.run.time_s(frame))}, {what}: at most {focus.score:.2f}"
            picture = page_jpeg(_drawn(images[frame], focus, track_colour(learned.number)), _QUALITY)
            yield PagePicture(picture, f"image, and score of every place, {caption}", caption)


def _drawn(image: NDArray[np.uint8], focus: Focus, colour: Sequence[int]) -> NDArray[np.uint8]:
    """Lay an image (H, W, 3) and its scores beside each other, with a cross and a box at the focus."""
    height, width = image.shape[:2]
    grey = np.rint(255.0 * np.sqrt(np.clip(focus.scores, 0.0, 1.0))).astype(np.uint8)
    scores = cv2.applyColorMap(cv2.resize(grey, (width, height)), cv2.COLORMAP_INFERNO)[..., ::-1]
    both = [np.ascontiguousarray(one) for one in (image, scores)]
    left, top, across, down = (round(edge) for edge in focus.box)
    place = round(focus.place[0]), round(focus.place[1])
    for one in both:
        cv2.rectangle(one, (left, top), (left + across, top + down), tuple(colour), _THICK)
        cv2.drawMarker(one, place, tuple(colour), cv2.MARKER_CROSS, 4 * _THICK * _THICK, _THICK)
    return np.concatenate(both, axis=1)
