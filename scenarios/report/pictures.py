"""Make the pictures of a page: the worst moments of its runs, and their contact sheets.

Moments show the camera by which a run is scored. Images are read from the run's folder if it was run with
frames, or else from its recording. Without both, the run is replayed with the recorded commands, which takes
as long as the run. If that is not possible, as with another version or without a physics engine, only boxes
are drawn.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from enum import StrEnum
from importlib.util import find_spec
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.contact_sheet import read_tiles
from peopleboy.scenarios.drawing.overlay import (
    Picture,
    Plate,
    as_picture,
    box_parts,
    draw_tracks,
    draw_tracks_of,
    draw_truth,
    encode_jpeg,
    enlarge,
)
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.run_findings import BadMoment, RunFindings, worst_moments
from peopleboy.scenarios.report.findings.sentences import seconds
from peopleboy.scenarios.report.page_parts import data_address
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.run_tables import Row, read_explanation
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.cameras.kinds import kind_of, layers_of
from peopleboy.sim.geometry.pinhole import CameraGeometry
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.attention.attend import Focus
from peopleboy.tracker.reproductions.attention.attentive_explanation import Attended
from peopleboy.tracker.reproductions.attention.attentive_tracker import AttentiveConfig
from peopleboy.tracker.reproductions.attention.person_views import LOOKED_AT, PersonView, box_in
from peopleboy.tracker.track import Box, Status

SCALE = 2
CROWD, CROWD_SCALE = 5, 4  # this many people need more room for labels
_WIDE_PX = 480  # of an enlarged image; wide images are enlarged less
_DARK = 40  # grey level of a picture without an image

Image = NDArray[Any]


class Origin(StrEnum):
    """Source of an image."""

    FRAMES = "the run's own image"
    RECORDING = "from the run's recording"
    REPLAY = "rendered again from scenario.yaml"
    CHANGED = "boxes only, as the scene cannot be rendered identically"
    NO_PHYSICS = "boxes only, as PyBullet is not installed"


class DrawnFrame(NamedTuple):
    """A picture of one frame, with its camera, its time and the source of its image."""

    picture: Picture
    camera: str
    time_s: float
    origin: Origin


class _Truth(NamedTuple):
    """Ground truth of a person for drawing."""

    name: str
    box: Box | None
    visible_fraction: float


def show_frames(found: RunFindings, frames: Sequence[int]) -> dict[int, DrawnFrame]:
    """Draw some frames (from 1) of a run, with the newest image of a slow camera."""
    camera, run = found.camera, found.run
    taken = {frame: _newest(frame, run.rate_hz, found.view.rate_hz) for frame in frames}
    wanted = sorted(set(taken.values()))
    recorded = _recorded(run, camera, wanted)
    layer = next(one for one in layers_of(found.view) if one.suffix == kind_of(found.view).shown)
    others = [frame for frame in wanted if frame not in recorded]
    images, origins = images_of(run, others, f"{camera}{layer.suffix}")
    shown = recorded | {frame: layer.show(image) for frame, image in images.items()}
    origins = dict.fromkeys(recorded, Origin.RECORDING) | origins
    drawn = {frame: _draw(found, frame, shown.get(frame)) for frame in wanted}
    return {
        frame: DrawnFrame(drawn[at], camera, run.time_s(at), origins[at])
        for frame, at in sorted(taken.items())
    }


def _newest(frame: int, rate_hz: int, images_hz: int | None) -> int:
    """Return the frame (from 1) of a camera's newest image."""
    step = rate_hz // (images_hz or rate_hz)
    return (frame - 1) // step * step + 1


def _recorded(run: FinishedRun, camera: str, frames: Sequence[int]) -> dict[int, Image]:
    """Read images from the recording, unless the run's folder has images."""
    recording = run.folder / "recording.rrd"
    if run.about.images or not recording.is_file():
        return {}
    from peopleboy.scenarios.recording.recording_file import recorded_images

    return {**recorded_images(recording, camera, frames)}


def images_of(
    run: FinishedRun, frames: Sequence[int], image: str
) -> tuple[dict[int, Image], dict[int, Origin]]:
    """Return a camera's images at some frames (from 1) of a run, and the source of each."""
    stored = _stored(run, frames, image)
    missing = [frame for frame in frames if frame not in stored]
    has_physics = find_spec("pybullet") is not None
    again = _again(run, missing, image) if missing and has_physics else {}
    origins = dict.fromkeys(frames, Origin.CHANGED if has_physics else Origin.NO_PHYSICS)
    origins |= dict.fromkeys(again, Origin.REPLAY) | dict.fromkeys(stored, Origin.FRAMES)
    return stored | again, origins


def _draw(found: RunFindings, frame: int, image: Image | None) -> Picture:
    geometry, plates = found.view.camera, list[Plate]()
    people = [
        _Truth(row["name"], part, row["visible_fraction"])
        for row in _rows(found.seen, frame)
        for part in _parts(row, geometry)
    ]
    size = (geometry.height, geometry.width)
    scale = (CROWD_SCALE if len(found.people) >= CROWD else SCALE) * min(_WIDE_PX / geometry.width, 1.0)
    canvas = enlarge(as_picture(np.full(size, _DARK, np.uint8) if image is None else image), scale)
    tracks = found.files.tracks_by_frame()[frame]
    if found.camera == THERMAL:
        explanation = read_explanation(found.run.about.tracker, _rows(found.files.beliefs, frame))
        canvas = draw_tracks(canvas, tracks, scale, explanation, plates=plates)
    else:
        canvas = draw_tracks_of(
            found.camera, canvas, tracks, {found.camera: found.view}, scale, plates=plates
        )
    return draw_truth(canvas, people, scale, plates=plates)


def _stored(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, Image]:
    """Read the images in the run's folder."""
    images = {}
    for frame in frames:
        path = run.folder / image / image_file(frame)
        found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.is_file() else None
        if found is not None:
            images[frame] = np.ascontiguousarray(found[..., ::-1] if found.ndim == 3 else found)
    return images


def _again(run: FinishedRun, frames: Sequence[int], image: str) -> dict[int, Image]:
    """Replay the run up to the last requested frame, or until the replay differs."""
    from peopleboy.scenarios.export.replay import replay

    images = {}
    with suppress(BadInput):
        for tick in replay(run):
            if tick.frame in frames and image in tick.observation.images:
                images[tick.frame] = tick.observation.images[image]
            if tick.frame >= max(frames):
                break
    return images


def _rows(table: Any, frame: int) -> list[Row]:
    rows: list[Row] = table.filter(np.asarray(table["frame"].to_numpy() == frame)).to_pylist()
    return rows


def _parts(row: Row, camera: CameraGeometry) -> tuple[Box | None, ...]:
    box = (row["left_px"], row["top_px"], row["width_px"], row["height_px"])
    return (None,) if row["left_px"] is None else box_parts(box, camera)


_JPEG_QUALITY, _TILE_QUALITY = 80, 72
_MOMENTS = 6  # moments of one run; two runs side by side have half as many each
_RUNS_SHOWN = 4  # runs of a group of which the worst moment is shown

_Stills = Mapping[str, Mapping[int, DrawnFrame]]  # by label of the column, then frame


class PagePicture(NamedTuple):
    """An embedded picture: its data URL, its text alternative, and its caption."""

    address: str
    words: str
    caption: str


class PicturedMoment(NamedTuple):
    """A moment, the label of its run, its pictures, and their sources."""

    moment: BadMoment
    whose: str
    pictures: Sequence[PagePicture]
    origins: Sequence[Origin]


def pictured_moments(columns: Sequence[Column]) -> list[PicturedMoment]:
    """Return the worst moments: of single runs in time order, of many runs the worst of the worst runs.

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
    """Return the tiles of a run's contact sheet; none if the file is missing."""
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
    """Return a moment with its pictures; captions name the column if there are several."""
    seen = [(label, of[frame]) for frame in moment.frames for label, of in stills.items() if frame in of]
    pictures = []
    for label, still in seen:
        words = f"{moment.title}, {still.camera} image at {still.time_s:.1f} s, {label}"
        caption = f"{seconds(still.time_s)}{f', {label}' if is_beside else ''}"
        caption += "" if still.camera == THERMAL else f", {still.camera}"
        pictures.append(PagePicture(page_jpeg(still.picture, _JPEG_QUALITY), words, caption))
    return PicturedMoment(moment, whose, pictures, list(dict.fromkeys(still.origin for _, still in seen)))


def page_jpeg(image: NDArray[np.uint8], quality: int) -> str:
    """Return an image as a data URL."""
    return data_address("image/jpeg", encode_jpeg(image, quality))


# Strip of attention scores at key moments: person learned, lost, away, and found again.

_ATTENTIVE: Final = "attentive"  # prefix of the names of such trackers
_QUALITY: Final = 80
_THICK: Final = 2


class _Learned(NamedTuple):
    frame: int
    number: int
    camera: str
    box: Box


def attention_strip(found: RunFindings) -> list[PagePicture]:
    """Draw the key moments of the person that attention has learned: image and score of every place.

    The result is empty for other trackers, for people who were never clearly visible, and without images.
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
    """Find the first person who was clearly visible, and the first image after learning."""
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
    """Return start, middle and end of the person's longest absence, as names by frame."""
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
    """Place an image (H, W, 3) and its scores side by side, with a cross and a box at the focus."""
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
