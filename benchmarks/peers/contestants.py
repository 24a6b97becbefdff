"""All compared trackers by name: peers, and those of `peopleboy.tracker.trackers`."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, Literal, Protocol

import numpy as np
import supervision as sv
from trackers import ByteTrackTracker, SORTTracker

from benchmarks.peers.classic import DetectAndFilter
from benchmarks.peers.detectors import Blobs, Boxes, Hog, NanoDet, Oracle, PeerDetections, SsdLite
from benchmarks.peers.joint_filter import JointFilter
from benchmarks.peers.ours import Contestant, Ours, WithTrueIds, on_true_boxes
from peopleboy.random_streams import stream
from peopleboy.tracker.boxes import within_image
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.trackers import DEFAULT_TRACKER

RATE_HZ = 15.0
# In frames at 30 Hz, as the package counts: five seconds. Among 1, 2, 5 and 10 s, it gives the best IDF1 for
# the oracle, and is within a point of the best for the blobs.
_LOST_BUFFER = 150
_STRONG = 0.4  # confidence; HOG's are lower than those of the detectors for which the defaults were chosen


# Tuned in the peers' favour, by the mean HOTA of camel_08 and camel_21: confidences .4 to .94, lost tracks
# kept for 1 or 5 s, and two ratios of width to height. HOG's weak windows only add false tracks.
_CLIP_STRONG: Final = 0.91
_WIDE: Final = 0.43  # chosen from .43 and PeopleBoy's .45
_SSD_STRONG: Final = 0.6  # chosen from .25, .4 and .6 by the mean HOTA of the clips for choosing
_SSD_WEAKEST: Final = 0.1
# By the mean HOTA of the first 240 frames of each clip for choosing; weaker detections only count for AP.
_NANODET_STRONG: Final = 0.4  # chosen from .25 to .6
_NANODET_TRACKED: Final = 0.15  # chosen from .05 to .3
_NANODET_WEAKEST: Final = 0.05
_WEAKEST: Final = 0.0  # distance from the decision boundary


class _BoxDetector(Protocol):
    def detect(self, frame: Frame) -> PeerDetections: ...


class DetectAndAssociate:
    """A detector, and a tracker that uses only its boxes.

    Args:
        detector: the detector.
        tracker: the tracker.
        weakest: least confidence of a detection for the tracker.
    """

    def __init__(self, detector: _BoxDetector, tracker: Any, weakest: float = 0.0) -> None:
        self._detector, self._tracker, self._weakest = detector, tracker, weakest
        self.detections: PeerDetections | None = None

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Detect, and associate."""
        found = self.detections = self._detector.detect(frame)
        corners = np.concatenate([found.box[:, :2], found.box[:, :2] + found.box[:, 2:]], axis=1)
        used = found.confidence >= self._weakest
        tracked = self._tracker.update(sv.Detections(xyxy=corners[used], confidence=found.confidence[used]))
        is_known = np.asarray(tracked.tracker_id).reshape(-1) >= 0
        corners = tracked.xyxy[is_known]
        boxes = np.concatenate([corners[:, :2], corners[:, 2:] - corners[:, :2]], axis=1)
        return boxes, [int(number) for number in np.asarray(tracked.tracker_id)[is_known]]


def _bytetrack() -> Any:
    return ByteTrackTracker(
        lost_track_buffer=_LOST_BUFFER,
        frame_rate=RATE_HZ,
        track_activation_threshold=_STRONG,
        high_conf_det_threshold=_STRONG,
    )


def _sort() -> Any:
    return SORTTracker(lost_track_buffer=_LOST_BUFFER, frame_rate=RATE_HZ, track_activation_threshold=_STRONG)


PEERS: dict[str, Callable[[TrueBoxes], Contestant]] = {
    "hog_colour+bytetrack": lambda _: DetectAndAssociate(Hog(uses_colour=True), _bytetrack()),
    "hog_colour+sort": lambda _: DetectAndAssociate(Hog(uses_colour=True), _sort()),
    "hog_thermal+bytetrack": lambda _: DetectAndAssociate(Hog(uses_colour=False), _bytetrack()),
    "hog_thermal+sort": lambda _: DetectAndAssociate(Hog(uses_colour=False), _sort()),
    "blobs+bytetrack": lambda _: DetectAndAssociate(Blobs(), _bytetrack()),
    "blobs+sort": lambda _: DetectAndAssociate(Blobs(), _sort()),
    "oracle+bytetrack": lambda truth: DetectAndAssociate(Oracle(truth), _bytetrack()),
    "blobs+jpda": lambda _: DetectAndFilter(Blobs(), is_joint=True),
    "blobs+mht": lambda _: DetectAndFilter(Blobs(), is_joint=False),
    "oracle+jpda": lambda truth: DetectAndFilter(Oracle(truth), is_joint=True),
    "oracle+mht": lambda truth: DetectAndFilter(Oracle(truth), is_joint=False),
}
"""Factory of each peer by name; only the oracle uses the ground truth."""

BOUNDS: dict[str, Callable[[TrueBoxes], Contestant]] = {
    f"oracle+{DEFAULT_TRACKER}": on_true_boxes,
    f"{DEFAULT_TRACKER}+oracle": lambda truth: WithTrueIds(Ours.named(DEFAULT_TRACKER, 0), truth),
}
"""Factory of the default tracker with true boxes, and with true ids."""

JOINT = "thermal+mcmc"
"""Name of the literal tracker's contour in one joint filter for all people."""


def contestants() -> list[str]:
    """Return the names of all trackers that can be compared."""
    return [*VARIANTS, DEFAULT_TRACKER, *PEERS, *BOUNDS, JOINT]


def make_contestant(name: str, seed: int, truth: TrueBoxes) -> Contestant:
    """Make a tracker for one run.

    Raises:
        BadInput: an unknown name.
    """
    if name == JOINT:
        return JointFilter(stream(seed, "peers.joint"))
    factories = PEERS | BOUNDS
    return factories[name](truth) if name in factories else Ours.named(name, seed)


class PeerOfClips(DetectAndAssociate):
    """A peer whose boxes are clipped to the image, like PeopleBoy's and those of annotators."""

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Detect, associate, and clip."""
        boxes, ids = super().step(frame)
        rows, columns = frame.images[THERMAL].shape[:2]
        assert self.detections is not None
        inside = within_image(self.detections.box, columns, rows)
        self.detections = replace(self.detections, box=inside)
        return within_image(boxes, columns, rows), ids


def make_clip_peer(detector: Literal["hog", "ssdlite", "nanodet"], enlarged: float = 1.0) -> PeerOfClips:
    """Make a peer for one clip.

    Args:
        detector: its detector.
        enlarged: factor by which images are enlarged for HOG.

    Raises:
        BadInput: a package is missing.
    """
    if detector == "hog":
        hog = Hog(uses_colour=False, width_per_height=_WIDE, enlarged=enlarged, weakest=_WEAKEST)
        return _clip_peer(hog, _CLIP_STRONG)
    if detector == "ssdlite":
        return _clip_peer(SsdLite(_SSD_WEAKEST), _SSD_STRONG)
    return _clip_peer(NanoDet(_NANODET_WEAKEST), _NANODET_STRONG, _NANODET_TRACKED)


def _clip_peer(detector: _BoxDetector, strong: float, weakest: float = 0.0) -> PeerOfClips:
    tracker = ByteTrackTracker(
        lost_track_buffer=_LOST_BUFFER,
        track_activation_threshold=strong,
        high_conf_det_threshold=strong,
    )
    return PeerOfClips(detector, tracker, weakest)
