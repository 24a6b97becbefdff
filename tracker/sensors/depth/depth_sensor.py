"""The depth sensor: objects of human size in the depth image, classified by shape, colour and warmth."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Floats, Frame, FreshImages
from peopleboy.tracker.sensors.depth.depth_view import DepthView, LevelView, RgbdView, box_at
from peopleboy.tracker.sensors.depth.depth_visibility import (
    depth_visibility,
    describe_readings,
    find_torso,
    surface_m,
    view_of,
    warmth,
)
from peopleboy.tracker.sensors.depth.guided_search import GuidedMeasurement, search_near
from peopleboy.tracker.sensors.depth.human_windows import WindowRange, range_of, window_of
from peopleboy.tracker.sensors.depth.pre_detection import (
    HumanSize,
    Layout,
    PreDetection,
    PreDetector,
    body_position,
)
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from peopleboy.tracker.sensors.depth.window_model import WindowModel, shipped_windows
from peopleboy.tracker.track import Box
from peopleboy.tracker.tracking.config import (
    STATURE_M,
    USUAL_RATIO,
    KalmanConfig,
    PeopleTrackerConfig,
)
from peopleboy.tracker.tracking.measurement import FloorMeasurement
from peopleboy.tracker.tracking.motion_filter import predicted_boxes
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    SensorDetections,
    Settings,
    Visibility,
    level_places,
    no_appearance,
    project_boxes,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint

_SHOULDERS_M: Final = 0.48  # width that the search near a prediction expects
WIDE_M: Final = 0.42
_BORDER: Final = 0.02  # share of the rows at the top of the image: an object there reaches beyond it
_HEADLESS: Final = -0.6  # least log-odds of an object whose head is outside the image: no new person
_UNSEEN_SD_M: Final = 1.0  # standard deviation of the height of a head outside the image


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthSensorConfig:
    """Settings of the depth sensor.

    Attributes:
        size: expected size of a person.
        above: settings of the view from above.
        body_m: [m] from the visible surface to the middle of the body.
        floor_sd_m: standard deviation of a position, by gait.
        depth_sd: [1/m] growth of the deviation along the line of sight with the squared distance.
        narrow: growth of the deviation across for each metre that an object is narrower than a person.
        head_sd_m: standard deviation of the height of the head.
        score_gain: log-odds for a unit of a window's score.
        neutral_far, neutral_near: score of a window at log-odds 0.
        most: greatest log-odds of a window.
        warm: log-odds of an object that is as warm as a person.
        cold: log-odds of one that is not.
        least_warm: least share of warm pixels of a person.
        guided_sd_m: standard deviation of a position found near a prediction.
        guided_score: its greatest log-odds.
        guided_warm: least share of warm pixels of a person found near a prediction.
        own_m: [m] from a prediction, within which a detection makes the guided search superfluous.
        crowded_m: [m] in depth and to the side, within which the shoulders of two people merge.
        seen_through: share of readings behind a track, from which there is no person,
        certain_m: if the deviation of its position is less.
        own_share: share of readings at a track from which it is still there.
        torso: width of the torso without arms, as a share of the stature, by that of its rows in the depth
            image: gain and offset.
        torso_sd_m: standard deviation of the middle of a visible torso across the line of sight.
    """

    size: HumanSize = field(default_factory=HumanSize)
    above: UDepthConfig = field(default_factory=UDepthConfig)
    body_m: float = 0.095
    floor_sd_m: float = 0.06
    depth_sd: float = 0.003
    narrow: float = 0.6
    head_sd_m: float = 0.15
    score_gain: float = 1.5
    neutral_far: float = 0.5
    neutral_near: float = 0.2
    most: float = 3.0
    warm: float = 1.0
    cold: float = -4.0
    least_warm: float = 0.15
    guided_sd_m: float = 0.1
    guided_score: float = 1.0
    guided_warm: float = 0.25
    own_m: float = 0.4
    crowded_m: tuple[float, float] = (0.5, 0.7)
    seen_through: float = 0.7
    certain_m: float = 0.3
    own_share: float = 0.08
    torso: tuple[float, float] = (0.65, 0.08)
    torso_sd_m: float = 0.04


@dataclass(frozen=True, slots=True, eq=False)
class DepthExplanation:
    """The detections of the last depth image.

    Attributes:
        layout: structure of the depth image, as a level camera sees it.
        boxes: (N, 4) [px] of the objects of human size in the depth image.
        places_m: (M, 2) forward and left in the robot frame.
        scores: (M,) log-odds.
    """

    layout: Layout
    boxes: Floats
    places_m: Floats
    scores: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """One detection: position in the robot frame, height, deviations, log-odds and width of the torso.

    The width is a share of the height; NaN if it is unknown.
    """

    place_m: Floats
    head_m: float
    deviation_m: tuple[float, float, float]
    score: float
    ratio: float = math.nan


class DepthSensor:
    """Detects people by size in the depth image, and by a classifier of windows in depth and colour.

    Where the thermal camera shows the same object, its warmth is further evidence. A partly occluded person
    is also searched for near the prediction.

    Args:
        config: of the sensor.
        tracker: settings of the tracker.
        model: classifies windows; None for the shipped one.
    """

    def __init__(
        self,
        config: DepthSensorConfig | None = None,
        tracker: PeopleTrackerConfig | None = None,
        model: WindowModel | None = None,
    ) -> None:
        self._config = DepthSensorConfig() if config is None else config
        tracker = PeopleTrackerConfig() if tracker is None else tracker
        self._motion: KalmanConfig = tracker.motion
        self._settings = Settings(
            tracker.existence_depth, tracker.association_depth, tracker.reidentification
        )
        self._model = shipped_windows(sees_depth=True) if model is None else model
        self._detector = PreDetector(self._config.size, self._config.above)
        self._images = FreshImages(DEPTH)
        self._shape: tuple[int, int] | None = None
        self._level: tuple[Frame, LevelView, Frame] | None = None
        self._explanation: DepthExplanation | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The depth camera, which also has colour."""
        return (DEPTH,)

    @property
    def explanation(self) -> DepthExplanation | None:
        """The detections of the last image; None before the first."""
        return self._explanation

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse an unusable depth camera before the first frame.

        Raises:
            BadInput: the camera is not calibrated, or not planar.
        """
        DepthView.of(calibrations.get(DEPTH), DEPTH)

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        """Detect people in the next depth image; None without one.

        Raises:
            BadInput: an image is invalid, or the camera is not calibrated.
        """
        if self._images.of(frame) is None:
            return None
        _check_sizes(frame)
        level, seen = self._levelled(frame)
        view = self._view(seen)
        layout = self._detector(view.depth, view.geometry)
        found = [self._classified(one, layout, view, seen, predicted) for one in layout.detections]
        assigned: dict[int, int] = {}
        for row, near in self._guided(predicted, found, layout, view, seen).items():
            assigned[row] = len(found)
            found.append(near)
        self._explanation = DepthExplanation(
            layout,
            level.boxes_in_image(np.array([one.box for one in layout.detections]).reshape(-1, 4)),
            np.array([one.place_m for one in found]).reshape(-1, 2),
            np.array([one.score for one in found]),
        )
        return self._detections(found, assigned, predicted, frame)

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Leave boxes to other sensors."""

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the depth image; None if the camera is unknown."""
        calibration = frame.calibrations.get(DEPTH)
        if calibration is None or predicted.origin_m is None or self._shape is None:
            return None
        view = Viewpoint.of(calibration, self._shape, predicted.origin_m, self._motion.toe_m)
        return project_boxes(predicted, view, self._shape)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Remember nothing of tracks."""

    def _levelled(self, frame: Frame) -> tuple[LevelView, Frame]:
        """Return the view of a level camera, and the frame as it sees it."""
        if self._level is None or self._level[0] is not frame:
            rows, columns = self._shape = frame.depth(DEPTH).shape
            view = LevelView.of(
                DepthView.of(frame.calibrations.get(DEPTH), DEPTH).calibration, (rows, columns)
            )
            self._level = frame, view, view.transform_frame(frame)
        return self._level[1:]

    def _view(self, frame: Frame) -> RgbdView:
        geometry = DepthView.of(frame.calibrations[DEPTH], DEPTH)
        return RgbdView(frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR), geometry, self._config.body_m)

    def _classified(
        self, found: PreDetection, layout: Layout, view: RgbdView, frame: Frame, predicted: Predictions
    ) -> _Found:
        """Classify an object of human size."""
        geometry = view.geometry
        ground = layout.floor.slope * found.z_m + layout.floor.offset_m
        tall_m = ground - (found.box[1] - geometry.centre_v) * found.z_m / geometry.focal_px
        log_odds = self._window_log_odds(found.box, found.z_m, layout, view)
        head_sd_m = self._config.head_sd_m
        if found.box[1] <= _BORDER * len(view.depth):
            tall_m = max(tall_m, self._stature_at(body_position(found, view), predicted))
            found = _extended(found, (tall_m - ground) * geometry.focal_px / found.z_m - geometry.centre_v)
            whole = self._window_log_odds(found.box, found.z_m, layout, view)
            log_odds, head_sd_m = max(log_odds, whole, _HEADLESS), _UNSEEN_SD_M
        return self._measured(found, tall_m, head_sd_m, log_odds + self._warmth(found, frame), view)

    def _stature_at(self, place_m: Floats, predicted: Predictions) -> float:
        """Return the stature [m] of the track at a position (2,), or the usual one if there is none."""
        away = np.hypot(*(predicted.places_m - place_m).T)
        if not len(away) or away.min() > self._config.own_m:
            return STATURE_M
        return STATURE_M * math.exp(float(predicted.states.mean[away.argmin(), 6]))

    def _window_log_odds(self, box: Box, z_m: float, layout: Layout, view: RgbdView) -> float:
        """Classify the window of a person with a box [px] at a depth."""
        config, geometry = self._config, view.geometry
        kind = range_of(z_m, layout.floor, geometry, len(view.depth))
        window = window_of(box, z_m, kind, layout.floor, geometry)
        score = self._model.look(view.colour, view.depth, z_m, window, kind)
        neutral = config.neutral_far if kind is WindowRange.FAR else config.neutral_near
        return min(max(config.score_gain * (score - neutral), -config.most), config.most)

    def _measured(
        self, found: PreDetection, tall_m: float, head_sd_m: float, log_odds: float, view: RgbdView
    ) -> _Found:
        """Measure the position and the width of a person [m] tall, by the torso if it is visible."""
        config, geometry = self._config, view.geometry
        height_px = tall_m * geometry.focal_px / found.z_m
        torso = find_torso(found, height_px, view.depth)
        if torso is None:
            narrow = max(config.size.width_m - config.size.width_sd_m / 2.0 - found.width_m, 0.0)
            across, ratio = math.hypot(config.floor_sd_m, config.narrow * narrow), math.nan
        else:
            across, ratio = config.torso_sd_m, config.torso[0] * torso.width_px / height_px + config.torso[1]
            x_m = (torso.middle_px - geometry.centre_u) * found.z_m / geometry.focal_px
            found = replace(found, x_m=x_m)
        along = math.hypot(config.floor_sd_m, config.depth_sd * found.z_m**2)
        return _Found(
            place_m=body_position(found, view),
            head_m=tall_m,
            deviation_m=(across, along, head_sd_m),
            score=log_odds,
            ratio=ratio,
        )

    def _warmth(self, found: PreDetection, frame: Frame) -> float:
        """Return the log-odds that an object's warmth adds; 0 where the thermal camera does not show it."""
        warm = warmth(found, frame)
        if warm is None:
            return 0.0
        return self._config.cold if warm < self._config.least_warm else self._config.warm

    def _guided(
        self, predicted: Predictions, found: Sequence[_Found], layout: Layout, view: RgbdView, frame: Frame
    ) -> dict[int, _Found]:
        """Search near the confirmed tracks that have no detection, by row."""
        config, places = self._config, predicted.places_m
        near: dict[int, _Found] = {}
        for row in np.flatnonzero(predicted.is_confirmed).tolist():
            place = places[row]
            if any(math.dist(one.place_m, place) < config.own_m for one in found):
                continue
            off = np.abs(places - place)
            is_close = (off[:, 0] < config.crowded_m[0]) & (off[:, 1] < config.crowded_m[1])
            is_close[row] = False
            if is_close.any():
                continue
            tall = STATURE_M * math.exp(float(predicted.states.mean[row, 6]))
            seen = search_near(place, _SHOULDERS_M, tall, frame)
            if seen is None or (seen.warm is not None and seen.warm < config.guided_warm):
                continue
            deviation = (config.guided_sd_m, config.guided_sd_m, _UNSEEN_SD_M)
            near[row] = _Found(seen.place_m, tall, deviation, self._guided_score(seen, tall, layout, view))
        return near

    def _guided_score(self, seen: GuidedMeasurement, tall_m: float, layout: Layout, view: RgbdView) -> float:
        """Return the log-odds of a person [m] tall found near a prediction.

        Where no thermal image shows that the person is warm, the window is classified: a wall or a cupboard
        beside a person may have the width of one.
        """
        if seen.warm is not None:
            return self._config.guided_score
        box = box_at(view.geometry, seen.place_m, _SHOULDERS_M, tall_m)
        z_m = surface_m(view.geometry, seen.place_m)
        return min(self._window_log_odds(box, z_m, layout, view), self._config.guided_score)

    def _detections(
        self,
        found: Sequence[_Found],
        assigned: Mapping[int, int],
        predicted: Predictions,
        frame: Frame,
    ) -> SensorDetections:
        assert predicted.origin_m is not None
        assert self._shape is not None
        origin, (level, seen) = predicted.origin_m, self._levelled(frame)
        at = np.array([one.place_m for one in found]).reshape(-1, 2)
        heads = np.array([one.head_m for one in found])
        view, upright = (
            Viewpoint.of(each, self._shape, origin, self._motion.toe_m)
            for each in (frame.calibrations[DEPTH], level.calibration)
        )
        measurement = FloorMeasurement(
            places_m=level_places(at, origin),
            heads_m=heads,
            deviations_m=np.array([one.deviation_m for one in found]).reshape(-1, 3),
            seen_from_m=view.at_m[[0, 2]],
            floor_m=origin[2],
            config=self._motion,
        )
        pattern, colours = no_appearance(len(found))
        for number, one in enumerate(found):
            colours[number] = describe_readings(seen, one.place_m, one.head_m)
        expected = predicted_boxes(predicted.states, view, predicted.ratio)
        ratios = np.array([one.ratio for one in found])
        has_width = ~np.isnan(ratios)
        ratios[~has_width] = USUAL_RATIO
        upright_boxes = measurement_boxes(measurement, upright, ratios)
        ratios *= _ratios(level.boxes_in_image(upright_boxes)) / _ratios(upright_boxes)
        ratios[list(assigned.values())] = predicted.ratio[list(assigned)]
        boxes = measurement_boxes(measurement, view, ratios)
        return SensorDetections(
            camera=DEPTH,
            boxes=boxes,
            scores=np.array([one.score for one in found]),
            measurement=measurement,
            expected=expected,
            pattern=pattern,
            colours=colours,
            assigned=assigned,
            is_search=True,
            has_width=has_width,
            is_masked=True,
            settings=self._settings,
        )

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Read the depth image at each track; None without one."""
        if view_of(frame) is None or predicted.origin_m is None:
            return None
        _, frame = self._levelled(frame)
        places = predicted.places_m
        count, config = len(places), self._config
        hidden, is_present, is_absent = np.full(count, np.nan), np.zeros(count, bool), np.zeros(count, bool)
        for row, place in enumerate(places):
            tall = STATURE_M * math.exp(float(predicted.states.mean[row, 6]))
            seen = depth_visibility(place, WIDE_M, tall, frame)
            if seen is None:
                continue
            hidden[row] = seen.nearer
            is_warm = seen.warm is None or seen.warm >= config.least_warm
            is_present[row] = is_warm and 1.0 - seen.nearer - seen.beyond > config.own_share
            is_certain = predicted.states.covariance[row, 2, 2] < config.certain_m**2
            is_absent[row] = is_certain and seen.beyond > config.seen_through
        return Visibility(hidden, is_present, is_absent)


def _extended(found: PreDetection, above_px: float) -> PreDetection:
    """Return an object whose box begins so many rows above the image."""
    left, top, width, height = found.box
    return replace(found, box=(left, -above_px, width, height + top + above_px))


def _ratios(boxes: Floats) -> Floats:
    """Return the widths (M,) of boxes (M, 4), in heights."""
    return np.asarray(boxes[:, 2] / boxes[:, 3])


def _check_sizes(frame: Frame) -> None:
    depth, colour = frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
    if depth.shape != colour.shape[:2]:
        sizes = f"{depth.shape} and {colour.shape[:2]}"
        raise BadInput(f"{DEPTH} and {DEPTH_COLOUR} must show the same pixels, got {sizes}")


def measurement_boxes(measurement: FloorMeasurement, view: Viewpoint, ratios: Floats) -> Floats:
    """Return the boxes (M, 4) [px] of people at measured positions, of widths (M,) in heights."""
    states = measurement.initiate(range(len(ratios)))
    states.mean[:, 6] = np.log(np.maximum(measurement.heads_m, 0.5) / STATURE_M)
    return predicted_boxes(states, view, ratios)
