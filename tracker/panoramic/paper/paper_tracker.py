"""One person tracked all round a standing robot, as the OMNIVIS 2003 paper does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PanoramaCalibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import PANORAMA, Frame, check_frame
from peopleboy.tracker.panoramic.panorama_view import choose_view
from peopleboy.tracker.panoramic.paper.depth_cues import (
    CLEAN,
    EMPTY_IMAGES,
    Background,
    Mask,
    MeasuredFigure,
    Subtraction,
    learn_background,
    measure,
)
from peopleboy.tracker.panoramic.paper.distance_network import DistanceModel
from peopleboy.tracker.panoramic.paper.position_filter import (
    PRINTED,
    STEP_S,
    Estimate,
    MotionNoise,
    PositionFilter,
)
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

# What the panoramic tracker believes beyond its track.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramicExplanation:
    """The inner life of the panoramic tracker at its newest image, for those who draw it or ask why.

    Attributes:
        background: what it takes for the empty scene.
        silhouette: (H, W) what differs from that.
        figure: histograms, angle and cues of the person; None while nobody is seen.
        distance_m: what the network makes of the cues [m]; None while nobody is seen.
        estimate: what the filter makes of it, in room coordinates; None while nobody is tracked.
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
        subtraction: how the background is taken away.
        noise: Q and R of the filter; None for those that come with the network.
        uses_velocity: whether the filter predicts by the last estimated step ("the estimated velocity of the
            person is used to predict their next position"), or by none.
        least_px: silhouettes of fewer pixels are nobody.
        forget_s: who is not seen for longer is gone [s].
    """

    subtraction: Subtraction = CLEAN
    noise: MotionNoise | None = PRINTED
    uses_velocity: bool = True
    least_px: int = 8
    forget_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _TrackedPerson:
    """Who is tracked.

    Attributes:
        id, born_s: number, and when the track began [s].
        seen_s: time of the newest image with the person in it [s].
        box: there [px].
        estimate: of the filter then.
    """

    id: int
    born_s: float
    seen_s: float
    box: Box
    estimate: Estimate

    def age_steps(self, time_s: float) -> float:
        """Return how many steps of the filter have gone since the person was last seen."""
        return (time_s - self.seen_s) / STEP_S


class PanoramicPaperTracker:
    """Tracks one person by a silhouette in the panorama, a network for the distance, and a Kalman filter.

    The robot stands, and the first five images must show nobody: they become the background. Who is in them
    becomes part of it, and later leaves a hole, which is taken for a person from then on. Two people at a
    time are taken for one.

    Between two images, and for a while when nobody is seen, the filter only predicts, and the track has no
    box. A person who was gone has a new id; one who takes another's place between two images has not. Room
    coordinates are those of the robot's frame at the start. There are no networks of single persons (section
    6.1), as nothing here identifies the person.

    Args:
        models: one or more appearance models, each for one mirror; that of the camera is taken.
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
        """Refuse another camera than the networks were trained on, before there are images.

        Raises:
            BadInput: it is another, or none that sees all round.
        """
        camera = calibrations.get(PANORAMA)
        if isinstance(camera, PanoramaCalibration):
            self._choose((camera.height, camera.width), camera)
        elif camera is not None:
            raise BadInput(f"camera {PANORAMA!r}: the tracker wants one that sees all round")

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell where the person is, if a person is there.

        Raises:
            BadInput: an image that is none, or of another camera than the networks were trained on.
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
        """Take the network for a camera with images of this size (height, width)."""
        self._model = self._models[choose_view([model.view for model in self._models], size, calibration)]

    @property
    def _filter(self) -> PositionFilter:
        noise = self._model.noise if self.config.noise is None else self.config.noise
        return PositionFilter(noise, self.config.uses_velocity)

    def _look(self, image: NDArray[np.uint8], time_s: float) -> None:
        """See who is in a new image; the first ones become the background."""
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
        """Let the filter know where the person is seen, and tell how far away [m]."""
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
        """Whether the person is in the newest image."""
        return self.explanation is not None and self.explanation.figure is not None
