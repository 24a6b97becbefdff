"""Let a tracker watch a clip, and score it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.clips.clip import Clip
from benchmarks.peers.ours import Contestant, Ours
from benchmarks.sequences import track_boxes
from benchmarks.timing import timed_ms
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import ThermalViews, open_views
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own

PEERS: Final = {"HOG x 2 + ByteTrack": 2.0, "HOG x 3 + ByteTrack": 3.0}
"""How many times each enlarges the pictures: HOG sees people from 96 px of the enlarged ones on."""


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """What came of one tracker, one clip and one seed.

    Attributes:
        scores: against the truth.
        frame_s: CPU time of a frame, median; reading of pictures left out.
    """

    scores: Scores
    frame_s: float


@dataclass(frozen=True, slots=True, eq=False)
class WatchTask:
    """Let a tracker watch a clip.

    Attributes:
        clip: which.
        tracker: name of one of ours, or of `PEERS`.
        seed: of ours; peers draw nothing.
        rate_hz: pictures a second; None for what a folder is taken to have.
    """

    clip: Clip
    tracker: str
    seed: int
    rate_hz: float | None = None

    @property
    def name(self) -> str:
        """Clip, tracker and seed."""
        return f"{self.clip.name}, {self.tracker}, seed {self.seed}"

    @property
    def size(self) -> int:
        """Frames to watch."""
        return self.clip.frames

    def __call__(self, tell: Tell) -> Watched:
        """Watch it from the first frame on.

        Raises:
            BadInput: the tracker is unknown or wants other cameras, or a picture cannot be used.
        """
        watcher = make_watcher(self.tracker, self.seed)
        name = DEFAULT_TRACKER if self.tracker in PEERS else self.tracker
        views = open_views(
            TrackOptions(footage=self.clip.folder, out=Path(), tracker=name, rate_hz=self.rate_hz)
        )
        rows: list[tuple[int, int, Floats]] = []
        times_ms = []
        for number, frame in enumerate(islice(views, self.clip.frames), start=1):
            frame_ms, (boxes, ids) = timed_ms(partial(watcher.step, frame))
            times_ms.append(frame_ms)
            rows += [(number, identity, box) for box, identity in zip(boxes, ids, strict=True)]
            tell(number)
        return Watched(_scored(self.clip, rows), float(np.median(times_ms)) / 1000.0)


def make_watcher(name: str, seed: int) -> Contestant:
    """Make one of ours, or a peer.

    Raises:
        BadInput: it is unknown, wants other cameras, or lacks a package.
    """
    if name in PEERS:
        return _peer(name)
    ours = Ours(name, seed, boxes_whole=not is_own(name))
    for camera in ours.cameras:
        if camera not in ThermalViews.cameras:
            raise BadInput(f"--tracker {name}: wants camera {camera!r}, which clips have not")
    return ours


def _peer(name: str) -> Contestant:
    try:
        from benchmarks.peers.contestants import make_clip_peer
    except ImportError as error:
        raise BadInput(f"{name}: the package trackers is missing; `make peers` installs it") from error
    return make_clip_peer(PEERS[name])


def _scored(clip: Clip, rows: list[tuple[int, int, Floats]]) -> Scores:
    tracks = track_boxes((frame, identity, box, 1.0) for frame, identity, box in rows)
    return evaluate(clip.given.truth, tracks, frames=clip.frames, is_single=clip.given.is_single)
