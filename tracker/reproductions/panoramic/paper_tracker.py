"""The tracker of one person around a standing robot of the OMNIVIS 2003 paper."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PanoramaCalibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import PANORAMA, Frame, check_frame
from peopleboy.tracker.reproductions.panoramic.depth_cues import (
    CLEAN,
    EMPTY_IMAGES,
    Background,
    Mask,
    MeasuredFigure,
    Subtraction,
    learn_background,
    measure,
)
from peopleboy.tracker.reproductions.panoramic.distance_network import DistanceModel
from peopleboy.tracker.reproductions.panoramic.position_filter import (
    PRINTED,
    STEP_S,
    Estimate,
    MotionNoise,
    PositionFilter,
)
from peopleboy.tracker.sensors.panorama.panorama_view import choose_view
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

# Explanation of the panoramic tracker.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramicExplanation:
    """State of the panoramic tracker at its newest image, for plots and analysis.

    Attributes:
        background: background of the empty scene.
        silhouette: (H, W) foreground mask.
        figure: histograms, bearing and cues of the person; None if nobody is detected.
        distance_m: output of the network [m]; None if nobody is detected.
        estimate: of the filter, in room coordinates; None if nobody is tracked.
    """

    background: Background
    silhouette: Mask
    figure: MeasuredFigure | None = None
    distance_m: float | None = None
    estimate: Estimate | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramicConfig:
    """Settings of the panoramic tracker.

    Attributes:
        subtraction: settings of the background subtraction.
        noise: Q and R of the filter; None for those of the network.
        uses_velocity: whether the filter predicts with the last estimated step ("the estimated velocity of
            the person is used to predict their next position"), or with none.
        least_px: silhouettes with fewer pixels are ignored.
        forget_s: time without a detection after which the track is deleted [s].
    """

    subtraction: Subtraction = CLEAN
    noise: MotionNoise | None = PRINTED
    uses_velocity: bool = True
    least_px: int = 8
    forget_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _TrackedPerson:
    """State of the track.

    Attributes:
        id, born_s: id, and start of the track [s].
        seen_s: time of the last image with a detection [s].
        box: in that image [px].
        estimate: of the filter at that time.
    """

    id: int
    born_s: float
    seen_s: float
    box: Box
    estimate: Estimate

    def age_steps(self, time_s: float) -> float:
        """Return the number of filter steps since the last detection."""
        return (time_s - self.seen_s) / STEP_S


class PanoramicPaperTracker:
    """Tracks one person by a silhouette in the panorama, a network for the distance, and a Kalman filter.

    The robot must stand, and the first five images must be empty: they become the background. A person in
    them becomes part of it, and leaving causes a permanent false detection. Two people at a time are detected
    as one.

    Without a new image or a detection, the filter only predicts, and the track has no box. A person who was
    away too long gets a new id; one who replaces another between two images does not. Room coordinates are
    those of the robot frame at the start. There are no networks for individual people (section 6.1), as
    people are not identified.

    Args:
        models: one or more distance models, each for one mirror; the one for the camera is used.
        config: settings.

    Source: OMNIVIS 2003, sections 4 and 5.
    """

    def __init__(self, models: Sequence[DistanceModel], config: PanoramicConfig | None = None) -> None:
        self.config = PanoramicConfig() if config is None else config
        self._models = tuple(models)
        self._model = self._models[0]
        self._pose = Pose2()
        self._empty: list[NDArray[np.uint8]] = []
        self._background: Background | None = None
        self._person: _TrackedPerson | None = None
        self._newest_id = 0
        self.explanation: PanoramicExplanation | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The panoramic camera."""
        return (PANORAMA,)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a camera that the networks were not trained on, before the first frame.

        Raises:
            BadInput: another camera, or one that is not panoramic.
        """
        camera = calibrations.get(PANORAMA)
        if isinstance(camera, PanoramaCalibration):
            self._choose((camera.height, camera.width), camera)
        elif camera is not None:
            raise BadInput(f"camera {PANORAMA!r}: the tracker needs a panoramic camera")

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the track, if there is one.

        Raises:
            BadInput: the image is invalid, or of a camera that the networks were not trained on.
        """
        check_frame(frame)
        if frame.odometry is not None:
            self._pose = self._pose.integrate(frame.odometry.motion)
        if PANORAMA in frame.images:
            image = frame.rgb(PANORAMA)
            self._choose(image.shape[:2], frame.calibrations.get(PANORAMA))
            self._look(image, frame.time_s)
        if self._person is None or frame.time_s - self._person.seen_s > self.config.forget_s:
            self._person = None
            return ()
        return (self._track(self._person, frame.time_s),)

    def _choose(self, size: tuple[int, int], calibration: Calibration | None) -> None:
        """Select the network for a camera with images of this size (height, width)."""
        self._model = self._models[choose_view([model.view for model in self._models], size, calibration)]

    @property
    def _filter(self) -> PositionFilter:
        noise = self._model.noise if self.config.noise is None else self.config.noise
        return PositionFilter(noise, self.config.uses_velocity)

    def _look(self, image: NDArray[np.uint8], time_s: float) -> None:
        """Process a new image; the first ones become the background."""
        if self._background is None:
            self._empty.append(image)
            if len(self._empty) == EMPTY_IMAGES:
                self._background = learn_background(self._empty, self.config.subtraction)
                self._empty.clear()
            return
        silhouette = self._background.silhouette(image)
        figure = measure(silhouette, self.config.least_px)
        distance_m = None if figure is None else self._meet(figure, time_s)
        self.explanation = PanoramicExplanation(
            background=self._background,
            silhouette=silhouette,
            figure=figure,
            distance_m=distance_m,
            estimate=None if self._person is None else self._person.estimate,
        )

    def _meet(self, figure: MeasuredFigure, time_s: float) -> float:
        """Update the filter with a detection, and return the distance [m]."""
        distance_m = float(self._model.network.predict(np.array([figure.cues]))[0])
        place = self._pose.transform_polar(distance_m, figure.bearing_rad)
        before = self._person
        if before is None or time_s - before.seen_s > self.config.forget_s:
            self._newest_id += 1
            born_s, estimate = time_s, self._filter.start(place)
        else:
            born_s = before.born_s
            estimate = self._filter.update(before.estimate, place, before.age_steps(time_s))
        self._person = _TrackedPerson(
            id=self._newest_id, born_s=born_s, seen_s=time_s, box=figure.box, estimate=estimate
        )
        return distance_m

    def _track(self, person: _TrackedPerson, time_s: float) -> Track:
        believed = self._filter.predict(person.estimate, person.age_steps(time_s))
        x, y = self._pose.points_to_local(believed.position_m).tolist()
        (xx, xy), (_, yy) = self._pose.covariance_to_local(believed.covariance_m2).tolist()
        return Track(
            id=person.id,
            boxes={PANORAMA: person.box} if person.seen_s == time_s else {},
            place=FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy)),
            confidence=1.0,
            status=Status.TRACKED if self._is_seen else Status.TOTALLY_OCCLUDED,
            age_s=time_s - person.born_s,
        )

    @property
    def _is_seen(self) -> bool:
        """Whether the person is detected in the newest image."""
        return self.explanation is not None and self.explanation.figure is not None
