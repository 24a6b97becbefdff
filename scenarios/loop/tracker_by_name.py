"""Make trackers from the names that `--tracker` accepts: image-based trackers, and the oracle."""

from collections.abc import Callable, Mapping

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.sim.cameras.camera_config import CameraConfig, calibrations_of
from peopleboy.sim.truth.scenes import is_seen
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.tracker_names import split_name
from peopleboy.tracker.trackers import TRACKERS, ChecksCameras, Tracker, is_own, make_tracker


class OracleTracker:
    """Return every person's true box under the person's own number, while enough of it is visible.

    A person who is occluded in the image is a totally occluded track; a person outside the image has none.
    """

    def __init__(self, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        self._first_s: dict[int, float] = {}

    @property
    def cameras(self) -> tuple[str, ...]:
        """Empty: this tracker needs no images."""
        return ()

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Return tracks from the ground truth; the frame's images are ignored."""
        truth = self._truth()
        return tuple(
            self._track(person, truth.robot, frame.time_s)
            for person in truth.people
            if person.box is not None and is_seen(person.inside_fraction)
        )

    def _track(self, person: PersonTruth, robot: Pose2, time_s: float) -> Track:
        assert person.box is not None
        return Track(
            id=person.id,
            boxes={THERMAL: person.box},
            place=_place(person, robot),
            confidence=1.0,
            status=Status.TRACKED if is_seen(person.visible_fraction) else Status.TOTALLY_OCCLUDED,
            age_s=time_s - self._first_s.setdefault(person.id, time_s),
        )


def _place(person: PersonTruth, robot: Pose2) -> FloorPlace:
    forward_m_s, left_m_s = robot.vectors_to_local(np.array(person.velocity_m_s)).tolist()
    return FloorPlace(
        position_m=robot.to_local(person.position_m),
        covariance_m2=(0.0, 0.0, 0.0),
        velocity_m_s=(forward_m_s, left_m_s),
        velocity_covariance_m2_s2=(0.0, 0.0, 0.0),
    )


def make_named_tracker(name: str, seed: int, truth: Callable[[], Truth]) -> Tracker:
    """Make a tracker from its name; "truth" gives the oracle.

    Raises:
        BadInput: the name is unknown, or your own tracker cannot be made.
    """
    return OracleTracker(truth) if name == ORACLE else _make(name, seed)


def make_checked_tracker(
    name: str, seed: int, truth: Callable[[], Truth], cameras: Mapping[str, CameraConfig]
) -> Tracker:
    """Make a tracker from its name, and check the cameras; the output of your own tracker is validated.

    Raises:
        BadInput: the name is unknown, your own tracker cannot be made, or the tracker refuses the cameras.
    """
    tracker = make_named_tracker(name, seed, truth)
    check_cameras(tracker, cameras)
    return CheckedTracker(tracker, f"tracker {name!r}", cameras) if is_own(name) else tracker


def check_cameras(tracker: Tracker, cameras: Mapping[str, CameraConfig]) -> None:
    """Let a tracker refuse the robot's cameras before the run begins.

    Raises:
        BadInput: the tracker refuses them.
    """
    if isinstance(tracker, ChecksCameras):
        tracker.check_cameras(calibrations_of(cameras))


def tracker_cameras(name: str) -> tuple[str, ...]:
    """Return the names of the cameras that a tracker needs.

    Raises:
        BadInput: the name is unknown, or your own tracker cannot be made.
    """
    return () if name == ORACLE else _make(name, seed=0).cameras


def _make(name: str, seed: int) -> Tracker:
    if not is_own(name) and split_name(name)[0] not in TRACKERS:
        known = ", ".join((*TRACKERS, ORACLE))
        raise BadInput(f"unknown tracker {name!r}; choose from {known}, or your own as module:Class")
    return make_tracker(name, seed)
