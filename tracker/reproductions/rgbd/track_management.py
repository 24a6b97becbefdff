"""Initiation, update and deletion of hypotheses (SA 4.5)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.frame import Floats, Odometry
from peopleboy.tracker.reproductions.rgbd.floor_filter import FloorFilter, Update
from peopleboy.tracker.reproductions.rgbd.hypothesis import Detection, Hypothesis
from peopleboy.tracker.reproductions.rgbd.observation_model import Body, look_at, similarity
from peopleboy.tracker.reproductions.rgbd.rgbd_config import HypothesesConfig, RgbdConfig
from peopleboy.tracker.sensors.depth.depth_view import RgbdView, box_at
from peopleboy.tracker.track import Box, Status

_CONFIDENT: Final = 0.3
_GAIN: Final = 0.15  # share of a frame's innovation that goes into the velocity
_SLOWS_S: Final = 2.0  # time constant with which an unobserved person slows down
_SIZE_SHARE: Final = 0.2
_SEEN_THROUGH: Final = 0.8  # share of readings behind, from which a person is gone
_SEEN_THROUGH_FRAMES: Final = 5
_HIDDEN: Final = 0.5  # share of readings in front, from which a person is occluded
_PARTLY_HIDDEN: Final = 0.2
_HIDDEN_ONES: Final = (Status.PARTLY_OCCLUDED, Status.TOTALLY_OCCLUDED)
_TENTATIVE_S: Final = 0.4
_FLOOR_SD_M: Final = 0.035  # of one frame: gait, not the sensor
_DEPTH_SD: Final = 0.0014  # [m/m2] of the sensor
_DRIFT_M2_S: Final = 0.15  # growth of an unobserved position's variance


@dataclass(frozen=True, slots=True)
class Management:
    """Updates of all hypotheses with one frame.

    Attributes:
        config: settings.
        view: sensor readings.
        time_s: [s].
        dt_s: [s] since the last frame.
        rng: random generator of the particles.
    """

    config: RgbdConfig
    view: RgbdView
    time_s: float
    dt_s: float
    rng: np.random.Generator

    def expected(self, person: Hypothesis, odometry: Odometry | None) -> Hypothesis:
        """Predict a hypothesis by the robot's motion and its own."""
        filtered, place, covariance = person.filter, person.place_m, person.covariance_m2
        velocity = person.velocity_m_s
        if odometry is not None and self.config.hypotheses.uses_odometry:
            motion = odometry.motion
            filtered, place = filtered.carried(motion), motion.points_to_local(place)
            covariance = motion.vectors_to_local(motion.vectors_to_local(covariance).T).T
            velocity = motion.vectors_to_local(velocity)
        place = place + velocity * self.dt_s
        filtered = filtered.predicted(self.dt_s, self.config.filter, self.rng)
        grown = covariance + np.eye(2) * _DRIFT_M2_S * self.dt_s
        return replace(person, filter=filtered, place_m=place, velocity_m_s=velocity, covariance_m2=grown)

    def looked_for(self, person: Hypothesis) -> tuple[Hypothesis, Update]:
        """Update a person's filter with the images."""
        update = person.filter.weighed(self.view, person.body, self.config.filter, self.rng)
        return replace(person, filter=update.filter), update

    def found(self, person: Hypothesis, update: Update, detection: Detection | None) -> Hypothesis:
        """Merge measurements into a hypothesis (SA eq. 4.22)."""
        rules = self.config.hypotheses
        expected = person.place_m
        is_confident = not update.is_held and update.confidence > _CONFIDENT
        if is_confident and np.hypot(*(update.place_m - person.place_m)) < rules.gate_m:
            person = replace(person, place_m=_merged(person.place_m, update.place_m, rules.filter_share))
        if detection is not None:
            person = self._measured(person, detection, is_confident=is_confident)
        is_seen = detection is not None or is_confident
        return self._judged(self._walking(person, expected, is_seen=is_seen), update, is_seen=is_seen)

    def born(self, detection: Detection) -> Hypothesis:
        """Initiate a hypothesis from a verified detection."""
        return Hypothesis(
            place_m=detection.place_m,
            velocity_m_s=np.zeros(2),
            covariance_m2=self._error_m2(detection),
            body=detection.body,
            filter=self._spread(detection),
            born_s=self.time_s,
            verified_s=self.time_s,
            seen_s=self.time_s,
        )

    def is_over(self, person: Hypothesis) -> bool:
        """Return whether a hypothesis is to be deleted."""
        rules = self.config.hypotheses
        if not person.id:
            return self.time_s - person.verified_s > _TENTATIVE_S
        if rules.has_see_through and person.seen_through >= _SEEN_THROUGH_FRAMES:
            return True
        is_excused = person.status in _HIDDEN_ONES or self._is_outside(person)
        return self.time_s - person.verified_s > (rules.hidden_s if is_excused else rules.unverified_s)

    def is_claimed(self, person: Hypothesis) -> bool:
        """Return whether a person is output: confirmed, and observed recently."""
        rules = self.config.hypotheses
        if self._is_outside(person):
            limit_s = rules.outside_s
        else:
            limit_s = rules.unverified_s if person.status in _HIDDEN_ONES else rules.missing_s
        return person.id > 0 and self.time_s - person.seen_s <= limit_s

    def _is_outside(self, person: Hypothesis) -> bool:
        """Return whether the middle of a person is outside the image."""
        left, _, width, _ = _body_box(self.view, person)
        return width <= 0.0 or not 0.0 <= left + width / 2.0 < self.view.depth.shape[1]

    def _measured(self, person: Hypothesis, detection: Detection, *, is_confident: bool) -> Hypothesis:
        rules, now = self.config.hypotheses, self.time_s
        is_verified = detection.is_verified
        share = rules.verified_share if is_verified else rules.pre_share
        return replace(
            person,
            place_m=_merged(person.place_m, detection.place_m, share),
            covariance_m2=self._error_m2(detection),
            body=self._learned(person, detection, is_confident=is_confident),
            filter=person.filter if is_confident else self._spread(detection),
            verified_s=now if is_verified else person.verified_s,
            verifications=person.verifications + is_verified,
        )

    def _walking(self, person: Hypothesis, expected: Floats, *, is_seen: bool) -> Hypothesis:
        """Update the velocity from the innovation; an unobserved person slows down."""
        if is_seen:
            off = (person.place_m - expected) / max(self.dt_s, 1e-3)
            return replace(person, velocity_m_s=person.velocity_m_s + _GAIN * off, seen_s=self.time_s)
        slowed = person.velocity_m_s * math.exp(-self.dt_s / _SLOWS_S)
        filtered = FloorFilter.begin(person.place_m, self.config.filter, self.rng)
        return replace(person, velocity_m_s=slowed, filter=filtered)

    def _spread(self, detection: Detection) -> FloorFilter:
        return FloorFilter.begin(detection.place_m, self.config.filter, self.rng)

    def _learned(self, person: Hypothesis, detection: Detection, *, is_confident: bool) -> Body:
        """Update size and appearance, slowly (SA eq. 4.29)."""
        old, new = person.body, detection.body
        rate = self.config.filter.learning_rate if is_confident and detection.is_verified else 0.0
        return Body(
            width_m=old.width_m + _SIZE_SHARE * (new.width_m - old.width_m),
            head_m=old.head_m + _SIZE_SHARE * (new.head_m - old.head_m),
            low_m=old.low_m + _SIZE_SHARE * (new.low_m - old.low_m),
            appearance=old.appearance + rate * (new.appearance - old.appearance),
        )

    def _judged(self, person: Hypothesis, update: Update, *, is_seen: bool) -> Hypothesis:
        """Return the visibility of a person, and whether the background is visible."""
        at = look_at(self.view, person.place_m[None], person.body, 0.0)
        nearer, beyond = float(at.nearer[0]), float(at.beyond[0])
        through = person.seen_through + 1 if not is_seen and beyond > _SEEN_THROUGH else 0
        if not person.id:
            status = Status.TENTATIVE
        elif not is_seen and nearer > _HIDDEN:
            status = Status.TOTALLY_OCCLUDED
        elif nearer > _PARTLY_HIDDEN:
            status = Status.PARTLY_OCCLUDED
        else:
            status = Status.TRACKED
        confidence = max(update.confidence, 0.5 if self.time_s == person.verified_s else 0.0)
        return replace(person, seen_through=through, status=status, confidence=min(confidence, 1.0))

    def _error_m2(self, detection: Detection) -> Floats:
        """Return the covariance (2, 2) of a detection's position: sensor noise along the ray, and gait."""
        ray = detection.place_m / max(float(np.hypot(*detection.place_m)), 1e-6)
        along = (_DEPTH_SD * detection.found.z_m**2) ** 2
        return np.eye(2) * _FLOOR_SD_M**2 + np.outer(ray, ray) * along


def _body_box(view: RgbdView, person: Hypothesis) -> Box:
    body = person.body
    return box_at(view.geometry, person.place_m, body.width_m, body.head_m, body.low_m)


def _merged(old: Floats, new: Floats, share: float) -> Floats:
    return np.asarray(old + share * (new - old))


def occluder_of(person: Hypothesis, others: Sequence[Hypothesis], view: RgbdView) -> int | None:
    """Return the id of the nearer person who covers a person most."""
    if person.status not in _HIDDEN_ONES:
        return None
    left, _, width, _ = _body_box(view, person)
    best, most = None, 0.0
    for other in others:
        if other.id in (0, person.id) or other.place_m[0] >= person.place_m[0] - 0.2:
            continue
        start, _, wide, _ = _body_box(view, other)
        common = min(left + width, start + wide) - max(left, start)
        if common > most:
            best, most = other.id, common
    return best


# Association of detections with tracks.

_NEVER = 1e6
_BETWEEN_FRAMES_S = 0.1


def associate(
    people: Sequence[Hypothesis], detections: Sequence[Detection], time_s: float, config: HypothesesConfig
) -> dict[int, int]:
    """Match people and detections one to one, at least total distance (SA 4.5).

    A different appearance adds to the distance. The gate grows with depth, and with the time since the last
    observation.

    Args:
        people: N predicted people.
        detections: M.
        time_s: current time [s].
        config: settings.

    Returns:
        Index of the detection by index of the person.
    """
    if not people or not detections:
        return {}
    cost = np.full((len(people), len(detections)), _NEVER)
    for row, person in enumerate(people):
        for column, detection in enumerate(detections):
            apart = float(np.hypot(*(detection.place_m - person.place_m)))
            gate = _gate_m(person, detection, time_s, config)
            if apart < gate:
                unlike = 1.0 - similarity(person.body.appearance, detection.body.appearance)
                # Confirmed people go first.
                doubt = 0.0 if person.id else 0.5
                cost[row, column] = apart / gate + config.appearance_weight * unlike + doubt
    rows, columns = linear_sum_assignment(cost)
    return {int(r): int(c) for r, c in zip(rows, columns, strict=True) if cost[r, c] < _NEVER}


def _gate_m(person: Hypothesis, detection: Detection, time_s: float, config: HypothesesConfig) -> float:
    unseen_m = config.gate_m_s * max(time_s - person.seen_s - _BETWEEN_FRAMES_S, 0.0)
    return config.gate_m + config.gate_per_m * detection.found.z_m**2 + min(unseen_m, config.gate_m)
