"""Detection schedule: search the whole image, rescore predicted boxes, or follow templates."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection, outline
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.detections import NO_DETECTIONS, Detections
from peopleboy.tracker.sensors.thermal.template import Grey, Template
from peopleboy.tracker.tracking.config import DetectionScheduleConfig
from peopleboy.tracker.tracking.sensor import Predictions

_WHOLE: Final = 0.99  # share of a box that must be inside the image


@dataclass(slots=True, eq=False)
class ThermalMemory:
    """What the detector found of one track.

    Attributes:
        seen_s: time of the last detection.
        trees: log-odds by the detector's trees alone, at the last search of the whole image.
        score: log-odds when the detector last found it.
        rescored_s: time of the last rescoring.
        searched_s: when trees last found it in a search of the whole image.
        template: image template cut at the last rescoring.
    """

    seen_s: float
    trees: float
    score: float = 0.0
    rescored_s: float = -math.inf
    searched_s: float = -math.inf
    template: Template | None = None


class Schedule(NamedTuple):
    """What the detector does in one image.

    Attributes:
        everywhere: whether the detector searches the whole image.
        expected: predicted boxes (4,) [px] of tracks by their row; the detector's networks rescore them, and
            a search of the whole image adds them to the detections of its trees.
        followed: boxes of tracks located by their templates, without other detections, by their row.
    """

    everywhere: bool
    expected: Mapping[int, Floats]
    followed: Mapping[int, Floats]

    def proposed(self, known: Sequence[ThermalMemory]) -> Detections:
        """Return the predicted boxes as detections with their last tree scores, the best first."""
        trees = np.array([known[row].trees for row in self.expected], np.float64)
        found = Detections.from_trees(np.array(list(self.expected.values())).reshape(-1, 4), trees)
        return found.take(np.argsort(-trees, kind="stable"))

    def located(self, known: Sequence[ThermalMemory]) -> Detections:
        """Return the template boxes with the last rescored scores of their tracks."""
        if not self.followed:
            return NO_DETECTIONS
        these = [known[row] for row in self.followed]
        return Detections.of(
            np.array(list(self.followed.values())),
            np.array([one.score for one in these]),
            np.array([one.trees for one in these]),
        )


class DetectionSchedule:
    """Decides for each image where the detector runs."""

    def __init__(self) -> None:
        self._everywhere_s = self._last_s = -math.inf

    def schedule_next(
        self,
        grey: Grey,
        predicted: Predictions,
        known: Sequence[ThermalMemory],
        expected: Floats,
        time_s: float,
        breadth: float,
        config: DetectionScheduleConfig,
    ) -> Schedule:
        """Return the detection plan of the next image.

        Args:
            grey: (H, W) the image.
            predicted: all K tracks.
            known: what is known of each.
            expected: (K, 4) their predicted boxes [px].
            time_s: when the image was taken.
            breadth: width of the field of view, as defined by `Viewpoint`.
            config: settings.
        """
        last_s, self._last_s = self._last_s, time_s
        seen_s = np.array([one.seen_s for one in known])
        was_seen, is_recent = seen_s == last_s, seen_s > time_s - config.lost_s
        share = cover(intersection(expected, outline(grey)), area(expected))
        is_missed = ~was_seen & (share > 0.0) & is_recent
        is_sure = predicted.is_confirmed & (predicted.log_odds >= 0.0)
        is_easy = was_seen & (share > _WHOLE) & _are_apart(expected, is_recent) & is_sure
        is_settled = bool(known) and bool(predicted.is_confirmed.all()) and not is_missed.any()
        settled_s = max(config.settled_s * min(breadth / config.breadth, 1.0), config.unsettled_s)
        if time_s - self._everywhere_s > (settled_s if is_settled else config.unsettled_s):
            self._everywhere_s = time_s
            since_s = time_s - np.array([one.searched_s for one in known])
            return Schedule(
                True, _shown(is_easy & (since_s < config.anew_s), known, grey, expected, config), {}
            )
        since_s = time_s - np.array([one.rescored_s for one in known])
        followed = _shown(is_easy & (since_s < config.rescore_s), known, grey, expected, config)
        looked = [row for row in np.flatnonzero(was_seen & (share > 0.0)).tolist() if row not in followed]
        return Schedule(False, {row: expected[row] for row in looked}, followed)


def _shown(
    these: NDArray[np.bool_],
    known: Sequence[ThermalMemory],
    grey: Grey,
    expected: Floats,
    config: DetectionScheduleConfig,
) -> dict[int, Floats]:
    """Return the boxes (4,) of those of K tracks that are located by their templates, by row."""
    shown = {}
    for row in np.flatnonzero(these).tolist():
        template = known[row].template
        box = None if template is None else template.found(grey, expected[row], config.min_correlation)
        if box is not None:
            shown[row] = box
    return shown


def _are_apart(expected: Floats, counts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which boxes (K, 4) touch no other box that counts, (K,)."""
    common = intersection(expected[:, None], expected[None]) * ~np.eye(len(expected), dtype=bool)
    return np.asarray(~(counts[None] & (common > 0.0)).any(axis=1))
