"""Ablation of the detection tracker: `python -m benchmarks.detection_ablation`.

Scenes and random worlds are recorded once; all variants run on the same images.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from itertools import islice
from pathlib import Path
from typing import Final

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import Recording, false_per_1000, percents, print_head, print_row, record
from benchmarks.footage.real_clips import CHOSEN_BY, RealClip, open_clips
from benchmarks.peers.detectors import Blobs
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.evaluation.evaluate import combine
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.detector import (
    SMALLEST_PX,
    Grey,
    PeopleDetector,
    detect_with_trees,
)
from peopleboy.tracker.sensors.thermal.detector.people_trees import shipped_people_trees
from peopleboy.tracker.sensors.thermal.detector.rescoring import RescoringNetwork, rescore
from peopleboy.tracker.sensors.thermal.people_finder import Finder, ThermalFinder
from peopleboy.tracker.sensors.thermal.scheduled_detector import ScheduledDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import DEFAULT_TRACKER
from peopleboy.tracker.tracking.config import ExistenceConfig, PeopleTrackerConfig, ReidentificationConfig
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

SCENES: Final = (
    "crossing_4",
    "behind_wall_edge",
    "stop_and_talk",
    "leader_swap",
    "hidden_2s",
    "turn_while_hidden",
    "sitting",
    "crowd_8",
)
COLUMNS: Final = (
    "library: HOTA",
    "IDF1",
    "switches",
    "worlds: HOTA",
    "of visible people",
    "false per 1000 frames",
)
COLUMNS_OF_CLIPS: Final = ("clips: HOTA", "false per 1000 frames")
_SEEN: Final = 0.3
CLIPS_HZ: Final = 30.0
LEAST: Final = PeopleTrackerConfig().existence.weakest
_SURE: Final = 3.0  # log odds of a warm blob


class DetectorStage(Enum):
    """How people are detected: by a threshold, or by the detector up to a stage."""

    THRESHOLD = auto()
    TREES = auto()
    RESCORING = auto()
    BOX_REFINEMENT = auto()


class DetectorOfStage(PeopleDetector):
    """A people detector that stops after a stage."""

    def __init__(self, stage: DetectorStage) -> None:
        """Load the shipped trees and networks."""
        super().__init__(least_score=LEAST)
        self._stage = stage

    def detect(
        self, grey: Grey, change: Grey, mount: Mount | None, expected: Detections, *, everywhere: bool
    ) -> Detections:
        """Detect people in an image and its change of grey (H, W).

        Without rescoring, the trees search the whole image and ignore expected detections.
        """
        if self._stage is DetectorStage.BOX_REFINEMENT:
            return super().detect(grey, change, mount, expected, everywhere=everywhere)
        if self._stage is DetectorStage.TREES:
            return detect_with_trees(shipped_people_trees(), grey, change, mount, SMALLEST_PX, LEAST)
        first = self.detect_first(grey, change, mount, expected) if everywhere else expected
        return rescore(RescoringNetwork.shipped(), grey, change, first, mount, LEAST)


class WarmFinder:
    """Finder that reports each upright region above a grey threshold as a person."""

    def __call__(self, frame: Frame, expected: Detections, *, everywhere: bool) -> Detections:  # noqa: ARG002
        """Detect people in a frame; expected detections are ignored."""
        boxes = Blobs().detect(frame).box
        return Detections.from_trees(boxes, np.full(len(boxes), _SURE))


def thermal_finder(stage: DetectorStage) -> Finder:
    """Make a finder that stops after a stage."""
    return WarmFinder() if stage is DetectorStage.THRESHOLD else ThermalFinder(DetectorOfStage(stage))


_ALL: Final = PeopleTrackerConfig()


@dataclass(frozen=True, slots=True)
class Variant:
    """A variant of the tracker.

    Attributes:
        config: settings of the tracker.
        stage: last stage of the detector, on the thermal image only; None for all stages and both images.
        is_calibrated: whether the tracker gets the cameras' calibration.
    """

    config: PeopleTrackerConfig = _ALL
    stage: DetectorStage | None = None
    is_calibrated: bool = True

    def tracked(self, recording: Recording) -> list[tuple[Track, ...]]:
        """Return the tracks of all frames."""
        find = None if self.stage is None else thermal_finder(self.stage)
        tracker = PeopleTracker(
            (ThermalSensor(self.config, ScheduledDetector(self.config, find)),), self.config
        )
        seen = recording if self.is_calibrated else recording.uncalibrated()
        return [tracker.update(frame) for frame in seen.frames]


def _without_doubt(old: ExistenceConfig) -> ExistenceConfig:
    return replace(old, shared_doubt=0.0)


def _without_revision(old: ReidentificationConfig) -> ReidentificationConfig:
    return replace(old, parted_s=math.inf, lost_s=math.inf)


_EVERYBODY: Final = replace(_ALL, schedule=replace(_ALL.schedule, rescore_s=0.0, anew_s=0.0))
_OFTEN: Final = replace(
    _EVERYBODY, schedule=replace(_EVERYBODY.schedule, settled_s=_ALL.schedule.unsettled_s)
)
_EVERYWHERE: Final = replace(
    _ALL, schedule=replace(_ALL.schedule, unsettled_s=0.0, settled_s=0.0, anew_s=0.0)
)

VARIANTS: Final[Mapping[str, Variant]] = {
    "as it is": Variant(),
    "no camera calibration": Variant(is_calibrated=False),
    "all statures are 1.72 m": Variant(replace(_ALL, motion=replace(_ALL.motion, build=1e-3, posture=0.0))),
    "every tracked person is rescored in each image": Variant(_EVERYBODY),
    "and every third image is searched completely": Variant(_OFTEN),
    "every image is searched completely": Variant(_EVERYWHERE),
    "thermal image only": Variant(stage=DetectorStage.BOX_REFINEMENT),
    "and without box refinement": Variant(stage=DetectorStage.RESCORING),
    "and without rescoring, by the cascade alone, every image": Variant(_EVERYWHERE, DetectorStage.TREES),
    "upright regions above a grey threshold, every image": Variant(_EVERYWHERE, DetectorStage.THRESHOLD),
    "no penalty for nested boxes": Variant(
        replace(
            _ALL,
            existence=_without_doubt(_ALL.existence),
            existence_uncalibrated=_without_doubt(_ALL.existence_uncalibrated),
        )
    ),
    "no late re-identification": Variant(
        replace(
            _ALL,
            reidentification=_without_revision(_ALL.reidentification),
            reidentification_uncalibrated=_without_revision(_ALL.reidentification_uncalibrated),
        )
    ),
}


def clip_recording(clip: RealClip) -> Recording:
    """Read a real clip.

    Raises:
        BadInput: an image cannot be used.
    """
    options = TrackOptions(footage=clip.folder, out=Path(), tracker=DEFAULT_TRACKER, rate_hz=CLIPS_HZ)
    frames = tuple(islice(open_views(options), clip.frames))
    return Recording(frames, clip.given.truth, boxes_whole=True)


def score_recordings(scenes: Sequence[Recording], worlds: Sequence[Recording], variant: Variant) -> list[str]:
    """Return the metrics of a row, in the order of `COLUMNS`."""
    library = combine([recording.score(variant.tracked(recording)) for recording in scenes])
    tracked = [(recording, variant.tracked(recording)) for recording in worlds]
    everybody = combine([recording.score(tracks) for recording, tracks in tracked])
    seen = combine([recording.score(tracks, min_visible=_SEEN) for recording, tracks in tracked])
    hota = [*percents(everybody, "HOTA"), *percents(seen, "HOTA")]
    false = f"{false_per_1000(everybody):.2f}"
    return [*percents(library, "HOTA", "IDF1"), str(library.mot.clear.switches), *hota, false]


def score_clips(clips: Sequence[Recording], variant: Variant) -> list[str]:
    """Return the metrics of a row, in the order of `COLUMNS_OF_CLIPS`."""
    scores = combine([recording.score(variant.tracked(recording)) for recording in clips])
    return [*percents(scores, "HOTA"), f"{false_per_1000(scores):.2f}"]


@click.command()
@click.option("--seed", default=1, show_default=True, help="Seed of the scenes.")
@click.option(
    "--seeds",
    "worlds",
    type=click.IntRange(min=1),
    default=30,
    show_default=True,
    help="Number of worlds.",
)
@click.option(
    "--clips",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder of clips; only those that may be used for tuning are evaluated.",
)
def main(seed: int, worlds: int, clips: Path | None) -> None:
    """Print metrics of the complete tracker, and without each of its parts, as a Markdown table."""
    real = [] if clips is None else [clip_recording(clip) for clip in open_clips(clips, CHOSEN_BY)]
    scenes = [record(name, seed) for name in SCENES]
    drawn = [record(random_scenario(number), number) for number in range(worlds)]
    columns = (*COLUMNS, *(COLUMNS_OF_CLIPS if real else ()))
    print_head("", columns)
    for name, variant in VARIANTS.items():
        of_clips = score_clips(real, variant) if real else []
        print_row(name, [*score_recordings(scenes, drawn, variant), *of_clips])


if __name__ == "__main__":
    call(main, "benchmarks.detection_ablation")
