"""The laser sensor: people on the floor, by their legs in scans of a laser range finder."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, ScanCalibration
from peopleboy.tracker.frame import LASER, Floats, Frame, FreshImages
from peopleboy.tracker.sensors.laser.leg_model import LegDetections, LegModel
from peopleboy.tracker.tracking.config import STATURE_M, USUAL_RATIO, PeopleTrackerConfig
from peopleboy.tracker.tracking.measurement import FloorMeasurement
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    SensorDetections,
    Settings,
    Visibility,
    level_places,
    no_appearance,
)

_HEAD_SD_M: Final = 10.0  # the height of a head is not measured
_CENTRE_M: Final = 0.3  # a person has no width in beams at the range finder itself


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserSensorConfig:
    """Settings of the laser sensor.

    Attributes:
        least: least log-odds of a detection.
        most: greatest log-odds of a detection.
        floor_sd_m: standard deviation of a position near the range finder, by gait.
        range_sd: growth of the deviation with the range.
        farthest_m: greatest range at which a person is expected to be detected [m].
        half_m: half the width of a person's legs [m].
        nearer_m: how much nearer than a person something must be to hide the legs [m].
        beyond_m: how much farther than a person the background must be [m].
        blind: share of hidden beams from which a person cannot be detected.
        certain_m: standard deviation of a prediction below which it can be said that no person is there [m].
    """

    least: float = -2.0
    most: float = 3.0
    floor_sd_m: float = 0.06
    range_sd: float = 0.01
    farthest_m: float = 7.0
    half_m: float = 0.3
    nearer_m: float = 0.4
    beyond_m: float = 0.5
    blind: float = 0.5
    certain_m: float = 0.2


class LaserSensor:
    """Detects people by a learned model of legs in a scan.

    Its boxes are in the scan: from the first beam on a person to the last, and of a person's usual shape.

    Args:
        config: of the sensor.
        tracker: settings of the tracker.
        model: detects people in a scan; None for the shipped one.
    """

    def __init__(
        self,
        config: LaserSensorConfig | None = None,
        tracker: PeopleTrackerConfig | None = None,
        model: LegModel | None = None,
    ) -> None:
        self._config = LaserSensorConfig() if config is None else config
        tracker = PeopleTrackerConfig() if tracker is None else tracker
        self._motion = tracker.motion
        self._settings = Settings(
            tracker.existence_laser, tracker.association_laser, tracker.reidentification
        )
        self._model = LegModel.load() if model is None else model
        self._images = FreshImages(LASER)
        self._found: LegDetections | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The laser range finder."""
        return (LASER,)

    @property
    def explanation(self) -> LegDetections | None:
        """The detections in the last scan; None before the first."""
        return self._found

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse anything but a laser range finder, before the first frame.

        Raises:
            BadInput: the range finder is not calibrated, or is a camera.
        """
        _checked(calibrations)

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        """Detect people in the next scan; None without one.

        Raises:
            BadInput: the scan is invalid.
        """
        if self._images.of(frame) is None:
            return None
        calibration = _checked(frame.calibrations)
        found = self._model.detect(_scan(frame, calibration), calibration)
        is_used = found.scores > self._config.least
        scores = np.minimum(found.scores[is_used], self._config.most)
        self._found = LegDetections(found.places_m[is_used], scores)
        return self._detections(self._found, predicted, calibration)

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Leave boxes to other sensors."""

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Return what hides the legs of each track, and where only the background is there."""
        if LASER not in frame.images or predicted.origin_m is None:
            return None
        config = self._config
        nearer, beyond = self._seen_at(frame, predicted)
        spread = np.sqrt(predicted.states.covariance[:, (0, 2), (0, 2)].max(axis=1, initial=0.0))
        is_absent = (beyond >= 1.0) & (spread < config.certain_m)
        return Visibility(nearer, np.zeros(len(predicted), np.bool_), is_absent)

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the scan; None without a scan."""
        if LASER not in frame.images or predicted.origin_m is None:
            return None
        calibration, places = _checked(frame.calibrations), predicted.places_m
        boxes = self._boxes(places, calibration)
        nearer, _ = self._seen_at(frame, predicted)
        range_m = np.hypot(*(places - calibration.position_m[:2]).T)
        middle = boxes[:, 0] + boxes[:, 2] / 2.0
        is_ahead = (middle > -0.5) & (middle < calibration.beams - 0.5)
        is_near = range_m < self._config.farthest_m
        return ProjectedBoxes(boxes, is_ahead & is_near & (nearer < self._config.blind), is_scan=True)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Remember nothing of tracks."""

    def _seen_at(self, frame: Frame, predicted: Predictions) -> tuple[Floats, Floats]:
        """Return the shares (K,) of the beams at each track that end nearer and that end beyond it.

        Both are NaN for tracks outside the scan.
        """
        config, calibration, places = self._config, _checked(frame.calibrations), predicted.places_m
        scan = _scan(frame, calibration)
        ranges = np.where(scan > 0, scan / 1000.0, np.inf)
        range_m = np.hypot(*(places - calibration.position_m[:2]).T)
        nearer, beyond = np.full((2, len(places)), np.nan)
        for row, (left, _, width, _) in enumerate(self._boxes(places, calibration).tolist()):
            first, last = max(math.ceil(left), 0), min(math.floor(left + width), calibration.beams - 1)
            if first <= last:
                own = ranges[first : last + 1]
                nearer[row] = np.mean(own < range_m[row] - config.nearer_m)
                beyond[row] = np.mean(own > range_m[row] + config.beyond_m)
        return nearer, beyond

    def _boxes(self, places_m: Floats, calibration: ScanCalibration) -> Floats:
        """Return the boxes (K, 4) of people at places (K, 2) in the scan."""
        level = np.full(len(places_m), calibration.position_m[2])
        middle = calibration.project(np.column_stack([places_m, level]))[:, 0]
        range_m = np.maximum(np.hypot(*(places_m - calibration.position_m[:2]).T), _CENTRE_M)
        half = np.arctan(self._config.half_m / range_m) / calibration.step_rad
        height = 2.0 * half / USUAL_RATIO
        return np.column_stack([middle - half, -height / 2.0, 2.0 * half, height])

    def _detections(
        self, found: LegDetections, predicted: Predictions, calibration: ScanCalibration
    ) -> SensorDetections:
        assert predicted.origin_m is not None
        config, origin, count = self._config, predicted.origin_m, len(found.scores)
        range_m = np.hypot(*(found.places_m - calibration.position_m[:2]).T)
        deviation = np.hypot(config.floor_sd_m, config.range_sd * range_m)
        measurement = FloorMeasurement(
            places_m=level_places(found.places_m, origin),
            heads_m=np.full(count, STATURE_M),
            deviations_m=np.column_stack([deviation, deviation, np.full(count, _HEAD_SD_M)]),
            seen_from_m=level_places(np.array([calibration.position_m[:2]]), origin)[0],
            floor_m=origin[2],
            config=self._motion,
        )
        pattern, colours = no_appearance(count)
        return SensorDetections(
            camera=LASER,
            boxes=self._boxes(found.places_m, calibration),
            scores=found.scores,
            measurement=measurement,
            expected=self._boxes(predicted.places_m, calibration),
            pattern=pattern,
            colours=colours,
            has_width=np.zeros(count, np.bool_),
            settings=self._settings,
        )


def _checked(calibrations: Mapping[str, Calibration]) -> ScanCalibration:
    calibration = calibrations.get(LASER)
    if not isinstance(calibration, ScanCalibration):
        raise BadInput(f"camera {LASER!r}: the tracker needs a calibrated laser range finder")
    return calibration


def _scan(frame: Frame, calibration: ScanCalibration) -> NDArray[np.uint16]:
    """Return the ranges (N,) [mm] of a frame."""
    image = frame.depth(LASER)
    if image.shape != (1, calibration.beams):
        raise BadInput(f"{LASER} image must be (1, {calibration.beams}) as calibrated, got {image.shape}")
    return np.asarray(image[0], np.uint16)
