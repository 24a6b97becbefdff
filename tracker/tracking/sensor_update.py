"""The update of the tracks by the sensors in one frame: what they detect, what they miss, what is hidden."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.tracking.association import (
    are_overlapped,
    associate,
    find_occluders,
    likeness,
    shared_area,
)
from peopleboy.tracker.tracking.config import PeopleTrackerConfig
from peopleboy.tracker.tracking.motion_filter import Floats, StateEstimates
from peopleboy.tracker.tracking.reidentification import Candidates
from peopleboy.tracker.tracking.sensor import Sensor, SensorDetections
from peopleboy.tracker.tracking.track_state import DetectionEvidence
from peopleboy.tracker.tracking.tracks import Tracks


class SensorUpdate:
    """The update of tracks, predicted for the time of a frame; dt_s is the time since the last one."""

    def __init__(self, tracks: Tracks, frame: Frame, dt_s: float, config: PeopleTrackerConfig) -> None:
        self._tracks, self._frame, self._dt_s, self._config = tracks, frame, dt_s, config
        self._missed: set[int] = set()
        self._hidden: set[int] = set()
        self._occluders: dict[int, int] = {}

    def add(self, sensor: Sensor, detections: SensorDetections, dt_s: float) -> None:
        """Update and initiate tracks with a sensor's detections, dt_s after the last image of its camera."""
        tracks, frame = self._tracks, self._frame
        found = self._associate(detections)
        if found:
            self._update_found(found, detections, dt_s)
        image = sensor.project(frame, tracks.predictions()) if detections.is_search else None
        if image is not None:
            found |= tracks.initiate(found, detections, image.boxes, frame.time_s)
        sensor.remember(detections, found, tuple(one.key for one in tracks.items))
        self._look(sensor, detections, found)

    def finish(self, sensors: Sequence[Sensor], before: StateEstimates) -> None:
        """Update the tracks that a sensor misses and no other one detects.

        Args:
            sensors: all sensors.
            before: the states before the prediction, in the present level frame.
        """
        if not self._missed:
            return
        self._hidden |= self._occluders.keys()
        if self._config.stops_hidden:
            self._stop_hidden(sensors, before)
        for row in sorted(self._missed):
            one, front = self._tracks.items[row], self._occluders.get(row)
            if one.seen_s < self._frame.time_s:
                occluder = None if front is None else self._tracks.items[front].id
                one.update_missed(occluder, self._dt_s, is_hidden=row in self._hidden or one.is_pinned)

    def _associate(self, detections: SensorDetections) -> dict[int, int]:
        """Return the detections by row of the track."""
        tracks = self._tracks
        if not tracks.items or len(detections) == len(detections.assigned):
            return dict(detections.assigned)
        return associate(
            tracks.items,
            detections.measurement.distances(tracks.states),
            iou(detections.expected[:, None], detections.boxes[None]),
            *likeness(tracks.items, detections.pattern, detections.colours),
            self._same_person(detections),
            detections.scores,
            detections.assigned,
            self._frame.time_s,
            detections.settings.association,
        )

    def _same_person(self, detections: SensorDetections) -> Floats | None:
        """Return the log-odds (K, M) by which detections continue lost tracks, less those needed."""
        config, lost_s = detections.settings.reidentification, detections.settings.association.lost_s
        if not config.uses_place:
            return None
        time_s, items = self._frame.time_s, self._tracks.items
        odds = np.full((len(items), len(detections)), -math.inf)
        rows = [row for row, one in enumerate(items) if one.is_lost(time_s, lost_s)]
        if rows:
            states = detections.measurement.initiate(range(len(detections)))
            found = Candidates.of(states, detections.colours)
            odds[rows] = self._tracks.odds_of_lost(rows, found, time_s, config)
        return odds

    def _update_found(self, found: Mapping[int, int], detections: SensorDetections, dt_s: float) -> None:
        """Update the detected tracks."""
        tracks, time_s = self._tracks, self._frame.time_s
        existence, lost_s = detections.settings.existence, detections.settings.association.lost_s
        is_beside = are_overlapped(detections.expected, tracks.are_confirmed())
        common = shared_area(detections.boxes, tracks.of_confirmed(found))
        rows = sorted(found)
        was_lost = [tracks.items[row].is_lost(time_s, lost_s) for row in rows]
        speed = np.hypot(tracks.states.mean[:, 3], tracks.states.mean[:, 5])
        for row in rows:
            one, column = tracks.items[row], found[row]
            evidence = DetectionEvidence(
                float(detections.scores[column]), float(common[column]), float(speed[row])
            )
            one.update_seen(evidence, time_s, dt_s, existence)
            if detections.common_m is not None:
                one.common_m = detections.common_m[column]
            if detections.posture is not None:
                one.update_posture(detections.posture[column], dt_s)
            if detections.edges is not None:
                one.update_edges(detections.edges[column], existence.learning_edges)
            has_width = detections.has_width is None or bool(detections.has_width[column])
            one.update_box(detections.camera, detections.boxes[column], has_width=has_width)
            if not is_beside[row]:
                one.mark_separate(time_s, dt_s)
            elif not detections.is_masked:
                one.mark_overlapping()
                continue
            if detections.is_masked or row not in detections.assigned:
                one.update_appearance(detections.pattern[column], detections.colours[column])
        tracks.correct(rows, detections, [found[row] for row in rows], was_lost)

    def _look(self, sensor: Sensor, detections: SensorDetections, found: Mapping[int, int]) -> None:
        """Note the tracks that a sensor misses, and whether its image shows them or what hides them."""
        items, frame, earlier = self._tracks.items, self._frame, len(detections.expected)
        known = [row for row in found if row < earlier]
        front = find_occluders(detections.expected, self._tracks.are_confirmed(earlier), known)
        self._occluders |= {row: one for row, one in enumerate(front) if one is not None and row not in found}
        predicted = self._tracks.predictions()
        image = sensor.project(frame, predicted)
        rows = [row for row in range(len(items)) if row not in found]
        self._missed |= {row for row in rows if image is None or image.is_inside[row]}
        seen = sensor.visibility(frame, predicted.take(rows)) if rows else None
        if seen is None:
            return
        for row, hidden, is_present, is_absent in zip(
            rows, seen.hidden, seen.is_present, seen.is_absent, strict=True
        ):
            if is_present:
                items[row].present_s = frame.time_s
            if is_absent:
                items[row].update_absent(self._dt_s)
            if hidden > self._config.hidden_share:
                self._hidden.add(row)

    def _stop_hidden(self, sensors: Sequence[Sensor], before: StateEstimates) -> None:
        """Stop hidden people who would now be visible: as no sensor detects them, they stopped."""
        tracks, time_s = self._tracks, self._frame.time_s
        missed = [
            row
            for row, one in enumerate(tracks.items)
            if one.is_confirmed
            and max(one.seen_s, one.present_s) < time_s
            and (one.is_hidden or row in self._hidden)
        ]
        stopped = {row for row in missed if row not in self._hidden}
        for sensor in sensors if missed else ():
            there = tracks.predictions().take(missed, tracks.last_seen)
            seen = sensor.visibility(self._frame, there)
            if seen is not None:
                back = {row for row, is_present in zip(missed, seen.is_present, strict=True) if is_present}
                for row in back:
                    tracks.stop(row, tracks.last_seen)
                    tracks.items[row].present_s = time_s
                stopped -= back
        for row in stopped:
            tracks.stop(row, before)
