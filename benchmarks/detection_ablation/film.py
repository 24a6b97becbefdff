"""Films: what the tracker sees, and what is true, of scenes, random worlds and real clips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from benchmarks.clips.clip import Clip
from benchmarks.tracker_ablation import Recorded
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import boxed_whole
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed

CLIPS_HZ = 30.0


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Some frames.

    Attributes:
        frames: what the tracker sees.
        truth: the boxes of everybody.
        boxes_whole: whether those are of whole people.
    """

    frames: tuple[Frame, ...]
    truth: TrueBoxes
    boxes_whole: bool = False

    @classmethod
    def of_run(cls, run: Recorded) -> Film:
        """Take what was recorded of a run."""
        return cls(run.frames, run.truth)

    @classmethod
    def of_clip(cls, clip: Clip) -> Film:
        """Read a real clip.

        Raises:
            BadInput: a picture cannot be used.
        """
        views = open_views(
            TrackOptions(footage=clip.folder, out=Path(), tracker="anywhere", rate_hz=CLIPS_HZ)
        )
        return cls(tuple(islice(views, clip.frames)), clip.given.truth, boxes_whole=True)

    def uncalibrated(self) -> Film:
        """Give the same, with nothing known of the cameras."""
        return replace(self, frames=tuple(replace(frame, calibrations={}) for frame in self.frames))

    def score(self, found: Sequence[Sequence[Track]], min_visible: float = 0.0) -> Scores:
        """Score what a tracker gave in each frame, by those of whom more than a share is visible."""
        rows = [
            (number, track.id, box, track.confidence)
            for number, (frame, tracks) in enumerate(zip(self.frames, found, strict=True), start=1)
            for track, box in confirmed(boxed_whole(tracks, frame) if self.boxes_whole else tracks, THERMAL)
        ]
        boxes = TrackBoxes(
            frame=np.array([row[0] for row in rows], int),
            id=np.array([row[1] for row in rows], int),
            box=np.array([row[2] for row in rows], float).reshape(-1, 4),
            confidence=np.array([row[3] for row in rows], float),
        )
        return evaluate(self.truth, boxes, frames=len(self.frames), min_visible=min_visible)
