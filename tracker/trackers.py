"""The trackers by name, and the protocol that a tracker implements."""

import operator
from typing import TYPE_CHECKING, Final, Protocol, runtime_checkable

from peopleboy.bad_input import BadInput
from peopleboy.own_code import guarded, load_own
from peopleboy.registry import Registry
from peopleboy.tracker.tracker_names import is_network_file, split_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np

    from peopleboy.geometry.camera_calibration import Calibration
    from peopleboy.tracker.frame import Frame
    from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
    from peopleboy.tracker.reproductions.contour.single_filter import SingleFilter
    from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
    from peopleboy.tracker.track import Box, Track
    from peopleboy.tracker.tracking.config import PeopleTrackerConfig
    from peopleboy.tracker.tracking.people_gallery import PeopleGallery


@runtime_checkable
class Tracker(Protocol):
    """Interface of trackers, which receive frames and return tracks."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the required cameras; those that a robot lacks are mounted with defaults."""
        ...

    def update(self, frame: "Frame") -> "tuple[Track, ...]":
        """Process the next frame and return the tracks."""
        ...


@runtime_checkable
class Introducible(Protocol):
    """A tracker that can be initialised at a person."""

    def introduce(self, box: "Box") -> None:
        """Report that a person is at this box [px] of the thermal image in the next frame."""
        ...


@runtime_checkable
class UsesGallery(Protocol):
    """A tracker that recognises people of earlier runs."""

    def use_gallery(self, gallery: "PeopleGallery") -> None:
        """Recognise the people of a gallery from the first frame on, and keep it up to date."""
        ...


@runtime_checkable
class ChecksCameras(Protocol):
    """A tracker that has requirements on the cameras it gets."""

    def check_cameras(self, calibrations: "Mapping[str, Calibration]") -> None:
        """Check cameras, by name, before the first frame.

        Raises:
            BadInput: a camera is unsuitable.
        """
        ...


TRACKERS: Final = Registry("tracker", "peopleboy.trackers")
"""The trackers by name; each is called with a `numpy.random.Generator`. The first is the default.

A tracker is registered by decorating the function below that makes it. These functions import their
dependencies, so that loading one tracker, or listing the names, does not load all of them.
"""

DETECTION_TRACKER: Final = "detection"
LIVE_TRACKER: Final = "detection-live"
CONTOUR_TRACKER: Final = "contour"
DEFAULT_TRACKER: Final = DETECTION_TRACKER
BY_CONTRAST: Final = frozenset({DETECTION_TRACKER, LIVE_TRACKER, "attentive"})
"""Trackers that use only the contrast of a thermal image, not its absolute temperatures."""
WITH_DETECTOR: Final = (DETECTION_TRACKER, LIVE_TRACKER, "handover", "fused", "attentive")
"""Trackers that can use another detector in place of their own; its name is their second argument."""


def uses_contrast(name: str) -> bool:
    """Return whether the tracker of this name uses only the contrast of a thermal image."""
    return split_name(name)[0] in BY_CONTRAST


def explanation_of(tracker: Tracker) -> object:
    """Return a tracker's `explanation`, the state behind its tracks; None if it has none.

    An isinstance check of a protocol would evaluate it twice, and would be slower than some trackers.
    """
    return getattr(tracker, "explanation", None)


def _contour_tracker(name: str, rng: "np.random.Generator") -> "ContourTracker":
    from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
    from peopleboy.tracker.reproductions.contour.variants import VARIANTS

    return ContourTracker(VARIANTS[name], rng)


def _single_filter(name: str, rng: "np.random.Generator") -> "SingleFilter":
    from peopleboy.tracker.reproductions.contour.single_filter import SingleFilter
    from peopleboy.tracker.reproductions.contour.variants import VARIANTS

    return SingleFilter(VARIANTS[name], rng)


def _thermal_sensor(detector: str | None, config: "PeopleTrackerConfig | None" = None) -> "ThermalSensor":
    from peopleboy.tracker.sensors.own_detector import make_box_detector
    from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor

    return ThermalSensor(config, None if detector is None else make_box_detector(detector, config))


@TRACKERS.register(
    DETECTION_TRACKER,
    scope="default tracker; for any camera and room, and for recorded video",
    summary="Detects people with a detector that was trained on rendered random worlds only, and tracks "
    "each person with a Kalman filter in metres. Needs contrast, but not temperatures. "
    "Re-identifies people by the colours of their clothes.",
)
def _detection(rng: "np.random.Generator", detector: str | None = None) -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((_thermal_sensor(detector),))


@TRACKERS.register(
    LIVE_TRACKER,
    scope="default tracker for live cameras",
    summary="Like `detection`, but searches whole images of a camera without calibration at most 22 times a "
    "second, and rescores tracked people in between. At 30 images a second it needs half the time.",
)
def _detection_live(rng: "np.random.Generator", detector: str | None = None) -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.tracking.config import LIVE
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((_thermal_sensor(detector, LIVE),), LIVE)


@TRACKERS.register(
    CONTOUR_TRACKER,
    scope="thesis, chapters 4 to 7, with extensions",
    summary="Tracks each person with a particle filter, using contour, colour and thermal appearance. "
    "Sorts overlapping people by depth, ignores evidence from the people in front, and lets "
    "occluded people coast. Uses odometry.",
)
def _contour(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker(CONTOUR_TRACKER, rng)


@TRACKERS.register(
    "learned",
    scope="thesis, chapters 4 to 7, with extensions",
    summary="Like `contour`, but the classifier of `peopleboy train occlusion` decides which person is "
    "in front.",
)
def _learned(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker("learned", rng)


@TRACKERS.register(
    "thesis",
    scope="thesis, chapters 4 to 7",
    summary="Reimplements the thesis literally, with independent filters, colour moments, and a boosted "
    "classifier that decides which of two overlapping people is in front.",
)
def _thesis(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker("thesis", rng)


@TRACKERS.register(
    "thermal",
    scope="thesis, chapters 4 and 5",
    summary="Like `thesis`, with the thermal image only.",
)
def _thermal(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker("thermal", rng)


@TRACKERS.register(
    "colour",
    scope="thesis, chapters 4 to 6",
    summary="Like `thesis`, with colour, but without occlusion handling.",
)
def _colour(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker("colour", rng)


@TRACKERS.register(
    "paper",
    scope="the 2005 paper",
    summary="Uses the measurement model of the paper and its best 30 % of the samples. Needs three "
    "frames to confirm a person.",
)
def _paper(rng: "np.random.Generator") -> Tracker:
    return _contour_tracker("paper", rng)


@TRACKERS.register(
    "thesis-single",
    scope="thesis, chapter 4",
    summary="Tracks one person at a time with one particle filter, in the thermal image only. The filter "
    "always runs, and a person counts as detected while it fits.",
)
def _thesis_single(rng: "np.random.Generator") -> Tracker:
    return _single_filter("thesis-single", rng)


@TRACKERS.register(
    "paper-single",
    scope="the 2005 paper, tables 1 to 3",
    summary="Like `thesis-single`, with the measurement model of the paper and its best 30 % of the samples.",
)
def _paper_single(rng: "np.random.Generator") -> Tracker:
    return _single_filter("paper-single", rng)


@TRACKERS.register(
    "panoramic-paper",
    scope="the 2003 paper",
    summary="Tracks one person around a stationary robot, with the panoramic camera only. Uses "
    "background subtraction, a network that estimates the distance (trained by `peopleboy train "
    "distance`), and a Kalman filter on the floor.",
)
def _panoramic_paper(rng: "np.random.Generator") -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.reproductions.panoramic.distance_network import shipped_models
    from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicPaperTracker

    return PanoramicPaperTracker(tuple(shipped_models().values()))


@TRACKERS.register(
    "panoramic",
    scope="the 2003 paper, with extensions",
    summary="Tracks several people around a stationary or moving robot, with the panoramic camera only. "
    "Uses learned foreground segmentation and learned floor positions with covariances, in one Kalman "
    "filter for each person.",
)
def _panoramic(rng: "np.random.Generator") -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaSensor
    from peopleboy.tracker.tracking.config import PANORAMIC
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((PanoramaSensor(tracker=PANORAMIC),), PANORAMIC)


@TRACKERS.register(
    "handover",
    scope="thesis, section 8.2",
    summary="Detects people in the thermal image and in the panorama, in one Kalman filter for each person. "
    "A person keeps the same id from the thermal image to the panorama and back.",
)
def _handover(rng: "np.random.Generator", detector: str | None = None) -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaSensor
    from peopleboy.tracker.tracking.config import FUSED
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((_thermal_sensor(detector, FUSED), PanoramaSensor(tracker=FUSED)), FUSED)


@TRACKERS.register(
    "rgbd",
    scope="the situation-awareness thesis, chapter 4, with extensions",
    summary="Tracks people on the floor with an RGB-D camera, on a stationary or moving robot. Verifies "
    "candidates of human size with a learned classifier, and tracks each person with a Kalman filter.",
)
def _rgbd(rng: "np.random.Generator") -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.frame import THERMAL
    from peopleboy.tracker.sensors.depth.depth_sensor import DepthSensor
    from peopleboy.tracker.tracking.config import RGBD
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((DepthSensor(tracker=RGBD),), RGBD, shown_in=(THERMAL,))


@TRACKERS.register(
    "rgbd-printed",
    scope="the situation-awareness thesis, chapter 4",
    summary="Detects people like `rgbd`, and tracks each person with a particle filter. Uses the settings of "
    "the thesis wherever it states them.",
)
def _rgbd_printed(rng: "np.random.Generator") -> Tracker:
    from peopleboy.tracker.reproductions.rgbd.rgbd_config import PRINTED
    from peopleboy.tracker.reproductions.rgbd.rgbd_tracker import RgbdTracker
    from peopleboy.tracker.sensors.depth.window_model import shipped_windows

    return RgbdTracker(PRINTED, shipped_windows(sees_depth=PRINTED.sees_depth), rng)


@TRACKERS.register(
    "laser",
    scope="a robot with a laser range finder",
    summary="Tracks people on the floor by their legs in the scans of a laser range finder, with learned "
    "detection, on a stationary or moving robot. Needs no image.",
)
def _laser(rng: "np.random.Generator") -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.frame import THERMAL
    from peopleboy.tracker.sensors.laser.laser_sensor import LaserSensor
    from peopleboy.tracker.tracking.config import SCANNED
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((LaserSensor(tracker=SCANNED),), SCANNED, shown_in=(THERMAL,))


@TRACKERS.register(
    "fused",
    scope="the default and both theses, with extensions",
    summary="Combines detections in the thermal image, in the depth image, and in the panorama and the laser "
    "scan if the robot has these, in one Kalman filter for each person. Uses depth to find occluders. "
    "Re-identifies people by colours, motion and stature.",
)
def _fused(rng: "np.random.Generator", detector: str | None = None) -> Tracker:  # noqa: ARG001
    from peopleboy.tracker.sensors.depth.depth_sensor import DepthSensor
    from peopleboy.tracker.sensors.laser.laser_sensor import LaserSensor
    from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaSensor
    from peopleboy.tracker.tracking.config import FUSED
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    ahead = (_thermal_sensor(detector, FUSED), DepthSensor(tracker=FUSED))
    further = (PanoramaSensor(tracker=FUSED), LaserSensor(tracker=FUSED))
    return PeopleTracker(ahead, FUSED, optional=further)


@TRACKERS.register(
    "attentive",
    scope="the default, with the long memory of the situation-awareness thesis, chapter 5",
    summary="Like `detection`, but remembers people for ten minutes: a person who comes back gets the old "
    "id, and unknown people get new ids.",
)
def _attentive(
    rng: "np.random.Generator",  # noqa: ARG001
    detector: str | None = None,
) -> Tracker:
    from peopleboy.tracker.tracking.config import ATTENTIVE
    from peopleboy.tracker.tracking.people_tracker import PeopleTracker

    return PeopleTracker((_thermal_sensor(detector, ATTENTIVE),), ATTENTIVE)


@TRACKERS.register(
    "attentive-printed",
    scope="the situation-awareness thesis, chapter 5",
    summary="Adds re-identification to `contour`, with the attention model exactly as printed in that "
    "chapter.",
)
def _attentive_printed(rng: "np.random.Generator") -> Tracker:
    from peopleboy.tracker.reproductions.attention.attention_config import PRINTED
    from peopleboy.tracker.reproductions.attention.attentive_tracker import AS_FOUND, AttentiveTracker
    from peopleboy.tracker.reproductions.attention.recogniser import ByFocus

    return AttentiveTracker(_contour_tracker(CONTOUR_TRACKER, rng), ByFocus(PRINTED), AS_FOUND)


def is_own(name: str) -> bool:
    """Return whether tracks depend on a user's tracker or detector, or on that of another package."""
    detector = split_name(name)[1]
    has_own = detector is not None and not is_network_file(detector)
    return ":" in name or TRACKERS.is_plugged_in(name) or has_own


def make_tracker(name: str, seed: int = 0) -> Tracker:
    """Make a tracker by its name: one of `TRACKERS`, or "module:Class" for one of your own.

    "detection+FILE.npz" is the tracker `detection` with a network of `peopleboy train people`,
    "detection+module:Class" is the tracker `detection` with a detector of your own, and "detection+FILE.txt"
    with the detections of a MOTChallenge file; `WITH_DETECTOR` lists the trackers that can use them. Modules
    are searched for on the Python path and in the working directory.

    Args:
        name: of the tracker.
        seed: of its random numbers. The tracker of `peopleboy run --seed 3` is the one with seed 3.

    Raises:
        BadInput: the name is unknown, the object is not a tracker or detector, the tracker uses no detector,
            or the seed is negative.
    """
    from peopleboy.random_streams import stream  # here, so that listing trackers does not load NumPy

    try:
        number = operator.index(seed)
    except TypeError:
        number = -1
    if number < 0:
        raise BadInput(f"tracker {name!r}: seed must be a whole number of 0 or more, got {seed!r}")
    rng = stream(number, "tracker")
    tracker, detector = split_name(name)
    if detector is not None and name not in TRACKERS:
        return _with_detector(tracker, detector, rng)
    if ":" in name:
        return _checked(name, load_own("tracker", name, _CALL)(rng))
    if name not in TRACKERS:
        known = ", ".join(TRACKERS)
        raise BadInput(f"unknown tracker {name!r}; choose from {known}, or your own as module:Class")
    if is_own(name):
        return _checked(name, guarded("tracker", name, _CALL, TRACKERS[name])(rng))
    shipped: Tracker = TRACKERS[name](rng)
    return shipped


def _with_detector(tracker: str, detector: str, rng: "np.random.Generator") -> Tracker:
    if tracker not in WITH_DETECTOR:
        known = ", ".join(WITH_DETECTOR)
        raise BadInput(
            f"tracker {tracker!r} uses no detector, got {detector!r}; choose a tracker from {known}"
        )
    made: Tracker = TRACKERS[tracker](rng, detector)
    return made


_CALL: Final = "with a numpy.random.Generator"


def _checked(name: str, tracker: object) -> Tracker:
    if not isinstance(tracker, Tracker):
        raise BadInput(f"tracker {name!r}: not a tracker; it needs `cameras` and `update(frame)`")
    cameras = tracker.cameras
    if not isinstance(cameras, tuple) or not all(isinstance(camera, str) for camera in cameras):
        raise BadInput(
            f"tracker {name!r}: `cameras` must be a tuple of names, such as ('thermal',), got {cameras!r}"
        )
    return tracker
