"""What the thermal sensor asks of a detector: the boxes of people in the next image."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

from peopleboy.tracker.frame import Floats, Frame
from peopleboy.tracker.sensors.detections import NO_DETECTIONS, Detections
from peopleboy.tracker.tracking.sensor import Predictions, SensorDetections
from peopleboy.tracker.tracking.viewpoint import Viewpoint


class DetectedBoxes(NamedTuple):
    """People in one frame, with boxes [px] in the thermal image.

    Attributes:
        found: detections with their log-odds.
        followed: boxes of tracks that were located without the detector, with their earlier log-odds.
        rows: of the tracks of `followed`.
        is_search: whether the whole image was searched, so that a detection without a track is a new person.
        posture: (M, 5) log-odds of the postures of `found`, up to a constant; None if none are recognised.
    """

    found: Detections
    followed: Detections = NO_DETECTIONS
    rows: tuple[int, ...] = ()
    is_search: bool = True
    posture: Floats | None = None


class BoxDetector(Protocol):
    """Detects people frame by frame; it may use the predicted tracks to save time."""

    def detect(
        self, frame: Frame, view: Viewpoint, predicted: Predictions, expected: Floats
    ) -> DetectedBoxes | None:
        """Detect people in the next frame; None if it has no new image.

        Args:
            frame: the frame, with a thermal image.
            view: of the thermal camera.
            predicted: the K tracks.
            expected: (K, 4) their predicted boxes [px] in the thermal image.

        Raises:
            BadInput: an image or a detection is invalid.
        """
        ...

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Note which of the last detections, by the row of the track, was found to be of which track."""
        ...
