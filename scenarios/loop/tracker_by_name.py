"""Trackers by the names that `--tracker` takes: those that see images, and the oracle."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.schema.robot import ORACLE
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.oracle_tracker import OracleTracker
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.trackers import TRACKERS, ChecksCameras, Tracker, is_own, make_tracker


def make_eyes(name: str, seed: int, truth: Callable[[], Truth]) -> Tracker:
    """Make a tracker by its name; "truth" is none, but knows.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    return OracleTracker(truth) if name == ORACLE else _make(name, seed)


def make_checked_eyes(
    name: str, seed: int, truth: Callable[[], Truth], cameras: Mapping[str, CameraConfig]
) -> Tracker:
    """Make a tracker by its name, which may refuse the cameras; each answer of one of your own is looked at.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made, or cameras that it refuses.
    """
    tracker = make_eyes(name, seed, truth)
    check_cameras(tracker, cameras)
    return CheckedTracker(tracker, f"tracker {name!r}", cameras) if is_own(name) else tracker


def check_cameras(tracker: Tracker, cameras: Mapping[str, CameraConfig]) -> None:
    """Let a tracker refuse the robot's cameras before anything is begun.

    Raises:
        BadInput: it does.
    """
    if isinstance(tracker, ChecksCameras):
        tracker.check_cameras(calibrations_of(cameras))


def camera_names(name: str) -> tuple[str, ...]:
    """Name the cameras that the tracker of a name wants.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    return () if name == ORACLE else _make(name, seed=0).cameras


def _make(name: str, seed: int) -> Tracker:
    if ":" not in name and name not in TRACKERS:
        known = ", ".join((*TRACKERS, ORACLE))
        raise BadInput(f"unknown tracker {name!r}; there are: {known}, and your own as module:Class")
    return make_tracker(name, stream(seed, "tracker"))
