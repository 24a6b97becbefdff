"""Real thermal clips with ground truth, and the evaluation of trackers and peers on them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Final, Literal

import numpy as np

from benchmarks.compare import timed_ms
from benchmarks.peers.ours import Detecting, Ours
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.options import DEFAULT_RATE_HZ, TrackOptions
from peopleboy.scenarios.footage.thermal_views import ThermalViews
from peopleboy.scenarios.footage.views import open_views
from peopleboy.scenarios.running.engine.task import ReportProgress
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_truth
from peopleboy.tracker.evaluation.protocols import CLASSES, PERSON, RULES, Protocol
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.footage_truth import GivenTruth, find_truth, load_truth
from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own

CHOSEN_BY: Final = ("camel_01", "camel_02", "camel_08", "camel_11", "camel_21", "llvip")
"""The clips that may be used for tuning; all others are only for evaluation."""
TRUTH: Final = "gt.txt"
_PEOPLE: Final = replace(RULES[Protocol.PEOPLEBOY], ignored=tuple(kind for kind in CLASSES if kind != PERSON))
PEERS: Final[Mapping[str, tuple[Literal["hog", "ssdlite", "nanodet"], float]]] = {
    "HOG x 2 + ByteTrack": ("hog", 2.0),
    "HOG x 3 + ByteTrack": ("hog", 3.0),
    "SSDLite + ByteTrack": ("ssdlite", 1.0),
    "NanoDet + ByteTrack": ("nanodet", 1.0),
}
"""Detector and enlargement of images per peer; HOG detects people from 96 px of the enlarged image on."""


@dataclass(frozen=True, slots=True, eq=False)
class RealClip:
    """The first frames of a clip.

    Attributes:
        folder: folder of the clip; its images are there or in a subfolder such as `thermal`.
        given: ground truth of these frames.
        frames: number of frames.
        step: frames of the camera per frame.
    """

    folder: Path
    given: GivenTruth
    frames: int
    step: int = 1

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.name


def open_clips(home: Path, only: Sequence[str] = (), frames: int | None = None) -> list[RealClip]:
    """Open the clips of a folder: those used for tuning, then the others, by name.

    Args:
        home: folder with one subfolder per clip.
        only: names of clips; empty for all.
        frames: number of frames per clip, from the first on; None for all.

    Raises:
        BadInput: there are no clips, or a named clip is missing or cannot be used.
    """
    there = {one.name: one for one in home.iterdir() if find_truth(one) is not None}
    missing = [name for name in only if name not in there]
    if missing or not there:
        found = ", ".join(sorted(there)) or "none"
        raise BadInput(f"{home}: no clip {' '.join(missing)} with images and {TRUTH}; choose from {found}")
    names = sorted(only or there, key=lambda name: (name not in CHOSEN_BY, name))
    return [_open(there[name], frames) for name in names]


def _open(folder: Path, frames: int | None) -> RealClip:
    path, there = find_truth(folder), open_footage(folder).expected
    assert path is not None
    count = there if frames is None else min(frames, there)
    given = _load(path, there)
    return RealClip(folder, replace(given, truth=_first(given.truth, count)), count)


def _load(path: Path, frames: int) -> GivenTruth:
    """Read the ground truth; objects that are not people, such as bicycles, are ignored in scoring."""
    if path.name == TRUTH:
        return GivenTruth(read_truth(path, _PEOPLE), is_single=False, path=path)
    return load_truth(path, frames)


def _first(truth: TrueBoxes, frames: int) -> TrueBoxes:
    return truth.take(truth.frame <= frames)


@dataclass(frozen=True, slots=True, eq=False)
class ClipResult:
    """Result of one tracker, clip and seed.

    Attributes:
        scores: metrics of the tracks.
        frame_s: median CPU time per frame, without reading of images [s].
        detections: all detections, before tracking; none of a tracker without any.
    """

    scores: Scores
    frame_s: float
    detections: TrackBoxes


@dataclass(frozen=True, slots=True, eq=False)
class ClipTask:
    """Run a tracker on a clip.

    Attributes:
        clip: the clip.
        tracker: name of a tracker, or of one of `PEERS`.
        seed: seed of the tracker; peers are deterministic.
        rate_hz: frame rate of the camera; None for the default of folders.
    """

    clip: RealClip
    tracker: str
    seed: int
    rate_hz: float | None = None

    @property
    def name(self) -> str:
        """Name of clip, tracker and seed."""
        return f"{self.clip.name}, {self.tracker}, seed {self.seed}"

    @property
    def size(self) -> int:
        """Number of frames."""
        return self.clip.frames

    def __call__(self, report_progress: ReportProgress) -> ClipResult:
        """Run the tracker from the first frame on.

        Raises:
            BadInput: the tracker is unknown or needs other cameras, or an image cannot be used.
        """
        contestant = make_clip_tracker(self.tracker, self.seed)
        name = DEFAULT_TRACKER if self.tracker in PEERS else self.tracker
        return run_clip(self.clip, contestant, name, self.rate_hz, report_progress)


def run_clip(
    clip: RealClip, contestant: Detecting, name: str, rate_hz: float | None, report_progress: ReportProgress
) -> ClipResult:
    """Run a tracker on a clip, from the first frame on.

    Args:
        clip: the clip.
        contestant: the tracker.
        name: name of the tracker whose cameras the clip is to give.
        rate_hz: frame rate of the camera; None for the default of folders.
        report_progress: takes the number of frames that are done.
    """
    if clip.step > 1:
        rate_hz = (rate_hz or DEFAULT_RATE_HZ) / clip.step
    views = open_views(TrackOptions(footage=clip.folder, out=Path(), tracker=name, rate_hz=rate_hz))
    rows: list[tuple[int, int, Floats]] = []
    detected: list[tuple[int, int, Floats, float]] = []
    times_ms = []
    for number, frame in enumerate(islice(views, clip.frames), start=1):
        frame_ms, (boxes, ids) = timed_ms(partial(contestant.step, frame))
        times_ms.append(frame_ms)
        rows += [(number, identity, box) for box, identity in zip(boxes, ids, strict=True)]
        if (found := contestant.detections) is not None:
            every = enumerate(zip(found.box, found.confidence.tolist(), strict=True))
            detected += [(number, k, box, confidence) for k, (box, confidence) in every]
        report_progress(number)
    frame_s = float(np.median(times_ms)) / 1000.0
    return ClipResult(score_clip(clip, rows), frame_s, TrackBoxes.from_rows(detected))


def make_clip_tracker(name: str, seed: int) -> Detecting:
    """Make a tracker or a peer by name.

    Raises:
        BadInput: it is unknown, needs other cameras, or a package is missing.
    """
    if name in PEERS:
        return _peer(name)
    ours = Ours.named(name, seed, boxes_whole=not is_own(name))
    for camera in ours.cameras:
        if camera not in ThermalViews.cameras:
            raise BadInput(f"--tracker {name}: needs camera {camera!r}, which clips do not have")
    return ours


def _peer(name: str) -> Detecting:
    try:
        from benchmarks.peers.contestants import make_clip_peer
    except ImportError as error:
        raise BadInput(f"{name}: the package trackers is missing; `make peers` installs it") from error
    return make_clip_peer(*PEERS[name])


def score_clip(clip: RealClip, rows: list[tuple[int, int, Floats]]) -> Scores:
    """Score rows of frame, id and box against the ground truth of a clip."""
    tracks = TrackBoxes.from_rows((frame, identity, box, 1.0) for frame, identity, box in rows)
    return evaluate(clip.given.truth, tracks, frames=clip.frames, is_single=clip.given.is_single)
