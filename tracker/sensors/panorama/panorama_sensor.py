"""The panorama sensor: people on the floor all around, by learned models of foreground and of patches."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PanoramaCalibration
from peopleboy.geometry.small_matrices import mahalanobis2
from peopleboy.tracker.frame import PANORAMA, Floats, Frame, FreshImages, Odometry
from peopleboy.tracker.networks.weights_archive import SHIPPED
from peopleboy.tracker.sensors.panorama.figure_patch import Map
from peopleboy.tracker.sensors.panorama.panorama_patches import PanoramaScene, person_box, promising_places
from peopleboy.tracker.sensors.panorama.panorama_view import view_of
from peopleboy.tracker.sensors.panorama.people_foreground import Foreground, shipped_foreground
from peopleboy.tracker.sensors.panorama.place_model import FILES, PlaceModel
from peopleboy.tracker.sensors.panorama.resampling import Resampling
from peopleboy.tracker.tracking.appearance import Colours, describe_samples
from peopleboy.tracker.tracking.config import STATURE_M, PeopleTrackerConfig
from peopleboy.tracker.tracking.measurement import FloorMeasurement
from peopleboy.tracker.tracking.motion_filter import StateEstimates
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    SensorDetections,
    Settings,
    Visibility,
    level_places,
    no_appearance,
)

_AROUND: Final = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)], np.float64)
_CENTRE_M: Final = 0.5  # a box has no size at the robot's centre
_HEAD_SD_M: Final = 10.0  # the height of a head is not measured


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaSensorConfig:
    """Settings of the panorama sensor.

    Attributes:
        neutral: the model's log-odds at which a patch is no evidence: furniture that it takes for a person
            scores little above zero.
        least_evidence: log-odds from which a patch shows a person.
        error_share: factor on the model's reported error: the model was trained with more examples than those
            from which its errors were learned.
        common: share of a position's standard deviation that further images of the person do not reduce, as
            it comes from gait and build.
        gate: squared Mahalanobis distance beyond which a detection belongs to another person.
        wide_m: standard deviation of a prediction from which its neighbourhood is searched, too [m].
        reach_m: half-width of that neighbourhood [m].
        blind: covered share of the body from which a person cannot be detected.
        forgotten: log-odds of a track below which it is not searched for.
        newcomers: number of positions searched per image for new people.
        nearest_m: least distance of people [m].
        farthest_m: greatest distance of new people [m].
        tracked_m: the same of tracked people [m].
        apart_m: least distance of a new person from others [m].
        foreground: probability from which a pixel shows a person.
        described: share of a box's width from which colours are taken.
    """

    neutral: float = 2.0
    least_evidence: float = -1.0
    error_share: float = 0.8
    common: float = 0.6
    gate: float = 16.0
    wide_m: float = 0.15
    reach_m: float = 0.3
    blind: float = 0.7
    forgotten: float = -0.4
    newcomers: int = 3
    nearest_m: float = 0.5
    farthest_m: float = 7.0
    tracked_m: float = 7.5
    apart_m: float = 0.4
    foreground: float = 0.5
    described: float = 0.6


@dataclass(frozen=True, slots=True, eq=False)
class PanoramaExplanation:
    """What the sensor makes of the last panorama.

    Attributes:
        background: (H, W, 3) uint8 RGB, the background model.
        foreground: (H, W) foreground probability.
        covered: (H, W) 1 on detected people.
    """

    background: NDArray[np.uint8]
    foreground: Map
    covered: Map


@dataclass(frozen=True, slots=True, eq=False)
class _Located:
    """One detection: log-odds, bearing [rad] and distance [m], deviations along and across [m], colours."""

    evidence: float
    bearing_rad: float
    distance_m: float
    deviation_m: Floats
    colours: Colours

    @property
    def place_m(self) -> Floats:
        """Position (2,) forward and left in the robot frame."""
        return self.distance_m * np.array([math.cos(self.bearing_rad), math.sin(self.bearing_rad)])


class PanoramaSensor:
    """Detects people by a learned model of patches of the panorama, each scaled by its distance.

    People are detected from the nearest to the farthest, and each one's pixels are masked for those behind.
    Images of the default mirror have networks of their own; those of other cameras are resampled.

    Args:
        config: of the sensor.
        tracker: settings of the tracker.
        model: detects people at positions in the panorama of the camera it was trained for; None for the
            shipped one of the default mirror.
    """

    def __init__(
        self,
        config: PanoramaSensorConfig | None = None,
        tracker: PeopleTrackerConfig | None = None,
        model: PlaceModel | None = None,
    ) -> None:
        self._config = PanoramaSensorConfig() if config is None else config
        tracker = PeopleTrackerConfig() if tracker is None else tracker
        self._motion = tracker.motion
        self._settings = Settings(
            tracker.existence_panorama, tracker.association_panorama, tracker.reidentification
        )
        self._model = PlaceModel.load() if model is None else model
        self._foreground = Foreground()
        self._resampling: Resampling | None = None
        self._images = FreshImages(PANORAMA)
        self._camera: PanoramaCalibration | None = None
        self._scene: PanoramaScene | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The panoramic camera."""
        return (PANORAMA,)

    @property
    def explanation(self) -> PanoramaExplanation | None:
        """The state at the newest image; None before the first."""
        if self._scene is None:
            return None
        return PanoramaExplanation(self._foreground.background, self._scene.foreground, self._scene.covered)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a camera that cannot be used, before the first frame.

        Raises:
            BadInput: the camera is not panoramic, too low or too high, or does not show the floor.
        """
        self._checked(calibrations)

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        """Detect people in the next panorama; None without one.

        Raises:
            BadInput: the image is invalid, or of a camera that cannot be used.
        """
        fresh = self._images.of(frame)
        if fresh is None:
            return None
        scene = self._look(fresh)
        found, assigned = self._expected(scene, predicted)
        self._search(scene, found)
        return self._detections(found, assigned, predicted)

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Leave boxes to other sensors."""

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Return how much of each track nearer people cover; None without a panorama."""
        if PANORAMA not in frame.images or self._scene is None:
            return None
        scene, count = self._scene, len(predicted)
        polar = _polar(predicted.places_m)
        hidden = np.array([scene.hidden_share(*one) for one in polar.tolist()])
        return Visibility(hidden, np.zeros(count, bool), np.zeros(count, bool))

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the panorama; None if the camera is unknown."""
        calibration = frame.calibrations.get(PANORAMA)
        if not isinstance(calibration, PanoramaCalibration) or predicted.origin_m is None:
            return None
        polar = _polar(predicted.places_m)
        is_near = polar[:, 1] < self._config.tracked_m
        return ProjectedBoxes(_boxes(polar, calibration), is_near)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Remember nothing of tracks."""

    def _checked(self, calibrations: Mapping[str, Calibration]) -> PanoramaCalibration:
        """Return the camera's calibration; a new camera needs networks for its view."""
        camera = calibrations.get(PANORAMA)
        if not isinstance(camera, PanoramaCalibration):
            raise BadInput(f"camera {PANORAMA!r}: the tracker needs a calibrated panoramic camera")
        if camera != self._camera:
            self._resampling = None
            if self._model.view.refusal(view_of(camera, camera.width, camera.height)):
                self._resampling = Resampling.of(camera)
                self._model = PlaceModel.load(SHIPPED / FILES["all-round"])
                self._foreground = Foreground(shipped_foreground("all-round"))
            self._camera = camera
        return camera

    def _look(self, frame: Frame) -> PanoramaScene:
        """Separate people from background in a new panorama."""
        image, calibration = frame.rgb(PANORAMA), self._checked(frame.calibrations)
        if image.shape[:2] != (calibration.height, calibration.width):
            given, known = f"{image.shape[1]}x{image.shape[0]}", f"{calibration.width}x{calibration.height}"
            raise BadInput(
                f"camera {PANORAMA!r}: must have the size of its calibration, {known}, got {given}"
            )
        rows = None
        if self._resampling is not None:
            image, rows = self._resampling.image(image), self._resampling.rows
            calibration = self._resampling.calibration
        foreground = self._foreground.update(image, frame.time_s, frame.odometry or Odometry(), calibration)
        self._scene = PanoramaScene.of(image, foreground, self._foreground.novelty, calibration, rows)
        return self._scene

    def _expected(
        self, scene: PanoramaScene, predicted: Predictions
    ) -> tuple[list[_Located], dict[int, int]]:
        """Detect the tracked people, the nearest first; return them, and the indices by row."""
        found: list[_Located] = []
        assigned: dict[int, int] = {}
        if not len(predicted):
            return found, assigned
        places = predicted.places_m
        polar = _polar(places)
        for row in np.argsort(polar[:, 1], kind="stable").tolist():
            is_forgotten = predicted.log_odds[row] <= self._config.forgotten
            if is_forgotten or polar[row, 1] > self._config.tracked_m:
                continue
            if scene.hidden_share(*polar[row].tolist()) >= self._config.blind:
                continue
            spread = _spread(predicted.states, row)
            near = places[row][None]
            wide = math.sqrt(float(np.trace(spread)) / 2.0)
            if wide > self._config.wide_m:
                near = near + min(wide, self._config.reach_m) * _AROUND
            one = self._at(scene, _polar(near))
            if one is None:
                continue
            off = one.place_m - places[row]
            if mahalanobis2(off, spread + _error(one)) < self._config.gate:
                assigned[row] = len(found)
                found.append(one)
                scene.cover(one.bearing_rad, one.distance_m)
        return found, assigned

    def _search(self, scene: PanoramaScene, found: list[_Located]) -> None:
        """Search for untracked people."""
        for polar in promising_places(scene.figures, self._config.newcomers):
            one = self._at(scene, polar[None])
            if one is None or one.distance_m > self._config.farthest_m:
                continue
            if any(math.dist(one.place_m, other.place_m) < self._config.apart_m for other in found):
                continue
            found.append(one)
            scene.cover(one.bearing_rad, one.distance_m)

    def _at(self, scene: PanoramaScene, polar: Floats) -> _Located | None:
        """Search positions (N, 2), bearing and distance, and refine the best; None if there is no person."""
        first = self._best(scene, polar)
        if first is None:
            return None
        one = self._best(scene, np.array([first[:2]]))
        if one is None or one[2] < self._config.least_evidence:
            return None
        bearing, distance, evidence, deviation = one
        return _Located(evidence, bearing, distance, deviation, self._describe(scene, bearing, distance))

    def _best(self, scene: PanoramaScene, polar: Floats) -> tuple[float, float, float, Floats] | None:
        reported = self._model.look(scene.figures.patches(polar[:, 0], polar[:, 1]), polar[:, 1])
        best = int(np.argmax(reported.evidence))
        along, across = reported.offset_m[best].tolist()
        bearing, distance = polar[best].tolist()
        if distance + along < self._config.nearest_m:
            return None
        bearing, distance = bearing + across / distance, distance + along
        deviation = self._config.error_share * reported.deviation_m[best].astype(np.float64)
        return bearing, distance, float(reported.evidence[best]), deviation

    def _describe(self, scene: PanoramaScene, bearing_rad: float, distance_m: float) -> Colours:
        """Return the colours (FEATURES,) of the person at a position, from uncovered foreground pixels."""
        left, top, width, height = scene.box(bearing_rad, distance_m)
        inset = (1.0 - self._config.described) / 2.0 * width
        rows = np.arange(max(round(top), 0), min(round(top + height), scene.image.shape[0]))
        columns = np.arange(round(left + inset), round(left + width - inset) + 1) % scene.image.shape[1]
        at = np.ix_(rows, columns)
        v, u = np.nonzero((scene.foreground[at] > self._config.foreground) & (scene.covered[at] == 0.0))
        return describe_samples(scene.image[at][v, u], (rows[v] + 0.5 - top) / height)

    def _detections(
        self,
        found: Sequence[_Located],
        assigned: Mapping[int, int],
        predicted: Predictions,
    ) -> SensorDetections:
        assert predicted.origin_m is not None
        assert self._camera is not None
        origin = predicted.origin_m
        at = np.array([one.place_m for one in found]).reshape(-1, 2)
        along, across = np.array([one.deviation_m for one in found]).reshape(-1, 2).T
        pattern, colours = no_appearance(len(found))
        for number, one in enumerate(found):
            colours[number] = one.colours
        measurement = FloorMeasurement(
            places_m=level_places(at, origin),
            heads_m=np.full(len(found), STATURE_M),
            deviations_m=np.column_stack([across, along, np.full(len(found), _HEAD_SD_M)]),
            seen_from_m=level_places(np.zeros((1, 2)), origin)[0],
            floor_m=origin[2],
            config=self._motion,
        )
        return SensorDetections(
            camera=PANORAMA,
            boxes=_boxes(_polar(at), self._camera),
            scores=np.array([one.evidence for one in found]) - self._config.neutral,
            measurement=measurement,
            expected=_boxes(_polar(predicted.places_m), self._camera),
            pattern=pattern,
            colours=colours,
            assigned=assigned,
            has_width=np.zeros(len(at), np.bool_),
            is_masked=True,
            common_m=self._config.common * np.column_stack([across, along]),
            settings=self._settings,
        )


def _error(one: _Located) -> Floats:
    """Return the covariance (2, 2) of a position in the robot frame."""
    cosine, sine = math.cos(one.bearing_rad), math.sin(one.bearing_rad)
    axes = np.array([[cosine, -sine], [sine, cosine]])
    return np.asarray((axes * one.deviation_m**2) @ axes.T)


def _spread(states: StateEstimates, row: int) -> Floats:
    """Return the covariance (2, 2) of a predicted position in the robot frame."""
    covariance = states.covariance[row]
    forward, aside, both = covariance[2, 2], covariance[0, 0], -covariance[0, 2]
    return np.array([[forward, both], [both, aside]])


def _polar(places_m: Floats) -> Floats:
    """Return bearings [rad] and distances [m] (K, 2) of positions (K, 2) in the robot frame."""
    x, y = places_m.T
    return np.column_stack([np.arctan2(y, x), np.maximum(np.hypot(x, y), _CENTRE_M)])


def _boxes(polar: Floats, calibration: PanoramaCalibration) -> Floats:
    return np.array(
        [person_box(bearing, distance, calibration) for bearing, distance in polar.tolist()]
    ).reshape(-1, 4)
