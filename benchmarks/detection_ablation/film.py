"""Films: what the tracker sees, and what is true, of scenes, random worlds and real clips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from benchmarks.clips.clip import Clip
from benchmarks.told_boxes import told_boxes
from benchmarks.tracker_ablation import Recorded
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.box_kinds import boxed_whole
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track

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
            TrackOptions(footage=clip.folder, out=Path(), tracker="detection", rate_hz=CLIPS_HZ)
        )
        return cls(tuple(islice(views, clip.frames)), clip.given.truth, boxes_whole=True)

    def uncalibrated(self) -> Film:
        """Give the same, with nothing known of the cameras."""
        return replace(self, frames=tuple(replace(frame, calibrations={}) for frame in self.frames))

    def score(self, found: Sequence[Sequence[Track]], min_visible: float = 0.0) -> Scores:
        """Score what a tracker gave in each frame, by those of whom more than a share is visible."""
        told = found
        if self.boxes_whole:
            told = [boxed_whole(tracks, frame) for tracks, frame in zip(found, self.frames, strict=True)]
        return evaluate(self.truth, told_boxes(told), frames=len(self.frames), min_visible=min_visible)
