"""The detection tracker: detections in single images become lasting tracks."""

import math
from collections.abc import Sequence, Set
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.boxes import intersection, iou, outline
from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, Odometry, check_frame
from peopleboy.tracker.track import Box, FloorPlace, Track
from peopleboy.tracker.tracking.association import (
    CLEAR,
    DescribedDetections,
    DetectionExplanation,
    are_overlapped,
    associate,
    find_occluders,
    shared_area,
)
from peopleboy.tracker.tracking.config import (
    AssociationConfig,
    DetectionScheduleConfig,
    DetectionTrackerConfig,
    ExistenceConfig,
    ReidentificationConfig,
)
from peopleboy.tracker.tracking.detection_schedule import DetectionSchedule, Schedule
from peopleboy.tracker.tracking.motion_filter import (
    NOBODY,
    Floats,
    floor_positions,
    initiate,
    mahalanobis_distances,
    predict,
    predicted_boxes,
    update_states,
)
from peopleboy.tracker.tracking.people_finder import Finder, PeopleFinder
from peopleboy.tracker.tracking.reidentification import reidentify, resolve_identity_swaps
from peopleboy.tracker.tracking.template import Template
from peopleboy.tracker.tracking.track_state import DetectionEvidence, TrackState
from peopleboy.tracker.tracking.viewpoint import Viewpoint

FIRST_STEP_S: Final = 1 / 15
_STANDING: Final = Odometry()
_TAKEN: Final = 0.45  # overlap with a track at which a detection does not initiate a track


class _Instant(NamedTuple):
    """Context of one frame: time [s], time step [s], viewpoint, and evidence settings for its calibration.

    The outline of its image is (4,) [px].
    """

    time_s: float
    dt_s: float
    view: Viewpoint
    outline: Floats
    schedule: DetectionScheduleConfig
    existence: ExistenceConfig
    association: AssociationConfig
    reidentification: ReidentificationConfig


class DetectionTracker:
    """Tracks people in metres around the camera by a learned detector, and by templates in between.

    A track is confirmed by accumulated evidence, and identities are resolved late.
    """

    def __init__(self, config: DetectionTrackerConfig | None = None, find: Finder | None = None) -> None:
        """Make one that detects people with the learned detector in both images, or with another finder."""
        self._config = DetectionTrackerConfig() if config is None else config
        self._find = PeopleFinder(self._config) if find is None else find
        self._introduced: Box | None = None
        self._explanation = DetectionExplanation(boxes=np.empty((0, 4)), scores=np.empty(0))
        self._targets: list[TrackState] = []
        self._paths = NOBODY
        self._last_s: float | None = None
        self._schedule = DetectionSchedule()
        self._born = 0
        self._view: tuple[Calibration | None, tuple[int, int], Viewpoint] | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The thermal camera, and the colour camera, used for detection and re-identification."""
        return (THERMAL, COLOUR)

    @property
    def explanation(self) -> DetectionExplanation:
        """The detections of the last frame."""
        return self._explanation

    def introduce(self, box: Box) -> None:
        """Report that a person is at this box [px] in the next frame, as for single-object trackers."""
        self._introduced = box

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks.

        Raises:
            BadInput: the time does not increase.
        """
        check_frame(frame)
        rows, columns = frame.grey(THERMAL).shape
        view = self._viewpoint(frame.calibrations.get(THERMAL), (rows, columns))
        whole = outline(frame.grey(THERMAL))
        now = _Instant(frame.time_s, self._time_step(frame.time_s), view, whole, *self._settings_for(view))
        self._predict(now.dt_s, frame.odometry or _STANDING)
        expected = self._boxes(view)
        aim = self._schedule.schedule_next(
            frame.grey(THERMAL), self._targets, expected, now.time_s, view.breadth, now.schedule
        )
        seen = self._find(frame, aim.proposed(self._targets), everywhere=aim.everywhere)
        seen = seen._replace(score=now.existence.trust * seen.score + now.existence.lasting)
        proposed = DescribedDetections.of(
            frame, aim.with_followed(seen, self._targets), view, len(aim.followed)
        )
        followed = {row: len(seen.box) + place for place, row in enumerate(aim.followed)}
        found = self._associate(expected, proposed, followed, now)
        self._update_tracks(found, followed, expected, proposed, now)
        self._update_templates(frame, found.items() - followed.items(), proposed, aim)
        if aim.everywhere:
            self._initiate(found, proposed, now)
        if self._introduced is not None:
            self._initiate_at(np.array([self._introduced]), frame, now)
            self._introduced = None
        self._manage(now)
        self._explanation = DetectionExplanation(boxes=proposed.boxes, scores=proposed.scores)
        return self._tracks(frame, now)

    def _viewpoint(self, calibration: Calibration | None, shape: tuple[int, int]) -> Viewpoint:
        if self._view is None or self._view[0] is not calibration or self._view[1] != shape:
            self._view = calibration, shape, Viewpoint.of(calibration, shape)
        return self._view[2]

    def _time_step(self, time_s: float) -> float:
        last_s, self._last_s = self._last_s, time_s
        if last_s is None:
            return FIRST_STEP_S
        if time_s <= last_s:
            raise BadInput(f"time_s must go forward, got {time_s} after {last_s}")
        return time_s - last_s

    def _predict(self, dt_s: float, moved: Odometry) -> None:
        self._paths = predict(self._paths, dt_s, moved, self._config.motion)

    def _are_confirmed(self) -> NDArray[np.bool_]:
        return np.array([target.is_confirmed for target in self._targets], np.bool_)

    def _boxes(self, view: Viewpoint) -> Floats:
        return predicted_boxes(self._paths, view, np.array([target.ratio for target in self._targets]))

    def _associate(
        self, expected: Floats, proposed: DescribedDetections, followed: dict[int, int], now: _Instant
    ) -> dict[int, int]:
        if not self._targets or len(proposed) == len(followed):
            return followed
        return associate(
            self._targets,
            mahalanobis_distances(self._paths, proposed.boxes, now.view, self._config.motion),
            iou(expected[:, None], proposed.boxes[None]),
            *proposed.likeness(self._targets),
            proposed.scores,
            followed,
            now.time_s,
            now.association,
        )

    def _update_tracks(
        self,
        found: dict[int, int],
        followed: dict[int, int],
        expected: Floats,
        proposed: DescribedDetections,
        now: _Instant,
    ) -> None:
        """Update the detected tracks, and find the occluders of the others."""
        is_confirmed = self._are_confirmed()
        front = find_occluders(expected, is_confirmed, found)
        is_beside, common = (
            are_overlapped(expected, is_confirmed),
            shared_area(proposed.boxes, self._known(found)),
        )
        was_lost = np.array([self._is_lost(target, now) for target in self._targets], bool)
        speed = np.hypot(self._paths.mean[:, 3], self._paths.mean[:, 5])
        for row, target in enumerate(self._targets):
            if row not in found:
                hider = front[row]
                target.update_missed(
                    None if hider is None else self._targets[hider].id, now.dt_s, now.existence
                )
                continue
            seen = found[row]
            finding = DetectionEvidence(float(proposed.scores[seen]), float(common[seen]), float(speed[row]))
            target.update_seen(finding, now.time_s, now.dt_s, now.existence)
            target.update_box(proposed.boxes[seen])
            target.trees = float(proposed.trees[seen])
            if is_beside[row]:
                target.mark_overlapping()
            else:
                target.mark_separate(now.dt_s)
                if row not in followed:
                    target.update_appearance(proposed.pattern[seen], proposed.colours[seen])
        if found:
            rows = np.array(sorted(found))
            boxes = proposed.boxes[[found[row] for row in rows]]
            self._correct(rows, boxes, was_lost[rows], now.view)

    def _update_templates(
        self, frame: Frame, looked: Set[tuple[int, int]], proposed: DescribedDetections, aim: Schedule
    ) -> None:
        """Update the appearance of tracks that the detector found."""
        for row, column in looked:
            target = self._targets[row]
            target.rescored_s, target.score = frame.time_s, float(proposed.scores[column])
            target.template = Template.of(frame.grey(THERMAL), proposed.boxes[column])
            if aim.everywhere and row not in aim.expected:
                target.searched_s = frame.time_s

    def _correct(
        self,
        rows: NDArray[np.intp],
        boxes: Floats,
        was_lost: NDArray[np.bool_],
        view: Viewpoint,
    ) -> None:
        """Update the motion filters; that of a lost track starts anew, as its path was extrapolated."""
        config = self._config.motion
        later = update_states(self._paths.take(rows), boxes, view, config)
        if was_lost.any():
            later = later.replaced(np.flatnonzero(was_lost), initiate(boxes[was_lost], view, config))
        self._paths = self._paths.replaced(rows, later)

    def _is_lost(self, target: TrackState, now: _Instant) -> bool:
        return target.is_confirmed and target.seen_s < now.time_s - now.association.lost_s

    def _known(self, found: dict[int, int]) -> list[int]:
        """Return the detection indices of confirmed tracks."""
        return [column for row, column in found.items() if self._targets[row].is_confirmed]

    def _initiate(self, found: dict[int, int], proposed: DescribedDetections, now: _Instant) -> None:
        """Initiate tracks from detections away from existing tracks."""
        is_free = proposed.scores >= now.existence.birth
        is_free[list(found.values())] = False
        recent = [target.seen_s > now.time_s - now.association.lost_s for target in self._targets]
        if any(recent):
            known = self._boxes(now.view)[np.array(recent)]
            is_free &= (iou(proposed.boxes[:, None], known[None]) < _TAKEN).all(axis=1)
        is_mixed = shared_area(proposed.boxes, self._known(found)) > CLEAR
        self._add(np.flatnonzero(is_free), proposed.without_colours(is_mixed), now)

    def _initiate_at(self, box: Floats, frame: Frame, now: _Instant) -> None:
        """Initiate a track at a hint, replacing any track that was there."""
        strangers = (iou(self._boxes(now.view)[:, None], box[None]) < _TAKEN).all(axis=1)
        kept = np.flatnonzero(strangers) if self._targets else np.empty(0, int)
        self._paths = self._paths.take(kept)
        self._targets = [self._targets[row] for row in kept]
        met = DescribedDetections.of(frame, Detections.from_trees(box, np.zeros(1)), now.view)
        self._add(np.zeros(1, int), met, now)
        self._confirm(self._targets[-1], -math.inf, now.existence)  # a hint is certain

    def _add(self, free: NDArray[np.intp], proposed: DescribedDetections, now: _Instant) -> None:
        """Initiate tracks from some of the detections."""
        if len(free) == 0:
            return
        new = initiate(proposed.boxes[free], now.view, self._config.motion)
        self._paths = self._paths.joined(new)
        self._targets += [
            TrackState(
                born_s=now.time_s,
                seen_s=now.time_s,
                pattern=proposed.pattern[row],
                colours=proposed.colours[row],
                ratio=proposed.ratio(row),
                shown=proposed.boxes[row],
                trees=float(proposed.trees[row]),
                log_odds=min(float(proposed.scores[row]), now.existence.highest_score),
                surest=float(proposed.scores[row]),
            )
            for row in free.tolist()
        ]

    def _manage(self, now: _Instant) -> None:
        """Return the confirmed tracks, and delete the tracks that are gone."""
        for target in self._targets:
            if target.seen_s == now.time_s and (
                target.has_enough_evidence(now.existence) or target.is_confirmed
            ):
                self._reidentify(target, now)
        resolve_identity_swaps(self._targets, now.time_s, now.reidentification)
        kept = [row for row, one in enumerate(self._targets) if not one.is_deleted(now.time_s, now.existence)]
        self._paths = self._paths.take(np.array(kept, int))
        self._targets = [self._targets[row] for row in kept]

    def _reidentify(self, target: TrackState, now: _Instant) -> None:
        """Return the track of a person, which may continue a lost track."""
        if now.time_s - target.confirmed_s > now.reidentification.revised_s:
            return
        since = now.time_s - now.reidentification.lost_s
        lost = [other for other in self._targets if other.is_confirmed and other.seen_s < since]
        before = reidentify(target, lost, now.reidentification)
        if before is not None:
            target.inherit(before)
        elif not target.is_confirmed:
            self._confirm(target, now.time_s, now.existence)

    def _settings_for(
        self, view: Viewpoint
    ) -> tuple[DetectionScheduleConfig, ExistenceConfig, AssociationConfig, ReidentificationConfig]:
        config = self._config
        if view.floor_m is None:
            return (
                config.schedule_uncalibrated,
                config.existence_uncalibrated,
                config.association_uncalibrated,
                config.reidentification_uncalibrated,
            )
        return config.schedule, config.existence, config.association, config.reidentification

    def _confirm(self, target: TrackState, time_s: float, config: ExistenceConfig) -> None:
        target.confirmed_s = time_s
        self._born += 1
        target.id = self._born
        target.log_odds = max(target.log_odds, config.confirmed)

    def _output_box(self, target: TrackState, box: Floats, time_s: float) -> Box:
        """Return the output box: a blend of the prediction and the detected box, if there is one."""
        if target.seen_s == time_s:
            box = box + self._config.motion.shown * (target.shown - box)
        left, top, width, height = box.tolist()
        return left, top, width, height

    def _tracks(self, frame: Frame, now: _Instant) -> tuple[Track, ...]:
        boxes = self._boxes(now.view)
        is_inside = intersection(boxes, now.outline) > 0.0
        places: Sequence[FloorPlace | None] = [None] * len(boxes)
        if now.view.floor_m is not None:
            places = floor_positions(self._paths, frame.calibrations[THERMAL].position_m)
        shown = [
            (target, box, place)
            for target, box, inside, place in zip(self._targets, boxes, is_inside, places, strict=True)
            if inside and target.is_output(now.time_s, now.existence)
        ]
        shown.sort(key=lambda one: one[0].id)
        return tuple(
            Track(
                id=target.id,
                boxes={THERMAL: self._output_box(target, box, now.time_s)},
                place=place,
                confidence=target.confidence,
                status=target.status(now.time_s),
                age_s=now.time_s - target.born_s,
                occluder=target.occluder,
            )
            for target, box, place in shown
        )
