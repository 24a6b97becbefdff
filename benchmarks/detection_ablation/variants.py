"""The tracker as it is, and without each of its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

from benchmarks.detection_ablation.film import Film
from benchmarks.detection_ablation.stages import Stage, thermal_finder
from peopleboy.tracker.by_detection.by_detection_tracker import ByDetectionTracker
from peopleboy.tracker.by_detection.config import ByDetectionConfig, ExistenceConfig, RecognitionConfig
from peopleboy.tracker.track import Track

_ALL: Final = ByDetectionConfig()


@dataclass(frozen=True, slots=True)
class Variant:
    """A tracker, and what it knows.

    Attributes:
        config: its settings.
        stage: how far its detector looks, at the thermal image alone; None for all of it, at colours, too.
        is_calibrated: whether it is known how cameras sit.
    """

    config: ByDetectionConfig = _ALL
    stage: Stage | None = None
    is_calibrated: bool = True

    def tracked(self, film: Film) -> list[tuple[Track, ...]]:
        """Follow people in all frames."""
        find = None if self.stage is None else thermal_finder(self.stage)
        tracker = ByDetectionTracker(self.config, find)
        return [
            tracker.update(frame) for frame in (film if self.is_calibrated else film.uncalibrated()).frames
        ]


def _without_doubt(old: ExistenceConfig) -> ExistenceConfig:
    return replace(old, shared_doubt=0.0)


def _without_revision(old: RecognitionConfig) -> RecognitionConfig:
    return replace(old, parted_s=math.inf, gone_s=math.inf)


_EVERYBODY: Final = replace(_ALL, gaze=replace(_ALL.gaze, look_s=0.0, anew_s=0.0))
_OFTEN: Final = replace(_EVERYBODY, gaze=replace(_EVERYBODY.gaze, settled_s=_ALL.gaze.unsettled_s))
_EVERYWHERE: Final = replace(_ALL, gaze=replace(_ALL.gaze, unsettled_s=0.0, settled_s=0.0, anew_s=0.0))

VARIANTS: Final[Mapping[str, Variant]] = {
    "as it is": Variant(),
    "nothing is known of the cameras": Variant(is_calibrated=False),
    "everybody is 1.72 m tall": Variant(replace(_ALL, path=replace(_ALL.path, build=1e-3, posture=0.0))),
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
            identity=_without_revision(_ALL.identity),
            identity_uncalibrated=_without_revision(_ALL.identity_uncalibrated),
        )
    ),
}
