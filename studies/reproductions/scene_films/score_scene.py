"""How right a scene model is: its background, its masks of people and things, and what it tells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.watching.true_events import TrueEvent, WhoIsWho, matching
from peopleboy.sim.geometry.planar import Planar
from peopleboy.tracker.scene_model.scene import Happening, Metres, VistaScene

Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]

LEAST_M: Final = 0.12
"""[m] before what is behind it from which on something is to be found."""


@dataclass(frozen=True, slots=True, eq=False)
class TrueMasks:
    """What is truly seen in an image, where the camera reads anything.

    Attributes:
        people: (H, W) people.
        things: (H, W) movable things that stand clear of what was shown behind them.
        is_read: (H, W) where there is a reading.
    """

    people: Bools
    things: Bools
    is_read: Bools


class SceneScore:
    """Counts pixels frame by frame, and takes up what is told."""

    def __init__(self) -> None:
        self._pixels = {kind: np.zeros(3, np.int64) for kind in ("people", "things")}
        self.happenings: list[Happening] = []
        self.who = WhoIsWho()

    def add(self, scene: VistaScene, truth: TrueMasks) -> None:
        """Take in a frame."""
        for kind, found, wanted in (
            ("people", scene.people > 0, truth.people),
            ("things", scene.things > 0, truth.things),
        ):
            self._pixels[kind] += counts(found & truth.is_read, wanted & truth.is_read)
        self.happenings += scene.happenings

    def plain(self) -> dict[str, Any]:
        """Give right, false and missed pixels, by kind."""
        return {kind: sums.tolist() for kind, sums in self._pixels.items()}


def counts(found: Bools, wanted: Bools) -> NDArray[np.int64]:
    """Count (3,) right, false and missed pixels."""
    right = int(np.count_nonzero(found & wanted))
    return np.array([right, np.count_nonzero(found) - right, np.count_nonzero(wanted) - right])


def background_errors(found_m: Metres, true_m: Metres, lengths: Floats) -> dict[str, float]:
    """Compare a background (H, W) [m] with the truth, which is infinite where there is nothing.

    Args:
        found_m: 0 where nothing is known.
        true_m: depth along the optical axis.
        lengths: (H, W) length of each pixel's ray of depth 1.

    Returns:
        Distance of the points [mm]: mean, deviation and median; and the share of pixels that are known.
    """
    is_known = (found_m > 0.0) & np.isfinite(true_m)
    off = 1000.0 * np.abs(found_m - true_m)[is_known] * lengths[is_known]
    share = float(is_known.sum() / max(np.isfinite(true_m).sum(), 1))
    if not off.size:
        return {"mean": float("nan"), "deviation": float("nan"), "median": float("nan"), "known": share}
    return {
        "mean": float(off.mean()),
        "deviation": float(off.std()),
        "median": float(np.median(off)),
        "known": share,
    }


def event_counts(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], who: WhoIsWho, first: Planar
) -> dict[str, int]:
    """Count what was told rightly and falsely, what truly happened and was told, and who did it.

    A happening is right if something happened there then; what truly happened is told if there is such a
    happening. Who did it counts where somebody did, and it was told.
    """
    found = matching(happenings, events, first)
    told = {n: k for k, numbers in sorted(found.items(), reverse=True) for n in numbers}
    asked = {n: k for n, k in told.items() if events[n].by}
    named = sum(who.name(happenings[k].person) == events[n].by for n, k in asked.items())
    return {
        "right": len(found),
        "false": len(happenings) - len(found),
        "events": len(events),
        "told": len(told),
        "asked": len(asked),
        "named": named,
    }
