"""The people tracker: detections of one or several sensors become lasting tracks."""

import math
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import count
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import Frame, Odometry, check_frame, lacking
from peopleboy.tracker.track import Box, FloorPlace, Track
from peopleboy.tracker.tracking.association import (
    CLEAR,
    are_overlapped,
    associate,
    find_occluders,
    likeness,
    shared_area,
)
from peopleboy.tracker.tracking.config import PeopleTrackerConfig, ReidentificationConfig
from peopleboy.tracker.tracking.motion_filter import (
    NO_STATES,
    Floats,
    StateEstimates,
    floor_positions,
    predict,
)
from peopleboy.tracker.tracking.reidentification import (
    Candidates,
    assign_lost,
    resolve_identity_swaps,
    same_person_log_odds,
)
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    Sensor,
    SensorDetections,
    SensorExplanations,
    Settings,
    project_boxes,
)
from peopleboy.tracker.tracking.track_state import DetectionEvidence, TrackState
from peopleboy.tracker.tracking.viewpoint import Position, Viewpoint

FIRST_STEP_S: Final = 1 / 15
_STANDING: Final = Odometry()


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
        self._targets: list[TrackState] = []
        self._states = NO_STATES
        self._last_seen = NO_STATES  # the state of each track when it was last detected
        self._last_s: float | None = None
        self._sensed_s: dict[str, float] = {}
        self._settings: Settings | None = None
        self._keys, self._ids = count(), count(1)

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
        dt_s = self._time_step(frame.time_s)
        moved = frame.odometry or _STANDING
        before = predict(self._states, 0.0, moved, self._config.motion)
        self._states = predict(self._states, dt_s, moved, self._config.motion)
        self._last_seen = predict(self._last_seen, 0.0, moved, self._config.motion)
        occluders: dict[int, int] = {}
        hidden: set[int] = set()
        missed: set[int] = set()
        for sensor in self._sensors:
            detections = sensor.detect(frame, self._predictions(frame))
            if detections is not None:
                found = self._sense(sensor, detections, frame)
                occluders |= self._occluders(detections, found)
                missed |= self._missed(sensor, found, frame)
                hidden |= self._look(sensor, found, frame, dt_s)
        if missed:
            hidden |= occluders.keys()
            if self._config.stops_hidden:
                self._stay_hidden(before, hidden, frame)
            self._update_missed(missed, occluders, hidden, frame.time_s, dt_s)
        if self._introduced is not None:
            self._initiate_at(np.array(self._introduced), frame)
            self._introduced = None
        self._manage(frame.time_s)
        return self._tracks(frame)

    def _mounted(self, calibrations: Mapping[str, Calibration]) -> tuple[Sensor, ...]:
        """Return the optional sensors whose cameras are there."""
        return tuple(one for one in self._optional if one.cameras[0] in calibrations)

    def _check_images(self, frame: Frame) -> None:
        """Refuse a frame without an image of any sensor, except between the images of slower cameras."""
        is_first = self._settings is None
        if is_first and frame.images and not any(one.cameras[0] in frame.images for one in self._sensors):
            raise BadInput(lacking(self._sensors[0].cameras[0], frame.images))

    def _time_step(self, time_s: float) -> float:
        last_s, self._last_s = self._last_s, time_s
        if last_s is None:
            return FIRST_STEP_S
        if time_s <= last_s:
            raise BadInput(f"time_s must go forward, got {time_s} after {last_s}")
        return time_s - last_s

    def _predictions(self, frame: Frame) -> Predictions:
        return Predictions(
            keys=tuple(target.key for target in self._targets),
            states=self._states,
            ratio=np.array([target.ratio for target in self._targets]),
            log_odds=np.array([target.log_odds for target in self._targets]),
            is_confirmed=self._are_confirmed(),
            origin_m=self._origin(frame),
        )

    def _origin(self, frame: Frame) -> Position | None:
        """Return the position of the first calibrated camera."""
        known = (frame.calibrations.get(sensor.cameras[0]) for sensor in self._sensors)
        return next((one.position_m for one in known if one is not None), None)

    def _are_confirmed(self, count: int | None = None) -> NDArray[np.bool_]:
        """Return which tracks are confirmed, or which of the first ones."""
        return np.array([target.is_confirmed for target in self._targets[:count]], np.bool_)

    def _sense(self, sensor: Sensor, detections: SensorDetections, frame: Frame) -> dict[int, int]:
        """Update the tracks with a sensor's detections, and return the detections by row of the track."""
        time_s, last_s = frame.time_s, self._sensed_s.get(detections.camera)
        dt_s = FIRST_STEP_S if last_s is None else time_s - last_s
        self._sensed_s[detections.camera], self._settings = time_s, detections.settings
        found = self._associate(detections, time_s)
        self._update_found(found, detections, time_s, dt_s)
        image = sensor.project(frame, self._predictions(frame)) if detections.is_search else None
        if image is not None:
            found |= self._initiate(found, detections, image.boxes, time_s)
        sensor.remember(detections, found, tuple(target.key for target in self._targets))
        return found

    def _occluders(self, detections: SensorDetections, found: Mapping[int, int]) -> dict[int, int]:
        """Return the tracks that may occlude undetected ones, by row."""
        count = len(detections.expected)
        known = [row for row in found if row < count]
        front = find_occluders(detections.expected, self._are_confirmed(count), known)
        return {row: one for row, one in enumerate(front) if one is not None and row not in found}

    def _missed(self, sensor: Sensor, found: Mapping[int, int], frame: Frame) -> set[int]:
        """Return the tracks that a sensor should detect, as its image shows where they are, and does not."""
        image = sensor.project(frame, self._predictions(frame))
        rows = set(range(len(self._targets))) - found.keys()
        return rows if image is None else {row for row in rows if image.is_inside[row]}

    def _look(self, sensor: Sensor, found: Mapping[int, int], frame: Frame, dt_s: float) -> set[int]:
        """Look where a sensor should see the tracks that it did not detect, and return the hidden ones."""
        rows = [row for row in range(len(self._targets)) if row not in found]
        seen = sensor.visibility(frame, self._predictions(frame).take(rows)) if rows else None
        if seen is None:
            return set()
        for row, is_present, is_absent in zip(rows, seen.is_present, seen.is_absent, strict=True):
            if is_present:
                self._targets[row].present_s = frame.time_s
            if is_absent:
                self._targets[row].update_absent(dt_s)
        return {
            row for row, hidden in zip(rows, seen.hidden, strict=True) if hidden > self._config.hidden_share
        }

    def _associate(self, detections: SensorDetections, time_s: float) -> dict[int, int]:
        if not self._targets or len(detections) == len(detections.assigned):
            return dict(detections.assigned)
        return associate(
            self._targets,
            detections.measurement.distances(self._states),
            iou(detections.expected[:, None], detections.boxes[None]),
            *likeness(self._targets, detections.pattern, detections.colours),
            self._same_person(detections, time_s),
            detections.scores,
            detections.assigned,
            time_s,
            detections.settings.association,
        )

    def _same_person(self, detections: SensorDetections, time_s: float) -> Floats | None:
        """Return the log-odds (K, M) by which detections continue lost tracks, less those needed."""
        if not detections.settings.reidentification.uses_place:
            return None
        odds = np.full((len(self._targets), len(detections)), -math.inf)
        lost_s, config = detections.settings.association.lost_s, detections.settings.reidentification
        rows = [row for row, one in enumerate(self._targets) if one.is_lost(time_s, lost_s)]
        if rows:
            found = detections.measurement.initiate(range(len(detections)))
            seen = Candidates.of(found, detections.colours)
            odds[rows] = same_person_log_odds(*self._lost(rows, time_s), seen, config)
        return odds

    def _lost(self, rows: Sequence[int], time_s: float) -> tuple[Candidates, Floats]:
        """Return people who are lost, where they were last seen, and for how long they have been lost."""
        targets = [self._targets[row] for row in rows]
        last = self._last_seen.take(np.array(rows, np.intp))
        gone_s = np.array([time_s - one.seen_s for one in targets])
        return Candidates.of(last, [one.colours for one in targets]), gone_s

    def _update_found(
        self, found: Mapping[int, int], detections: SensorDetections, time_s: float, dt_s: float
    ) -> None:
        """Update the detected tracks."""
        if not found:
            return
        existence, lost_s = detections.settings.existence, detections.settings.association.lost_s
        is_beside = are_overlapped(detections.expected, self._are_confirmed())
        common = shared_area(detections.boxes, self._known(found))
        rows = np.array(sorted(found))
        was_lost = np.array([self._targets[row].is_lost(time_s, lost_s) for row in rows], bool)
        speed = np.hypot(self._states.mean[:, 3], self._states.mean[:, 5])
        for row in rows.tolist():
            target, column = self._targets[row], found[row]
            evidence = DetectionEvidence(
                float(detections.scores[column]), float(common[column]), float(speed[row])
            )
            target.update_seen(evidence, time_s, dt_s, existence)
            if detections.common_m is not None:
                target.common_m = detections.common_m[column]
            has_width = detections.has_width is None or bool(detections.has_width[column])
            target.update_box(detections.camera, detections.boxes[column], has_width=has_width)
            if not is_beside[row]:
                target.mark_separate(time_s, dt_s)
            elif not detections.is_masked:
                target.mark_overlapping()
                continue
            if detections.is_masked or row not in detections.assigned:
                target.update_appearance(detections.pattern[column], detections.colours[column])
        self._correct(rows, detections, [found[row] for row in rows.tolist()], was_lost)

    def _correct(
        self,
        rows: NDArray[np.intp],
        detections: SensorDetections,
        columns: Sequence[int],
        was_lost: NDArray[np.bool_],
    ) -> None:
        """Update the motion filters; that of a lost track starts anew, as its path was extrapolated."""
        later = detections.measurement.update(self._states.take(rows), columns)
        if was_lost.any():
            lost = np.flatnonzero(was_lost)
            anew = detections.measurement.initiate([columns[row] for row in lost.tolist()])
            later = later.replaced(lost, anew)
        self._states = self._states.replaced(rows, later)
        self._last_seen = self._last_seen.replaced(rows, later)

    def _known(self, found: Mapping[int, int]) -> list[int]:
        """Return the detection indices of confirmed tracks."""
        return [column for row, column in found.items() if self._targets[row].is_confirmed]

    def _update_missed(
        self, missed: Set[int], occluders: Mapping[int, int], hidden: Set[int], time_s: float, dt_s: float
    ) -> None:
        """Update the tracks that a sensor misses and no other one detects."""
        for row in sorted(missed):
            target = self._targets[row]
            if target.seen_s < time_s:
                hider = occluders.get(row)
                occluder = None if hider is None else self._targets[hider].id
                target.update_missed(occluder, dt_s, is_hidden=row in hidden or target.is_pinned)

    def _stay_hidden(self, before: StateEstimates, hidden: Set[int], frame: Frame) -> None:
        """Stop hidden people who would now be visible: as no sensor detects them, they stopped.

        Args:
            before: the states before the prediction, in the present level frame.
            hidden: rows of the tracks that are hidden now.
            frame: the present images.
        """
        missed = [
            row
            for row, one in enumerate(self._targets)
            if one.is_confirmed
            and max(one.seen_s, one.present_s) < frame.time_s
            and (one.is_hidden or row in hidden)
        ]
        stopped = {row for row in missed if row not in hidden}
        for sensor in self._sensors:
            there = self._predictions(frame).take(missed, self._last_seen)
            seen = sensor.visibility(frame, there) if missed else None
            if seen is not None:
                back = {row for row, is_present in zip(missed, seen.is_present, strict=True) if is_present}
                for row in back:
                    self._stop(row, self._last_seen)
                    self._targets[row].present_s = frame.time_s
                stopped -= back
        for row in stopped:
            self._stop(row, before)

    def _stop(self, row: int, states: StateEstimates) -> None:
        """Let a hidden person stand where some states have them."""
        self._states.mean[row], self._states.mean[row, 3:6] = states.mean[row], 0.0
        self._targets[row].is_pinned = True

    def _initiate(
        self, found: Mapping[int, int], detections: SensorDetections, boxes: Floats, time_s: float
    ) -> dict[int, int]:
        """Initiate tracks from detections away from existing tracks, and return their detections by row."""
        existence, lost_s = detections.settings.existence, detections.settings.association.lost_s
        is_free = detections.scores >= existence.birth
        is_free[list(found.values())] = False
        recent = np.array([target.seen_s > time_s - lost_s for target in self._targets], bool)
        if recent.any():
            is_free &= (iou(detections.boxes[:, None], boxes[recent][None]) < existence.taken).all(axis=1)
        if not detections.is_masked:
            is_mixed = shared_area(detections.boxes, self._known(found)) > CLEAR
            detections = detections.without_colours(is_mixed)
        return self._add(np.flatnonzero(is_free), detections, time_s)

    def _initiate_at(self, box: Floats, frame: Frame) -> None:
        """Initiate a track at a hint, replacing any track that was there."""
        given = (sensor.detect_in(frame, box, self._predictions(frame)) for sensor in self._sensors)
        detections = next((one for one in given if one is not None), None)
        if detections is None:
            return
        kept = np.flatnonzero(iou(detections.expected, box[None]) < detections.settings.existence.taken)
        self._keep(kept)
        self._add(np.zeros(1, int), detections, frame.time_s)
        self._confirm(self._targets[-1], -math.inf)  # a hint is certain

    def _add(self, free: NDArray[np.intp], detections: SensorDetections, time_s: float) -> dict[int, int]:
        """Initiate tracks from some of the detections, and return their detections by row."""
        if len(free) == 0:
            return {}
        first = len(self._targets)
        new = detections.measurement.initiate(free)
        self._states = self._states.joined(new)
        self._last_seen = self._last_seen.joined(new)
        self._targets += [
            TrackState(
                key=next(self._keys),
                born_s=time_s,
                seen_s=time_s,
                pattern=detections.pattern[column],
                colours=detections.colours[column],
                ratio=detections.ratio(column),
                existence=detections.settings.existence,
                shown={detections.camera: (time_s, detections.boxes[column])},
                log_odds=min(float(detections.scores[column]), detections.settings.existence.highest_score),
                surest=float(detections.scores[column]),
            )
            for column in free.tolist()
        ]
        return {first + number: column for number, column in enumerate(free.tolist())}

    def _keep(self, rows: NDArray[np.intp]) -> None:
        self._states, self._last_seen = self._states.take(rows), self._last_seen.take(rows)
        self._targets = [self._targets[row] for row in rows]

    def _manage(self, time_s: float) -> None:
        """Confirm, reidentify and delete tracks."""
        if self._settings is None:
            return
        self._reidentify(time_s, self._settings.reidentification)
        resolve_identity_swaps(self._targets, time_s, self._settings.reidentification)
        kept = [row for row, one in enumerate(self._targets) if not one.is_deleted(time_s)]
        self._keep(np.array(kept, int))

    def _reidentify(self, time_s: float, config: ReidentificationConfig) -> None:
        """Let new tracks continue lost ones, or confirm them as new people."""
        fresh = [
            row
            for row, one in enumerate(self._targets)
            if one.seen_s == time_s
            and (one.is_confirmed or one.has_enough_evidence())
            and time_s - one.confirmed_s <= config.revised_s
        ]
        if not fresh:
            return
        lost = [row for row, one in enumerate(self._targets) if one.is_lost(time_s, config.lost_s)]
        before: dict[int, int] = {}
        is_open = np.zeros(len(fresh), bool)
        if lost:
            seen = Candidates.of(
                self._states.take(np.array(fresh, np.intp)), [self._targets[row].colours for row in fresh]
            )
            odds = same_person_log_odds(*self._lost(lost, time_s), seen, config)
            before = assign_lost(odds)
            is_open = odds.max(axis=0) > -config.unclear
        for number, row in enumerate(fresh):
            target = self._targets[row]
            if number in before:
                target.inherit(self._targets[lost[before[number]]])
            elif not target.is_confirmed and not (
                is_open[number] and time_s - target.born_s < config.undecided_s
            ):
                self._confirm(target, time_s)

    def _confirm(self, target: TrackState, time_s: float) -> None:
        target.confirmed_s = time_s
        target.id = next(self._ids)
        target.log_odds = max(target.log_odds, target.existence.confirmed)

    def _tracks(self, frame: Frame) -> tuple[Track, ...]:
        if self._settings is None:
            return ()
        predicted = self._predictions(frame)
        images = self._projected(frame, predicted)
        overlaps = self._overlaps_with_seen(images.values(), frame.time_s)
        places: Sequence[FloorPlace | None] = [None] * len(predicted)
        if predicted.origin_m is not None:
            common_m = np.array([target.common_m for target in self._targets]).reshape(-1, 2)
            places = floor_positions(self._states, common_m, predicted.origin_m)
        tracks = [
            self._track(row, self._boxes_of(row, images, frame.time_s), places[row], frame.time_s)
            for row, target in enumerate(self._targets)
            if target.is_output(frame.time_s, overlaps[row])
            and any(image is not None and image.is_inside[row] for image in images.values())
        ]
        return tuple(sorted(tracks, key=lambda track: track.id))

    def _projected(self, frame: Frame, predicted: Predictions) -> dict[str, ProjectedBoxes | None]:
        """Return the tracks in the images of the sensors and in those of the further cameras."""
        images = {sensor.cameras[0]: sensor.project(frame, predicted) for sensor in self._sensors}
        for camera in self._shown_in:
            calibration = frame.calibrations.get(camera)
            if isinstance(calibration, PinholeCalibration) and predicted.origin_m is not None:
                view = Viewpoint.of(calibration, (0, 0), predicted.origin_m, self._config.motion.toe_m)
                images[camera] = project_boxes(predicted, view, view.shape)
        return images

    def _overlaps_with_seen(self, images: Iterable[ProjectedBoxes | None], time_s: float) -> Floats:
        """Return the greatest overlap (K,) of each track with one that is seen now, over all images."""
        is_seen = np.array([target.seen_s >= time_s for target in self._targets], np.bool_)
        overlaps = np.zeros(len(self._targets))
        for image in images:
            if image is not None and is_seen.any():
                mutual = iou(image.boxes[:, None], image.boxes[None, is_seen])
                overlaps = np.maximum(overlaps, mutual.max(axis=1))
        return overlaps

    def _boxes_of(
        self, row: int, images: Mapping[str, ProjectedBoxes | None], time_s: float
    ) -> dict[str, Box]:
        """Return the boxes of a track: a blend of the prediction and the detected box, if there is one."""
        target, boxes = self._targets[row], {}
        for camera, image in images.items():
            if image is None or not image.is_inside[row]:
                continue
            box = image.boxes[row]
            seen_s, shown = target.shown.get(camera, (-math.inf, box))
            if seen_s == time_s:
                box = box + self._config.motion.shown * (shown - box)
            left, top, width, height = box.tolist()
            boxes[camera] = (left, top, width, height)
        return boxes

    def _track(self, row: int, boxes: dict[str, Box], place: FloorPlace | None, time_s: float) -> Track:
        target = self._targets[row]
        return Track(
            id=target.id,
            boxes=boxes,
            place=place,
            confidence=target.confidence,
            status=target.status(time_s),
            age_s=time_s - target.born_s,
            occluder=target.occluder,
        )
