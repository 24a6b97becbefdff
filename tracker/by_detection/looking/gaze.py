"""Where an image is looked at, and how closely: everywhere, where somebody should be, or hardly."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection, outline
from peopleboy.tracker.by_detection.config import GazeConfig
from peopleboy.tracker.by_detection.portrait import Grey
from peopleboy.tracker.by_detection.target import Target
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.proposals.suppression import Proposals

_WHOLE = 0.99  # share of a box that must be inside the image


class Aim(NamedTuple):
    """What is looked at in one image.

    Attributes:
        alone: where the detector looks; None for everywhere.
        followed: boxes (4,) [px] of those whom their portraits show, by their row.
    """

    alone: Proposals | None
    followed: Mapping[int, Floats]

    def with_followed(self, found: Proposals, targets: Sequence[Target]) -> Proposals:
        """Give who was found by the detector, and then who is followed, as sure as when last looked at."""
        if not self.followed:
            return found
        who = [targets[row] for row in self.followed]
        return Proposals(
            np.concatenate([found.box, np.array(list(self.followed.values()))]),
            np.concatenate([found.score, [target.score for target in who]]),
            np.concatenate([found.trees, [target.trees for target in who]]),
        )


class Gaze:
    """Decides where to look, image by image."""

    def __init__(self) -> None:
        self._everywhere_s = self._last_s = -math.inf

    def aim(
        self, grey: Grey, targets: Sequence[Target], expected: Floats, time_s: float, config: GazeConfig
    ) -> Aim:
        """Decide it for the next image.

        Args:
            grey: (H, W) the image.
            targets: whoever is known, K.
            expected: (K, 4) where they should be [px].
            time_s: when the image was taken.
            config: what it takes.
        """
        last_s, self._last_s = self._last_s, time_s
        seen_s = np.array([target.seen_s for target in targets])
        was_seen, is_recent = seen_s == last_s, seen_s > time_s - config.lost_s
        share = cover(intersection(expected, outline(grey)), area(expected))
        is_missed = ~was_seen & (share > 0.0) & is_recent
        is_settled = bool(targets) and all(target.is_told for target in targets) and not is_missed.any()
        if time_s - self._everywhere_s > (config.settled_s if is_settled else config.unsettled_s):
            self._everywhere_s = time_s
            return Aim(None, {})
        is_easy = (share > _WHOLE) & _are_apart(expected, is_recent)
        followed = {}
        for row in np.flatnonzero(was_seen & is_easy).tolist():
            box = _followed(targets[row], grey, expected[row], time_s, config)
            if box is not None:
                followed[row] = box
        rows = np.array([row for row in np.flatnonzero(was_seen & (share > 0.0)) if row not in followed], int)
        trees = np.array([targets[row].trees for row in rows], np.float64)
        alone = Proposals.of_trees(expected[rows], trees)
        return Aim(alone.taken(np.argsort(-trees, kind="stable")), followed)


def _are_apart(expected: Floats, counts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Tell whose boxes (K, 4) touch no other one that counts, (K,)."""
    common = intersection(expected[:, None], expected[None]) * ~np.eye(len(expected), dtype=bool)
    return np.asarray(~(counts[None] & (common > 0.0)).any(axis=1))


def _followed(
    target: Target, grey: Grey, expected: Floats, time_s: float, config: GazeConfig
) -> Floats | None:
    """Give the box (4,) of somebody by the portrait, if that is good enough for now."""
    is_sure = target.is_told and target.log_odds >= 0.0
    if target.portrait is None or not is_sure or time_s - target.looked_s >= config.look_s:
        return None
    return target.portrait.found(grey, expected, config.alike)
