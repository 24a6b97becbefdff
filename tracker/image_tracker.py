"""Tracking in a camera's own images, without frames or calibrations."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.footage.grey import Radiometry
from peopleboy.tracker.footage.lens import Lens
from peopleboy.tracker.footage.thermal_images import ThermalImages
from peopleboy.tracker.frame import COLOUR, THERMAL
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own, make_tracker, uses_contrast


class ImageTracker:
    """Tracks people in the images of a thermal camera, as `peopleboy track` does in files.

    Args:
        tracker: name of the tracker, as for `make_tracker`.
        radiometry: meaning of pixel values; None if it is unknown.
        boxes: what boxes enclose; None for whole people, or for whatever your own tracker returns.
        seed: of the tracker's random numbers.
        mask: (H, W) bool, where people are searched for; None for everywhere.
        lens: distortion to correct, from `read_lens`; boxes are in the corrected images. None for none.
        calibration: of the camera, for positions on the floor; None if it is unknown.

    Raises:
        BadInput: the tracker is unknown, or the meaning of pixel values is invalid.
    """

    def __init__(
        self,
        tracker: str = DEFAULT_TRACKER,
        *,
        radiometry: Radiometry | None = None,
        boxes: BoxKind | None = None,
        seed: int = 0,
        mask: NDArray[np.bool_] | None = None,
        lens: Lens | None = None,
        calibration: Calibration | None = None,
    ) -> None:
        if boxes is None and not is_own(tracker):
            boxes = BoxKind.WHOLE
        self._images = ThermalImages(
            radiometry,
            by_contrast=uses_contrast(tracker),
            mask=mask,
            lens=lens,
            calibrate=None if calibration is None else lambda width, height: calibration,  # noqa: ARG005
        )
        self._tracker = CheckedTracker(
            make_tracker(tracker, seed), f"tracker {tracker!r}", (THERMAL, COLOUR), boxes
        )

    def update(
        self, image: NDArray[Any], time_s: float, colour: NDArray[np.uint8] | None = None
    ) -> tuple[Track, ...]:
        """Track people in the next image.

        16-bit images are converted to local contrast if the tracker uses only contrast.

        Args:
            image: (H, W) uint8, uint16 or float32, or (H, W, 3) uint8; as large as the first.
            time_s: when it was taken [s]; later than the one before.
            colour: (H', W', 3) uint8 RGB image of the same view; None for none.

        Returns:
            The tracks, with boxes in the image `thermal`.

        Raises:
            BadInput: the image is of another kind or size, or not later than the last one.
            OwnCodeFailed: your own tracker raised an error.
        """
        return self._tracker.update(self._images.frame(image, time_s, colour))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the interpretation of the images so far."""
        return tuple(self._images.notes)

    @property
    def explanation(self) -> object:
        """The state behind the last tracks; None if the tracker has none."""
        return self._tracker.explanation
