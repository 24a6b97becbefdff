"""The tracker as it is, and without each of its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

from benchmarks.detection_ablation.film import Film
from benchmarks.detection_ablation.stages import Stage, thermal_finder
from peopleboy.tracker.track import Track
from peopleboy.tracker.tracking.config import DetectionTrackerConfig, ExistenceConfig, ReidentificationConfig
from peopleboy.tracker.tracking.detection_tracker import DetectionTracker

_ALL: Final = DetectionTrackerConfig()


@dataclass(frozen=True, slots=True)
class Variant:
    """A tracker, and what it knows.

    Attributes:
        config: its settings.
        stage: the last stage of its detector, on the thermal image; None for all, and the colour image.
        is_calibrated: whether it is known how cameras sit.
    """

    config: DetectionTrackerConfig = _ALL
    stage: Stage | None = None
    is_calibrated: bool = True

    def tracked(self, film: Film) -> list[tuple[Track, ...]]:
        """Follow people in all frames."""
        find = None if self.stage is None else thermal_finder(self.stage)
        tracker = DetectionTracker(self.config, find)
        return [
            tracker.update(frame) for frame in (film if self.is_calibrated else film.uncalibrated()).frames
        ]


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
    "nothing is known of the cameras": Variant(is_calibrated=False),
    "everybody is 1.72 m tall": Variant(replace(_ALL, motion=replace(_ALL.motion, build=1e-3, posture=0.0))),
    "the detector looks at everybody in each image": Variant(_EVERYBODY),
    "and every third image is searched everywhere": Variant(_OFTEN),
    "every image is searched everywhere": Variant(_EVERYWHERE),
    "proposed by the thermal image alone": Variant(stage=Stage.CLOSER_LOOK),
    "and without the closer look": Variant(stage=Stage.SECOND_LOOK),
    "and without the second look, by trees alone, everywhere": Variant(_EVERYWHERE, Stage.TREES),
    "by what is warmer than a grey and upright, everywhere": Variant(_EVERYWHERE, Stage.THRESHOLD),
    "nested boxes are as good": Variant(
        replace(
            _ALL,
            existence=_without_doubt(_ALL.existence),
            existence_uncalibrated=_without_doubt(_ALL.existence_uncalibrated),
        )
    ),
    "no late decisions": Variant(
        replace(
            _ALL,
            reidentification=_without_revision(_ALL.reidentification),
            reidentification_uncalibrated=_without_revision(_ALL.reidentification_uncalibrated),
        )
    ),
}
