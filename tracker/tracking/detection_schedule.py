"""Detection schedule: search the whole image, rescore predicted boxes, or follow templates."""

import math
from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection, outline
from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.tracking.config import DetectionScheduleConfig
from peopleboy.tracker.tracking.template import Grey
from peopleboy.tracker.tracking.track_state import TrackState

_WHOLE: Final = 0.99  # share of a box that must be inside the image


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

    def proposed(self, targets: Sequence[TrackState]) -> Detections:
        """Return the predicted boxes as detections with their last tree scores, the best first."""
        trees = np.array([targets[row].trees for row in self.expected], np.float64)
        found = Detections.from_trees(np.array(list(self.expected.values())).reshape(-1, 4), trees)
        return found.take(np.argsort(-trees, kind="stable"))

    def with_followed(self, found: Detections, targets: Sequence[TrackState]) -> Detections:
        """Return the detector's boxes, then the template boxes with their last rescored scores."""
        if not self.followed:
            return found
        who = [targets[row] for row in self.followed]
        return Detections(
            np.concatenate([found.box, np.array(list(self.followed.values()))]),
            np.concatenate([found.score, [target.score for target in who]]),
            np.concatenate([found.trees, [target.trees for target in who]]),
        )


class DetectionSchedule:
    """Decides for each image where the detector runs."""

    def __init__(self) -> None:
        self._everywhere_s = self._last_s = -math.inf

    def schedule_next(
        self,
        grey: Grey,
        targets: Sequence[TrackState],
        expected: Floats,
        time_s: float,
        breadth: float,
        config: DetectionScheduleConfig,
    ) -> Schedule:
        """Return the detection plan of the next image.

        Args:
            grey: (H, W) the image.
            targets: all K tracks.
            expected: (K, 4) their predicted boxes [px].
            time_s: when the image was taken.
            breadth: width of the field of view, as defined by `Viewpoint`.
            config: settings.
        """
        last_s, self._last_s = self._last_s, time_s
        seen_s = np.array([target.seen_s for target in targets])
        was_seen, is_recent = seen_s == last_s, seen_s > time_s - config.lost_s
        share = cover(intersection(expected, outline(grey)), area(expected))
        is_missed = ~was_seen & (share > 0.0) & is_recent
        is_easy = was_seen & (share > _WHOLE) & _are_apart(expected, is_recent) & _are_sure(targets)
        is_settled = bool(targets) and all(target.is_confirmed for target in targets) and not is_missed.any()
        settled_s = max(config.settled_s * min(breadth / config.breadth, 1.0), config.unsettled_s)
        if time_s - self._everywhere_s > (settled_s if is_settled else config.unsettled_s):
            self._everywhere_s = time_s
            since_s = time_s - np.array([target.searched_s for target in targets])
            return Schedule(
                True, _shown(is_easy & (since_s < config.anew_s), targets, grey, expected, config), {}
            )
        since_s = time_s - np.array([target.rescored_s for target in targets])
        followed = _shown(is_easy & (since_s < config.rescore_s), targets, grey, expected, config)
        looked = [row for row in np.flatnonzero(was_seen & (share > 0.0)).tolist() if row not in followed]
        return Schedule(False, {row: expected[row] for row in looked}, followed)


def _shown(
    these: NDArray[np.bool_],
    targets: Sequence[TrackState],
    grey: Grey,
    expected: Floats,
    config: DetectionScheduleConfig,
) -> dict[int, Floats]:
    """Return the boxes (4,) of those of K tracks that are located by their templates, by row."""
    shown = {}
    for row in np.flatnonzero(these).tolist():
        template = targets[row].template
        box = None if template is None else template.found(grey, expected[row], config.min_correlation)
        if box is not None:
            shown[row] = box
    return shown


def _are_sure(targets: Sequence[TrackState]) -> NDArray[np.bool_]:
    return np.array([target.is_confirmed and target.log_odds >= 0.0 for target in targets], np.bool_)


def _are_apart(expected: Floats, counts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which boxes (K, 4) touch no other box that counts, (K,)."""
    common = intersection(expected[:, None], expected[None]) * ~np.eye(len(expected), dtype=bool)
    return np.asarray(~(counts[None] & (common > 0.0)).any(axis=1))
