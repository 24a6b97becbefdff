"""Trackers by the names that `--tracker` takes: those that see images, and the oracle."""

from __future__ import annotations

from collections.abc import Callable

from peopleboy.scenarios.loop.oracle_tracker import TRUTH, OracleTracker
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.trackers import Tracker, make_tracker


def make_eyes(name: str, seed: int, truth: Callable[[], Truth]) -> Tracker:
    """Make a tracker by its name; "truth" is none, but knows.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    return OracleTracker(truth) if name == TRUTH else make_tracker(name, stream(seed, "tracker"))


def check_eyes(name: str) -> None:
    """Refuse the name of a tracker that there is not.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    if name != TRUTH:
        make_tracker(name, stream(0, "tracker"))
