"""The tracker as it is, and without each of its parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

from benchmarks.detection_ablation.film import Film
from benchmarks.detection_ablation.stages import LEAST, Stage, thermal_finder
from peopleboy.tracker.by_detection.by_detection_tracker import ByDetectionTracker
from peopleboy.tracker.by_detection.colour_finder import ColourFinder, seen_by_both
from peopleboy.tracker.by_detection.config import ByDetectionConfig, ExistenceConfig, RecognitionConfig
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.track import Track

_ALL: Final = ByDetectionConfig()


@dataclass(frozen=True, slots=True)
class Finding:
    """Who proposes people.

    Attributes:
        stage: how far the detector looks.
        by_colours: whether it looks at the colour image, too.
        is_calibrated: whether it is known how cameras sit.
    """

    stage: Stage = Stage.CLOSER_LOOK
    by_colours: bool = True
    is_calibrated: bool = True


@dataclass(frozen=True, slots=True)
class Variant:
    """A tracker: who proposes, and its settings."""

    finding: Finding = field(default_factory=Finding)
    config: ByDetectionConfig = _ALL


def _without_doubt(old: ExistenceConfig) -> ExistenceConfig:
    return replace(old, shared_doubt=0.0)


def _without_revision(old: RecognitionConfig) -> RecognitionConfig:
    return replace(old, parted_s=math.inf, gone_s=math.inf)


VARIANTS: Final[Mapping[str, Variant]] = {
    "as it is": Variant(),
    "nothing is known of the cameras": Variant(Finding(is_calibrated=False)),
    "everybody is 1.72 m tall": Variant(
        config=replace(_ALL, path=replace(_ALL.path, build=1e-3, posture=0.0))
    ),
    "proposed by the thermal image alone": Variant(Finding(by_colours=False)),
    "and without the closer look": Variant(Finding(Stage.SECOND_LOOK, by_colours=False)),
    "and without the second look, by trees alone": Variant(Finding(Stage.TREES, by_colours=False)),
    "nested boxes are as good": Variant(
        config=replace(
            _ALL,
            existence=_without_doubt(_ALL.existence),
            existence_uncalibrated=_without_doubt(_ALL.existence_uncalibrated),
        )
    ),
    "no late decisions": Variant(
        config=replace(
            _ALL,
            identity=_without_revision(_ALL.identity),
            identity_uncalibrated=_without_revision(_ALL.identity_uncalibrated),
        )
    ),
}


class Told:
    """Finds what was proposed before, frame by frame."""

    def __init__(self, proposals: Iterator[Proposals]) -> None:
        """Begin with the first frame."""
        self._proposals = proposals

    def __call__(self, frame: Frame) -> Proposals:  # noqa: ARG002
        """Give what was proposed in the next frame."""
        return next(self._proposals)


class Proposed:
    """A film in which people are proposed once for all variants that do so alike."""

    def __init__(self, film: Film) -> None:
        """Propose nobody yet."""
        self._films = {True: film, False: film.uncalibrated()}
        self._thermal: dict[tuple[Stage, bool], list[Proposals]] = {}
        self._colour: list[Proposals] | None = None

    def film(self, variant: Variant) -> Film:
        """Give what a variant sees."""
        return self._films[variant.finding.is_calibrated]

    def tracked(self, variant: Variant) -> list[tuple[Track, ...]]:
        """Follow people in all frames."""
        tracker = ByDetectionTracker(variant.config, Told(self._proposals(variant.finding)))
        return [tuple(tracker.update(frame)) for frame in self.film(variant).frames]

    def _proposals(self, finding: Finding) -> Iterator[Proposals]:
        film, key = self._films[finding.is_calibrated], (finding.stage, finding.is_calibrated)
        if key not in self._thermal:
            find = thermal_finder(finding.stage)
            self._thermal[key] = [find(frame) for frame in film.frames]
        if not (finding.by_colours and finding.is_calibrated):
            return iter(self._thermal[key])
        pairs = zip(self._thermal[key], self._seen_in_colours(film), strict=True)
        return (seen_by_both(*pair, _ALL.colour) for pair in pairs)

    def _seen_in_colours(self, film: Film) -> list[Proposals]:
        if self._colour is None:
            find = ColourFinder(_ALL.colour, LEAST)
            self._colour = [find(frame) for frame in film.frames]
        return self._colour
