"""Run a tracker over footage, write a folder like that of a run, and summarise the result."""

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any, Final

from peopleboy.bad_input import BadInput
from peopleboy.own_code import at_frame, traceback_to
from peopleboy.scenarios.footage.footage_output import FootageLog
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import Views, open_views
from peopleboy.scenarios.run_folder.atomic_output import atomic_folder, check_named
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.run_files import check_detections
from peopleboy.scenarios.running.gallery_file import use_gallery
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.latency import write_latency
from peopleboy.tracker.footage.box_kinds import BoxKind, torso_of
from peopleboy.tracker.footage.footage_truth import GivenTruth, doubts, find_truth, load_truth
from peopleboy.tracker.footage.grey import Polarity
from peopleboy.tracker.frame import DEPTH, PANORAMA, THERMAL, Frame
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import Introducible, Tracker, explanation_of, is_own, make_tracker
from peopleboy.wording import counted


@dataclass(frozen=True, slots=True, eq=False)
class Tracked:
    """Summary of tracked footage.

    Attributes:
        frames: number of images.
        per_second: images per second of wall time, over the later half, including reading and drawing.
        tracks: number of track ids.
        scores: scores against the ground truth; None without ground truth.
        notes: notes on the interpretation of the inputs.
        boxes: what the boxes enclose; None for your own tracker or detector, if unknown.
    """

    frames: int
    per_second: float
    tracks: int
    scores: Scores | None
    notes: tuple[str, ...]
    boxes: BoxKind | None


ShowTracks = Callable[[int, Frame, Sequence[Track]], bool]
"""Shows the tracks of an image, with its number, and returns whether the reader has closed it."""


def track_footage(
    options: TrackOptions,
    report: Callable[[int, int], None],
    shows: Sequence[ShowTracks] = (),
) -> Tracked:
    """Track people in footage and write the output folder atomically.

    A live source ends with Ctrl-C as if it had ended by itself.

    Args:
        options: options of the tracking.
        report: called after each image with its number and the expected number of images.
        shows: called after each image; if one is closed, a live source ends.

    Raises:
        BadInput: footage, ground truth or an option is invalid, or the tracker returned an invalid value;
            nothing is written.
        OwnCodeFailed: the tracker raised an error; only the traceback is written, beside the folder.
    """
    _check_apart(options)
    views = open_views(options)
    truth = _truth_of(options, views)
    kind = _kind_of(options, truth)
    made = _tracker_of(options, views, truth, kind)
    save_gallery = use_gallery(made, options.shown_tracker, options.gallery, options.out)
    tracker = CheckedTracker(made, f"tracker {options.shown_tracker!r}", views.cameras, kind)
    if views.is_exact:
        check_detections(options.tracker, views.expected)
    about = _about(options, views) | {"boxes": kind}
    times = [time.perf_counter()]
    trace = options.out.with_name(f"{options.out.name}-traceback.txt")
    with (
        traceback_to(trace),
        atomic_folder(options.out, about, overwrite=options.overwrite, kind="run") as folder,
    ):
        log = FootageLog(folder, options, views, truth)
        with log, _stopped_by_interrupt(views):
            for frame in views:
                with at_frame(log.frames + 1):
                    tracks = tracker.update(frame)
                    explanation = explanation_of(tracker)
                log.add(frame, tracks, explanation)
                closed = [show(log.frames, frame, tracks) for show in shows]
                if any(closed) and views.stop is not None:
                    views.stop()
                times.append(time.perf_counter())
                report(log.frames, views.expected)
        scores = log.finish()
        write_latency(folder, tracker.times_ms)
        save_gallery()
        about |= {"frames": log.frames, "width": log.size[1], "height": log.size[0]}
        about["rate_hz"] = views.rate_hz  # of a live source, known by now
        if truth is not None:
            about["protocol"] = truth.protocol
        about["notes"] = notes = [*views.notes, *_notes_on(truth, log.size)]
    return Tracked(log.frames, pictures_a_second(times), log.tracks, scores, tuple(notes), kind)


@contextmanager
def _stopped_by_interrupt(views: Views) -> Iterator[None]:
    """Let Ctrl-C stop a live source after the present image; a second one interrupts."""
    if views.stop is None or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)

    def stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        signal.signal(signal.SIGINT, before)
        if views.stop is not None:
            views.stop()

    signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def pictures_a_second(times_s: Sequence[float]) -> float:
    """Return the images per second of the later half; the first images include compiling kernels.

    Args:
        times_s: start time of the first image, and end time of each.
    """
    half = (len(times_s) - 1) // 2
    return (len(times_s) - 1 - half) / max(times_s[-1] - times_s[half], 1e-9)


def _check_apart(options: TrackOptions) -> None:
    check_named(options.out)
    for path in options.read:
        if path.resolve().is_relative_to(options.out.resolve()):
            raise BadInput(f"{options.out}: would replace the input {path}; give another --out")


def _truth_of(options: TrackOptions, views: Views) -> GivenTruth | None:
    path = options.truth
    if path is None and options.path is not None:
        path = find_truth(options.path)
    if path is None:
        if options.start == "truth":
            raise BadInput(f"--start truth: {options.footage} has no ground truth; give --truth FILE")
        return None
    frames = views.expected if views.is_exact else None
    return load_truth(path, frames, views.numbers, options.protocol)


def _notes_on(truth: GivenTruth | None, size: tuple[int, int]) -> list[str]:
    """Return how the ground truth was read, and what is suspicious for images of a size (H, W)."""
    return [] if truth is None else [*truth.notes, *doubts(truth.truth, size[1], size[0])]


def _kind_of(options: TrackOptions, truth: GivenTruth | None) -> BoxKind | None:
    if is_own(options.tracker):
        if options.boxes is not None:
            raise BadInput(f"--boxes {options.boxes}: not with your own tracker or detector; leave it out")
        return None
    if options.boxes is not None:
        return options.boxes
    return BoxKind.WHOLE if truth is None else BoxKind.of(truth.truth)


def _tracker_of(
    options: TrackOptions, views: Views, truth: GivenTruth | None, kind: BoxKind | None
) -> Tracker:
    tracker = make_tracker(options.tracker, options.seed)
    for camera in tracker.cameras:
        if camera not in views.cameras:
            raise BadInput(f"--tracker {options.tracker}: {_lack(camera, options)}")
    start = options.start
    if start == "truth" and truth is not None:
        start = truth.box_at(1)
    if start is not None and not isinstance(start, str):
        if THERMAL not in tracker.cameras or not isinstance(tracker, Introducible):
            raise BadInput(
                f"--tracker {options.tracker}: cannot be initialised with a box; leave --start out"
            )
        tracker.introduce(torso_of(start) if kind is BoxKind.WHOLE else start)
    return tracker


def _lack(camera: str, options: TrackOptions) -> str:
    """Describe why a camera is missing."""
    if camera == DEPTH:
        return "needs camera 'depth'; give --depth FOLDER"
    if options.rgbd is not None:
        return f"needs camera {camera!r}, but --depth gives depth and colour; leave --depth out"
    if options.panorama is not None:
        return f"needs camera {camera!r}, but --panorama gives panoramas; leave --panorama out"
    if camera == PANORAMA:
        return "needs camera 'panorama'; give --panorama KIND"
    return f"needs camera {camera!r}, which footage does not have"


def _about(options: TrackOptions, views: Views) -> dict[str, Any]:
    return {
        "status": "complete",
        "footage": options.name,
        "tracker": options.shown_tracker,
        "seed": options.seed,
        "rate_hz": views.rate_hz,
        **views.about(),
        "start": options.start,
        "versions": versions(),
    } | ({} if options.gallery is None else {"gallery": options.gallery.name})


_ROUND: Final = {
    BoxKind.TORSO: ", boxes enclose torsos",
    BoxKind.WHOLE: ", boxes enclose whole people",
    None: "",
}


def outcome_lines(tracked: Tracked, options: TrackOptions) -> tuple[str, str]:
    """Return a summary, and the files that show the result, or hints if no person was detected."""
    count = f"{counted(tracked.frames, 'frame')}, {counted(tracked.tracks, 'track')}{_ROUND[tracked.boxes]}"
    sheet = options.out / "contact_sheet.png"
    if not tracked.tracks:
        shown = f"No person was detected. Check {sheet}: {_what_to_look_at(options)}"
    elif options.video:
        shown = f"{sheet} and {options.out / 'overlay.mp4'} show them."
    else:
        shown = f"{sheet} shows them."
    return f"{count}, {tracked.per_second:.0f} frames/s", shown


def _what_to_look_at(options: TrackOptions) -> str:
    if options.rgbd is not None:
        return (
            "is the camera's pose right (--camera-height-m, --pitch-deg)? Do people stand upright? Are they "
            "within depth range?"
        )
    if options.panorama is not None:
        return (
            "is the camera upright, and is its height right (--camera-height-m)? Are the elevations of the "
            "borders right (--elevation-deg)? Are people within 7 m?"
        )
    is_black_hot = options.radiometry.polarity is Polarity.BLACK_HOT
    remedy = f"give --polarity {Polarity.WHITE_HOT if is_black_hot else Polarity.BLACK_HOT}"
    asked = f"are warm objects bright? If not, {remedy}."
    if options.tracker in VARIANTS:
        asked += f" Are people {_heights(options.tracker)} of the image height, from head to feet?"
        if not options.radiometry.is_known:
            asked += " Are temperatures known? Then give --temperature-range (8 bit) or --scale (16 bit)."
    return f"{asked} Is the people's outline visible, or only a hot face?"


def _heights(tracker: str) -> str:
    """Describe the heights of people that a tracker detects; taller ones than the image are cropped."""
    config = VARIANTS[tracker]
    low, high = (config.box.height_per_h * share for share in config.detector.limits.h)
    return f"at least {low:.0%}" if high >= 1 else f"{low:.0%} to {high:.0%}"
