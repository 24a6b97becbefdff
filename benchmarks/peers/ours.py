"""PeopleBoy's trackers for comparisons, also with parts from the ground truth; no other packages needed."""

from itertools import count
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.peers.detectors import Boxes, Oracle, PeerDetections
from peopleboy.tracker.boxes import Box, iou, within_image
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.box_kinds import boxed_whole, whole_of
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.sensors.own_detector import OwnDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import DetectionExplanation, ThermalSensor
from peopleboy.tracker.track import confirmed
from peopleboy.tracker.trackers import Tracker, explanation_of, make_tracker
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

_ON_PERSON: Final = 0.5  # overlap with the true box, as in the metrics
_SURE: Final = 0.999  # probability of a true box


class Contestant(Protocol):
    """Interface of compared trackers: frames in, boxes with ids out."""

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Return boxes (N, 4) of the next frame, left, top, width, height [px], and their ids."""
        ...


class Detecting(Contestant, Protocol):
    """A contestant that gives its detections, too."""

    @property
    def detections(self) -> PeerDetections | None:
        """Detections in the last frame, before tracking; None of a tracker without any."""
        ...


class Ours:
    """A tracker of `peopleboy.tracker.trackers`, or one of its kind."""

    def __init__(self, tracker: Tracker, *, boxes_whole: bool = False) -> None:
        self._tracker = tracker
        self._boxes_whole = boxes_whole
        self._shape = (0, 0)

    @classmethod
    def named(cls, name: str, seed: int, *, boxes_whole: bool = False) -> "Ours":
        """Make a tracker by its name."""
        return cls(make_tracker(name, seed), boxes_whole=boxes_whole)

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the required cameras."""
        return self._tracker.cameras

    @property
    def detections(self) -> PeerDetections | None:
        """Detections in the last thermal image; None of a tracker that does not explain itself by them."""
        explained = explanation_of(self._tracker)
        if not isinstance(explained, DetectionExplanation):
            return None
        boxes = explained.boxes
        if self._boxes_whole and len(boxes):
            rows, columns = self._shape
            wholes = [_whole(*both) for both in zip(boxes.tolist(), explained.edges.tolist(), strict=True)]
            boxes = within_image(np.array(wholes), columns, rows)
        return PeerDetections(boxes, 1.0 / (1.0 + np.exp(-explained.scores)))

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Update the tracker, and return the confirmed tracks."""
        tracks = self._tracker.update(frame)
        self._shape = frame.images[THERMAL].shape[:2] if THERMAL in frame.images else self._shape
        found = list(confirmed(boxed_whole(tracks, frame) if self._boxes_whole else tracks, THERMAL))
        return np.array([box for _, box in found]).reshape(-1, 4), [track.id for track, _ in found]


def _whole(torso: list[float], edges: list[float]) -> Box:
    """Return the box of a whole person, as `whole_of` does; edges are NaN where unknown."""
    left, top, width, height = torso
    return whole_of((left, top, width, height), None if np.isnan(edges).any() else (edges[0], edges[1]))


class TrueDetector:
    """A detector that returns the true boxes of sufficiently visible people, image by image."""

    def __init__(self, truth: TrueBoxes) -> None:
        self._oracle = Oracle(truth)

    def detect(self, image: NDArray[np.uint8]) -> tuple[Boxes, NDArray[np.float64]]:  # noqa: ARG002
        """Return the boxes (M, 4) and probabilities (M,) of the next image."""
        found = self._oracle.detect_next()
        return found.box, np.full(len(found.box), _SURE)


def on_true_boxes(truth: TrueBoxes) -> Ours:
    """Return the default tracker with true boxes instead of its detector's."""
    return Ours(PeopleTracker((ThermalSensor(detector=OwnDetector(TrueDetector(truth))),)))


class WithTrueIds:
    """A tracker of which each box on a person has the id of that person."""

    def __init__(self, tracker: Ours, truth: TrueBoxes) -> None:
        self._tracker, self._truth, self._frames = tracker, truth, count(1)
        self._others = int(truth.id.max(initial=0)) + 1  # added to the ids of other boxes

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Update the tracker, and replace its ids."""
        boxes, ids = self._tracker.step(frame)
        people = self._truth.take(self._truth.frame == next(self._frames))
        overlap = iou(boxes[:, None], people.box[None])
        ids = [number + self._others for number in ids]
        for row, person in zip(
            *linear_sum_assignment(-np.where(overlap < _ON_PERSON, 0.0, overlap)), strict=True
        ):
            if overlap[row, person] >= _ON_PERSON:
                ids[row] = int(people.id[person])
        return boxes, ids
