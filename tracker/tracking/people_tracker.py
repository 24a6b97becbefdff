"""The people tracker: detections of one or several sensors become lasting tracks."""

from collections.abc import Mapping, Sequence

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.frame import Frame, check_frame, lacking, time_step
from peopleboy.tracker.track import Box, Track
from peopleboy.tracker.tracking.camera_motion import CameraMotion
from peopleboy.tracker.tracking.config import PeopleTrackerConfig
from peopleboy.tracker.tracking.people_gallery import PeopleGallery
from peopleboy.tracker.tracking.sensor import (
    ProjectedBoxes,
    Sensor,
    SensorExplanations,
    Settings,
    project_boxes,
)
from peopleboy.tracker.tracking.sensor_update import SensorUpdate
from peopleboy.tracker.tracking.track_output import output_tracks
from peopleboy.tracker.tracking.tracks import Tracks
from peopleboy.tracker.tracking.viewpoint import Position, Viewpoint


class PeopleTracker:
    """Tracks people in metres around the robot by the detections of its sensors.

    In each frame, every sensor with a new image updates the tracks in turn. A track is confirmed by
    accumulated evidence, and identities are resolved late.

    Args:
        sensors: detect people; the first one's camera is the origin of the level frame.
        config: settings of the filter and of the tracks.
        optional: further sensors, each used if the robot carries its camera.
        shown_in: further planar cameras in whose images tracks have boxes, if these are calibrated.
    """

    def __init__(
        self,
        sensors: Sequence[Sensor],
        config: PeopleTrackerConfig | None = None,
        optional: Sequence[Sensor] = (),
        shown_in: Sequence[str] = (),
    ) -> None:
        self._sensors, self._optional = tuple(sensors), tuple(optional)
        self._shown_in = tuple(shown_in)
        self._config = PeopleTrackerConfig() if config is None else config
        self._introduced: Box | None = None
        self._tracks = Tracks()
        self._last_s: float | None = None
        self._sensed_s: dict[str, float] = {}
        self._settings: Settings | None = None
        self._motion = CameraMotion()

    @property
    def cameras(self) -> tuple[str, ...]:
        """The required cameras: those of all sensors but the optional ones."""
        return tuple(dict.fromkeys(camera for sensor in self._sensors for camera in sensor.cameras))

    @property
    def explanation(self) -> object:
        """The explanation of the sensor, or of each."""
        parts = tuple(sensor.explanation for sensor in self._sensors)
        return parts[0] if len(parts) == 1 else SensorExplanations(parts)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse unsuitable cameras, by name, before the first frame.

        Raises:
            BadInput: a camera is unsuitable.
        """
        for sensor in (*self._sensors, *self._mounted(calibrations)):
            sensor.check_cameras(calibrations)

    def use_gallery(self, gallery: PeopleGallery) -> None:
        """Recognise the people of a gallery, and keep it up to date; call it before the first frame."""
        self._tracks.gallery = gallery

    def introduce(self, box: Box) -> None:
        """Report that a person is at this box [px] in the next frame, as for single-object trackers."""
        self._introduced = box

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks.

        Raises:
            BadInput: the time does not increase, an image is invalid, or none of the sensors has one.
        """
        check_frame(frame)
        if self._last_s is None:
            self._sensors += self._mounted(frame.calibrations)
        self._check_images(frame)
        dt_s = time_step(frame.time_s, self._last_s)
        self._last_s = frame.time_s
        self._tracks.origin_m = self._origin(frame)
        before = self._tracks.predict(dt_s, self._motion.update(frame), self._config.motion)
        update = SensorUpdate(self._tracks, frame, dt_s, self._config)
        for sensor in self._sensors:
            detections = sensor.detect(frame, self._tracks.predictions())
            if detections is not None:
                update.add(sensor, detections, self._time_since_image(detections.camera, frame.time_s))
                self._settings = detections.settings
        update.finish(self._sensors, before)
        self._initiate_introduced(frame)
        if self._settings is None:
            return ()
        self._tracks.settle(frame.time_s, self._settings.reidentification)
        return output_tracks(self._tracks, self._images(frame), frame.time_s, self._config.motion.shown)

    def _mounted(self, calibrations: Mapping[str, Calibration]) -> tuple[Sensor, ...]:
        """Return the optional sensors whose cameras are there."""
        return tuple(one for one in self._optional if one.cameras[0] in calibrations)

    def _check_images(self, frame: Frame) -> None:
        """Refuse a frame without an image of any sensor, except between the images of slower cameras."""
        is_first = self._settings is None
        if is_first and frame.images and not any(one.cameras[0] in frame.images for one in self._sensors):
            raise BadInput(lacking(self._sensors[0].cameras[0], frame.images))

    def _time_since_image(self, camera: str, time_s: float) -> float:
        last_s, self._sensed_s[camera] = self._sensed_s.get(camera), time_s
        return time_step(time_s, last_s)

    def _origin(self, frame: Frame) -> Position | None:
        """Return the position of the first calibrated camera."""
        known = (frame.calibrations.get(sensor.cameras[0]) for sensor in self._sensors)
        return next((one.position_m for one in known if one is not None), None)

    def _initiate_introduced(self, frame: Frame) -> None:
        """Initiate a track at the hint for this frame, if there is one."""
        if self._introduced is None:
            return
        box, self._introduced = np.array(self._introduced), None
        given = (sensor.detect_in(frame, box, self._tracks.predictions()) for sensor in self._sensors)
        detections = next((one for one in given if one is not None), None)
        if detections is not None:
            self._tracks.initiate_at(box, detections, frame.time_s)

    def _images(self, frame: Frame) -> dict[str, ProjectedBoxes]:
        """Return the tracks in the images of the sensors and in those of the further cameras."""
        predicted, origin_m = self._tracks.predictions(), self._tracks.origin_m
        images = {sensor.cameras[0]: sensor.project(frame, predicted) for sensor in self._sensors}
        for camera in self._shown_in:
            calibration = frame.calibrations.get(camera)
            if isinstance(calibration, PinholeCalibration) and origin_m is not None:
                view = Viewpoint.of(calibration, (0, 0), origin_m, self._config.motion.toe_m)
                images[camera] = project_boxes(predicted, view, view.shape)
        return {camera: image for camera, image in images.items() if image is not None}
