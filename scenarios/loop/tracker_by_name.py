"""Make trackers by the names that `--tracker` takes: those that see images, and the oracle."""

from collections.abc import Callable, Mapping

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.sim.cameras.camera_config import CameraConfig, calibrations_of
from peopleboy.sim.truth.scenes import is_seen
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import TRACKERS, ChecksCameras, Tracker, is_own, make_tracker


class OracleTracker:
    """Gives everybody's true box under the person's own number, as long as enough of it is to be seen.

    Who is hidden in the image goes on as a totally occluded track; who is out of the image has none.
    """

    def __init__(self, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        self._first_s: dict[int, float] = {}

    @property
    def cameras(self) -> tuple[str, ...]:
        """None: it looks at no image."""
        return ()

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Look at the truth instead of the frame."""
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
    return FloorPlace(position_m=robot.to_local(person.position_m), covariance_m2=(0.0, 0.0, 0.0))


def make_named_tracker(name: str, seed: int, truth: Callable[[], Truth]) -> Tracker:
    """Make a tracker by its name; "truth" is none, but knows.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    return OracleTracker(truth) if name == ORACLE else _make(name, seed)


def make_checked_tracker(
    name: str, seed: int, truth: Callable[[], Truth], cameras: Mapping[str, CameraConfig]
) -> Tracker:
    """Make a tracker by its name, which may refuse the cameras; each answer of one of your own is looked at.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made, or cameras that it refuses.
    """
    tracker = make_named_tracker(name, seed, truth)
    check_cameras(tracker, cameras)
    return CheckedTracker(tracker, f"tracker {name!r}", cameras) if is_own(name) else tracker


def check_cameras(tracker: Tracker, cameras: Mapping[str, CameraConfig]) -> None:
    """Let a tracker refuse the robot's cameras before anything is begun.

    Raises:
        BadInput: it does.
    """
    if isinstance(tracker, ChecksCameras):
        tracker.check_cameras(calibrations_of(cameras))


def tracker_cameras(name: str) -> tuple[str, ...]:
    """Name the cameras that the tracker of a name wants.

    Raises:
        BadInput: an unknown name, or a tracker of your own that cannot be made.
    """
    return () if name == ORACLE else _make(name, seed=0).cameras


def _make(name: str, seed: int) -> Tracker:
    if ":" not in name and name not in TRACKERS:
        known = ", ".join((*TRACKERS, ORACLE))
        raise BadInput(f"unknown tracker {name!r}; there are: {known}, and your own as module:Class")
    return make_tracker(name, seed)
