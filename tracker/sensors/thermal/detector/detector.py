"""The detector of people in thermal images: cascade, rescoring and box refinement."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.networks.convolution import Buffer, Workspace
from peopleboy.tracker.networks.inference import one_thread
from peopleboy.tracker.sensors.detections import NO_DETECTIONS, SHARED, Detections, suppress
from peopleboy.tracker.sensors.thermal.detector.image_change import PastImages
from peopleboy.tracker.sensors.thermal.detector.patches import integrate
from peopleboy.tracker.sensors.thermal.detector.people_trees import PeopleModel, shipped_people_trees
from peopleboy.tracker.sensors.thermal.detector.pyramid import pyramid_levels
from peopleboy.tracker.sensors.thermal.detector.rescoring import (
    BoxRefinementNetwork,
    RescoringNetwork,
    refine_boxes,
    rescore,
)

Grey = NDArray[np.uint8]

SMALLEST_PX: Final = 24.0
"""Height of the smallest detected people."""

WEAKEST: Final = -3.5
"""Score from which a detection of the cascade is rescored."""


class PeopleDetector:
    """Detects people in consecutive images; earlier images are kept to detect motion."""

    def __init__(
        self,
        model: PeopleModel | None = None,
        rescoring: RescoringNetwork | None = None,
        box_refinement: BoxRefinementNetwork | None = None,
        *,
        smallest_px: float = SMALLEST_PX,
        least_score: float = 0.0,
    ) -> None:
        """Make one with the shipped trees and networks, or with others.

        Args:
            model: trees of cascade and box regression.
            rescoring: network that corrects the scores.
            box_refinement: network that corrects the boxes.
            smallest_px: height of the smallest people that are detected.
            least_score: of the returned detections.
        """
        self._model = shipped_people_trees() if model is None else model
        self._rescoring = RescoringNetwork.shipped() if rescoring is None else rescoring
        self._box_refinement = BoxRefinementNetwork.shipped() if box_refinement is None else box_refinement
        self._smallest_px = smallest_px
        self._least_score = least_score
        self._past = PastImages()
        self._buffer, self._workspace = Buffer(), Workspace()

    def update(
        self,
        grey: Grey,
        time_s: float,
        odometry: Odometry | None = None,
        mount: Mount | None = None,
        expected: Detections = NO_DETECTIONS,
        *,
        everywhere: bool = True,
    ) -> Detections:
        """Detect people.

        Args:
            grey: (H, W) image; the meaning of greys must not change much within 0.2 s.
            time_s: time of the image.
            odometry: motion of the robot since the last image; None if unknown.
            mount: of the camera; None if unknown, then people are searched for everywhere.
            expected: predicted people with their last cascade scores; the cascade skips their windows.
            everywhere: whether to search the whole image; otherwise only `expected` is rescored.
        """
        self._past.keep(grey, time_s, odometry)
        if not everywhere and len(expected.box) == 0:
            return expected
        return self.detect(grey, self._past.change(mount), mount, expected, everywhere=everywhere)

    def detect(
        self, grey: Grey, change: Grey, mount: Mount | None, expected: Detections, *, everywhere: bool
    ) -> Detections:
        """Detect people in an image (H, W), given the change of its greys (H, W)."""
        first = self.detect_first(grey, change, mount, expected) if everywhere else expected
        with one_thread():  # once for both networks, as each call of the library takes time
            found = rescore(self._rescoring, grey, change, first, mount, self._least_score, self._workspace)
            return refine_boxes(self._box_refinement, grey, change, found, mount, self._workspace)

    def detect_first(self, grey: Grey, change: Grey, mount: Mount | None, known: Detections) -> Detections:
        """Detect people with the cascade, and add the predicted ones."""
        return detect_with_trees(
            self._model, grey, change, mount, self._smallest_px, WEAKEST, known, self._buffer
        )


def detect_with_trees(
    model: PeopleModel,
    grey: Grey,
    change: Grey,
    mount: Mount | None,
    smallest_px: float,
    least_score: float,
    known: Detections = NO_DETECTIONS,
    buffer: Buffer | None = None,
) -> Detections:
    """Run the cascade on an image (H, W), given the change of its greys (H, W).

    Windows of predicted people are skipped, and these people are added to the detections.
    """
    boxes, scores = [known.box], [known.trees]
    for level in pyramid_levels(grey, change, mount, smallest_px, buffer or Buffer()):
        sums = integrate(level.cells)
        is_known = level.covered(known.box, SHARED) if len(known.box) else None
        for kind, trees in model.trees.items():
            for rows in level.rows[kind]:
                hits = trees.cascade.scan(sums, rows, is_known)
                is_sure = hits.score >= least_score
                if not is_sure.any():
                    continue
                hits = hits.take(is_sure)
                if mount is not None:  # without a known mount all windows are evaluated
                    hits = hits.best()
                row, column = hits.row, hits.column
                boxes.append(trees.regression.boxes(sums, row, column, level.boxes(row, column)))
                scores.append(hits.score)
    return suppress(Detections.from_trees(np.concatenate(boxes), np.concatenate(scores)))
