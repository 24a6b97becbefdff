"""Detectors of users: a class with `detect(image)`, a MOTChallenge file, or a trained network."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any, Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.own_code import load_own
from peopleboy.tracker.boxes import centres_outside
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.evaluation.mot_files import read_detections
from peopleboy.tracker.evaluation.sequence import FARTHEST
from peopleboy.tracker.frame import COLOUR, THERMAL, Floats, Frame, lacking
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.sensors.box_detector import BoxDetector, DetectedBoxes
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.image_change import PastImages
from peopleboy.tracker.sensors.thermal.detector.people_network import PeopleNetwork
from peopleboy.tracker.tracker_names import is_detection_file, is_network_file
from peopleboy.tracker.tracking.appearance import boxes_in_other_image
from peopleboy.tracker.tracking.config import DetectorScoreConfig, PeopleTrackerConfig
from peopleboy.tracker.tracking.sensor import Predictions, SensorDetections
from peopleboy.tracker.tracking.viewpoint import Viewpoint

CAMERAS: Final = (THERMAL, COLOUR)
"""Cameras whose images a user's detector can use."""

_CALL: Final = "without arguments"
_MOST_OUTSIDE: Final = 0.5  # share of a file's boxes; more suggests other images, or another image size


@runtime_checkable
class ImageDetector(Protocol):
    """A user's detector of people in single images.

    Two attributes are optional. `camera` is "thermal", the default, or "colour". `log_odds = True` declares
    that scores are log-odds of being a person; otherwise they are probabilities, 0 to 1.
    """

    def detect(self, image: NDArray[np.uint8]) -> tuple[ArrayLike, ArrayLike]:
        """Detect people in the next image of the camera.

        Args:
            image: (H, W) grey, or (H, W, 3) RGB in colour; read-only.

        Returns:
            (M, 4) boxes [px] left, top, width, height from the centre of the first pixel, and (M,) scores.
        """
        ...


def make_box_detector(name: str, config: PeopleTrackerConfig | None = None) -> BoxDetector:
    """Make a detector for the thermal sensor: a trained network by its file, or one of a user by its name.

    Raises:
        BadInput: as for `make_detector`.
    """
    if is_network_file(name):
        return NetworkDetector(PeopleNetwork.load(Path(name)), config)
    return OwnDetector(make_detector(name), config)


def make_detector(name: str) -> ImageDetector:
    """Make a user's detector by its name: "module:Class", or a MOTChallenge file that ends in .txt.

    Raises:
        BadInput: the name is neither, the object is not a detector, or the file is invalid.
    """
    if is_detection_file(name):
        return FileDetector(Path(name))
    if ":" not in name:
        raise BadInput(
            f"detector {name!r}: must be module:Class (your own), a MOTChallenge file of detections (.txt), "
            "or a network of `peopleboy train people` (.npz)"
        )
    detector = load_own("detector", name, _CALL)()
    if not isinstance(detector, ImageDetector):
        raise BadInput(f"detector {name!r}: not a detector; it needs `detect(image)`")
    if camera_of(detector) not in CAMERAS:
        known = " or ".join(map(repr, CAMERAS))
        raise BadInput(f"detector {name!r}: `camera` must be {known}, got {camera_of(detector)!r}")
    return detector


def camera_of(detector: ImageDetector) -> object:
    """Return the name of the camera whose images a detector uses."""
    return getattr(detector, "camera", THERMAL)


class OwnDetector:
    """Runs a user's detector on every image, and validates its detections.

    Boxes in the colour image are transferred to the thermal image.

    Args:
        detector: the user's detector.
        config: settings of the tracker.
    """

    def __init__(self, detector: ImageDetector, config: PeopleTrackerConfig | None = None) -> None:
        config = PeopleTrackerConfig() if config is None else config
        self._detector, self._camera = detector, str(camera_of(detector))
        self._is_log_odds = bool(getattr(detector, "log_odds", False))
        self._scores, self._weakest = config.detector_scores, config.existence.weakest
        self._is_first = True

    def detect(
        self,
        frame: Frame,
        view: Viewpoint,  # noqa: ARG002
        predicted: Predictions,  # noqa: ARG002
        expected: Floats,  # noqa: ARG002
    ) -> DetectedBoxes | None:
        """Detect people in the next image; None if the camera took none.

        Raises:
            BadInput: the detector returned invalid values, or the first frame has no image of the camera.
        """
        if self._camera not in frame.images:
            if self._is_first:
                raise BadInput(lacking(self._camera, frame.images))
            return None
        self._is_first = False
        box, score = _checked(self._detector.detect(frame.images[self._camera]), self._is_log_odds)
        log_odds = score if self._is_log_odds else log_odds_of(score)
        log_odds = np.clip(log_odds, -self._scores.most, self._scores.most)
        if self._camera != THERMAL:
            box = boxes_in_other_image(frame, box, self._camera, THERMAL)
        is_usable = (log_odds >= self._weakest) & (box[:, 2:] > 0.0).all(axis=1)
        return DetectedBoxes(Detections.from_trees(box[is_usable], log_odds[is_usable]))

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Do nothing: the detector knows of no tracks."""


class NetworkDetector:
    """Runs a trained network on every image, and recognises postures.

    Args:
        network: the network.
        config: of the tracker.
    """

    def __init__(self, network: PeopleNetwork, config: PeopleTrackerConfig | None = None) -> None:
        self._weakest = (PeopleTrackerConfig() if config is None else config).existence.weakest
        self._network = network
        self._past, self._workspace = PastImages(), Workspace()

    def detect(
        self,
        frame: Frame,
        view: Viewpoint,  # noqa: ARG002
        predicted: Predictions,  # noqa: ARG002
        expected: Floats,  # noqa: ARG002
    ) -> DetectedBoxes:
        """Detect people in the next thermal image; see `BoxDetector`."""
        grey, calibration = frame.grey(THERMAL), frame.calibrations.get(THERMAL)
        mount = None if calibration is None else mount_of(calibration, grey.shape[0])
        self._past.keep(grey, frame.time_s, frame.odometry)
        found = self._network.detect(grey, self._past.change(mount), mount, self._weakest, self._workspace)
        return DetectedBoxes(
            Detections(found.box, found.score, found.score, found.edges), posture=found.posture
        )

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Do nothing: the network uses no tracks."""


def log_odds_of(probability: Floats) -> Floats:
    """Return the log-odds (M,) of probabilities (M,); infinite for 0 and 1."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(probability) - np.log1p(-probability))


def _checked(answer: object, is_log_odds: bool) -> tuple[Floats, Floats]:
    """Return boxes (M, 4) and scores (M,) of a detector's answer.

    Raises:
        BadInput: the answer is invalid.
    """
    if not isinstance(answer, tuple | list) or len(answer) != 2:
        raise BadInput(f"detect(image) must return boxes and scores, got {_described(answer)}")
    box, score = _as_numbers("boxes", answer[0]), _as_numbers("scores", answer[1])
    if box.size == 0 and score.size == 0:
        return np.empty((0, 4)), np.empty(0)
    for fault in _faults(box, score, is_log_odds):
        raise BadInput(f"detect(image): {fault}")
    return box, score


def _as_numbers(what: str, values: Any) -> Floats:
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise BadInput(
            f"detect(image): {what} must be an array of numbers, got {_described(values)}"
        ) from None


def _described(value: object) -> str:
    return (
        f"{type(value).__name__} of {len(value)}" if isinstance(value, tuple | list) else type(value).__name__
    )


def _faults(box: Floats, score: Floats, is_log_odds: bool) -> Iterator[str]:
    """Yield what is wrong with boxes and scores, and what would be right."""
    if box.ndim != 2 or box.shape[1] != 4:
        yield f"boxes must be (M, 4): left, top, width, height [px], got shape {box.shape}"
        return
    if score.shape != (len(box),):
        yield f"scores must be ({len(box)},), one for each box, got shape {score.shape}"
        return
    is_near = (np.abs(box) <= FARTHEST).all(axis=1)
    is_wide = (box[:, 2:] > 0.0).all(axis=1)
    for row in np.flatnonzero(~(is_near & is_wide))[:1]:
        yield f"box {row} must have finite left and top, width > 0 and height > 0, got {box[row].tolist()}"
    for row in np.flatnonzero(~np.isfinite(score))[:1]:
        yield f"score {row} must be finite, got {score[row]}"
    if not is_log_odds:
        for row in np.flatnonzero((score < 0.0) | (score > 1.0))[:1]:
            yield (
                f"score {row} must be a probability, 0 to 1, got {score[row]:g}; "
                "for log-odds, set `log_odds = True` in the class"
            )


class FileDetector:
    """Returns the detections of a MOTChallenge file: those of frame 1 for the first image, and so on.

    Scores from 0 to 1 are probabilities. If a score is outside this range, the scale is unknown, and the
    probability of a detection is the share of the file's detections with lower scores. Detections
    without a score are those of `read_detections`.

    Args:
        path: of the file.
        config: probability of detections without a score.

    Raises:
        BadInput: the file cannot be read, or one of its lines is malformed.
    """

    camera = THERMAL

    def __init__(self, path: Path, config: DetectorScoreConfig | None = None) -> None:
        self._path, self._images = path, count(1)
        frame, self._box, score = read_detections(path)
        self._frame, self._score = frame, _probabilities(score, config or DetectorScoreConfig())

    def detect(self, image: NDArray[np.uint8]) -> tuple[Floats, Floats]:
        """Return the detections in the next image.

        Raises:
            BadInput: most boxes of the file are outside the first image.
        """
        number = next(self._images)
        if number == 1:
            self._check_view(image)
        rows = self._frame == number
        return self._box[rows], self._score[rows]

    def _check_view(self, image: NDArray[np.uint8]) -> None:
        height, width = image.shape[:2]
        outside = centres_outside(self._box, width, height)
        if len(outside) and outside.mean() > _MOST_OUTSIDE:
            raise BadInput(
                f"{self._path}: boxes must be in pixels of the {width} x {height} images; "
                f"{outside.mean():.0%} of them have their centre outside"
            )


def _probabilities(score: Floats, config: DetectorScoreConfig) -> Floats:
    """Return the probabilities (N,) of all detections of a file by their scores, NaN where none is given."""
    given, result = ~np.isnan(score), np.full(len(score), config.unscored)
    known = score[given]
    if ((known < 0.0) | (known > 1.0)).any():
        _, place, rows = np.unique(known, return_inverse=True, return_counts=True)
        known = ((np.cumsum(rows) - rows / 2.0) / len(known))[place]
    result[given] = known
    return result
