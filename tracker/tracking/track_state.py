"""State of one track of the people tracker, confirmed or tentative."""

import math
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.track import Status
from peopleboy.tracker.tracking.appearance import FEATURES, Colours, Pattern, blend_colours, colour_similarity
from peopleboy.tracker.tracking.config import ExistenceConfig
from peopleboy.tracker.tracking.motion_filter import StateEstimates

_POSTURE_LASTS_S: Final = 3.0  # mean time until a person changes the posture
_POSTURE_GAIN: Final = 0.4  # on log-odds: consecutive images are similar


class Continuation(NamedTuple):
    """Provisional continuation of a lost track, until the clear appearances of both are compared.

    Attributes:
        lost: the lost track.
        last_seen: its state (1) of the motion filter when it was last detected.
        time_s: when the track continued it.
    """

    lost: "TrackState"
    last_seen: StateEstimates
    time_s: float


class DetectionEvidence(NamedTuple):
    """A detection of a tracked person.

    Attributes:
        score: log-odds of the detection.
        shared: share of its box that overlaps an existing track, 0 to 1.
        speed_m_s: speed of the person.
    """

    score: float
    shared: float
    speed_m_s: float


@dataclass(slots=True, kw_only=True, eq=False)
class TrackState:
    """State of a track apart from its motion filter.

    Attributes:
        key: number of the track within the tracker, for its whole life.
        born_s: time of the first detection.
        seen_s: time of the last detection by any sensor.
        pattern: thermal appearance.
        colours: colours of the clothes; 0 where unknown.
        ratio: width of the box divided by its height.
        existence: settings of the sensor that detected it last.
        shown: time [s] and box (4,) [px] of the last detection, by camera.
        watched_s: total time with detections.
        log_odds: evidence that it is a person.
        surest: greatest evidence of a single image.
        id: 0 as long as it is tentative.
        sightings: number of images with a detection.
        confidence: 0..1, from the last images with a detection.
        occluder: id of the track that occludes it.
        is_hidden: whether that track or a thing hides the person.
        is_pinned: whether it stopped behind that, as the person would be visible otherwise.
        present_s: when some of the hidden person was last visible where it is predicted.
        confirmed_s: time of the confirmation.
        recent: colours since the person was last seen apart from others.
        clear_s: how long the person has been seen apart from others.
        separate_s: when the person was last seen apart from others.
        posture: (5,) log-odds of the postures, up to a constant; None if no sensor recognises them.
        common_m: (2,) deviation of the position across and along the line of sight that further images do not
            reduce.
        continuation: of a lost track, as long as it is provisional.
        not_ids: ids whose continuation was ended as a mistake.
        edges: (2,) left and right edge of the whole person, from the middle of the box, in its heights; NaN
            if unknown.
    """

    key: int
    born_s: float
    seen_s: float
    pattern: Pattern
    colours: Colours
    ratio: float
    existence: ExistenceConfig
    shown: dict[str, tuple[float, Floats]]
    watched_s: float = 0.0
    log_odds: float = 0.0
    surest: float = -math.inf
    id: int = 0
    sightings: int = 1
    confidence: float = 0.5
    occluder: int | None = None
    confirmed_s: float = math.inf
    is_hidden: bool = False
    is_pinned: bool = False
    present_s: float = -math.inf
    recent: Colours = field(default_factory=lambda: np.zeros(FEATURES, np.float32))
    clear_s: float = 0.0
    separate_s: float = -math.inf
    posture: Floats | None = None
    common_m: Floats = field(default_factory=lambda: np.zeros(2))
    continuation: Continuation | None = None
    not_ids: frozenset[int] = frozenset()
    edges: Floats = field(default_factory=lambda: np.full(2, math.nan))

    @property
    def is_confirmed(self) -> bool:
        """Whether the track is confirmed."""
        return self.id > 0

    def update_seen(
        self, seen: DetectionEvidence, time_s: float, dt_s: float, config: ExistenceConfig
    ) -> None:
        """Update the evidence with a detection by a sensor of these settings."""
        self.existence = config
        self.seen_s, self.occluder = time_s, None
        self.is_hidden = self.is_pinned = False
        self.sightings += 1
        self.watched_s += dt_s
        doubt = 0.0 if self.is_confirmed else config.shared_doubt * seen.shared
        self.surest = max(self.surest, seen.score - doubt)
        evidence = min(seen.score, config.highest_score) - doubt
        independent_per_s = min(
            1.0 / config.independent_s, 1.0 / config.still_s + seen.speed_m_s / config.look_m
        )
        sum_of_both = self.log_odds + evidence * independent_per_s * dt_s
        evidence_gain = self.log_odds + config.evidence_gain * (evidence - self.log_odds)
        self.log_odds = min(max(sum_of_both, evidence_gain, -config.highest), config.highest)
        self.confidence += config.learning * (1.0 / (1.0 + math.exp(-seen.score)) - self.confidence)

    def is_lost(self, time_s: float, lost_s: float) -> bool:
        """Return whether a confirmed track has not been detected for some time."""
        return self.is_confirmed and self.seen_s < time_s - lost_s

    def update_box(self, camera: str, box: Floats, *, has_width: bool) -> None:
        """Update the box (4,) in a camera's image and, if measured, the width relative to the height."""
        self.shown[camera] = self.seen_s, box
        if has_width:
            self.ratio += self.existence.learning * (float(box[2] / box[3]) - self.ratio)

    def update_edges(self, edges: Floats, learning: float) -> None:
        """Update the edges (2,) of the whole person, unless they are unknown."""
        if not np.isnan(edges).any():
            self.edges = edges if np.isnan(self.edges).any() else self.edges + learning * (edges - self.edges)

    def update_posture(self, log_odds: Floats, dt_s: float) -> None:
        """Update the postures with the log-odds (5,) of one image: a hidden Markov model's filter."""
        if self.posture is None:
            self.posture = np.zeros(len(log_odds))
        changes = -math.expm1(-dt_s / _POSTURE_LASTS_S) / len(log_odds)
        before = np.exp(self.posture - self.posture.max())
        mixed = before / before.sum() * (1.0 - changes * len(log_odds)) + changes
        self.posture = np.log(mixed) + _POSTURE_GAIN * log_odds

    def mark_separate(self, time_s: float, dt_s: float) -> None:
        """Record that the person is seen apart from others now, by one sensor or several."""
        if self.separate_s < time_s:
            self.clear_s, self.separate_s = self.clear_s + dt_s, time_s

    def update_appearance(self, pattern: Pattern, colours: Colours) -> None:
        """Update the appearance of a person who is seen apart from others."""
        config = self.existence
        if pattern.any():
            self.pattern = self.pattern + np.float32(config.learning) * (pattern - self.pattern)
        self.recent = blend_colours(self.recent, colours, config.learning_recent)
        if not self.colours.any() or colour_similarity(self.recent, self.colours) > config.own_colours:
            self.colours = blend_colours(self.colours, colours, max(config.learning, 1.0 / self.sightings))

    def mark_overlapping(self) -> None:
        """Record that the person is not seen apart from others now."""
        self.clear_s, self.recent = 0.0, np.zeros_like(self.recent)

    def inherit(self, before: "TrackState") -> None:
        """Continue a lost track as this one."""
        self.id, self.born_s = before.id, before.born_s
        self.confirmed_s = min(self.confirmed_s, before.confirmed_s)
        learning = self.existence.learning
        self.colours = blend_colours(before.colours, self.colours, learning)
        self.pattern = before.pattern + np.float32(learning) * (self.pattern - before.pattern)
        self.watched_s += before.watched_s
        self.log_odds = max(self.log_odds, before.log_odds)
        before.id, before.seen_s = 0, -math.inf

    def begin_again(self) -> None:
        """End a mistaken continuation: the track is of another person, and tentative again."""
        assert self.continuation is not None
        lost, _, time_s = self.continuation
        self.not_ids |= {lost.id}
        self.id, self.born_s, self.confirmed_s = 0, time_s, math.inf
        self.colours, self.watched_s = self.recent, self.watched_s - lost.watched_s
        self.continuation = None

    def recognise(self, number: int, colours: Colours) -> None:
        """Continue a person of an earlier run, of this id and these colours, as this track."""
        self.id, self.confirmed_s = number, -math.inf
        self.colours = blend_colours(colours, self.colours, self.existence.learning)
        self.log_odds = max(self.log_odds, self.existence.confirmed)

    def update_missed(self, occluder: int | None, dt_s: float, *, is_hidden: bool) -> None:
        """Record a missed detection, the possible occluder, and whether something hides the person.

        However long a confirmed person is not found, one detection restores the track.
        """
        config = self.existence
        self.occluder, self.is_hidden = occluder, is_hidden or occluder is not None
        loss = config.missed_hidden if self.is_hidden else config.missed
        least = min(self.log_odds, config.deletion_log_odds) if self.is_confirmed else -math.inf
        self.log_odds = max(self.log_odds - loss * dt_s / config.independent_s, least)

    def update_absent(self, dt_s: float) -> None:
        """Record that the background is visible where the track is predicted."""
        self.log_odds -= self.existence.absent * dt_s / self.existence.independent_s

    def status(self, time_s: float) -> Status:
        """Return the current status."""
        if not self.is_confirmed:
            return Status.TENTATIVE
        if self.seen_s >= time_s:
            return Status.TRACKED
        return Status.TOTALLY_OCCLUDED if self.is_hidden else Status.PARTLY_OCCLUDED

    def is_output(self, time_s: float, overlap: float) -> bool:
        """Return whether the track is still reported at its predicted position.

        Args:
            time_s: current time.
            overlap: IoU of its box with that of a person who is seen, and so may hide this one.
        """
        config = self.existence
        doubt = config.max_coast_s
        if self.is_hidden:
            is_covered = overlap >= config.covered
            longest_s = config.max_coast_covered_s if is_covered else config.max_coast_occluded_s
            doubt = max(doubt, min(longest_s, config.coast_occluded_share * self.watched_s))
        return (
            self.is_confirmed
            and self.log_odds > config.deletion_log_odds
            and time_s - max(self.seen_s, self._visible_s()) <= doubt
        )

    def _visible_s(self) -> float:
        """Return when some of a hidden person was last visible, not too long after a detection."""
        if not self.is_hidden:
            return -math.inf
        return min(self.present_s, self.seen_s + self.existence.max_present_s)

    def is_deleted(self, time_s: float) -> bool:
        """Return whether the track is deleted: it could not be reidentified."""
        config = self.existence
        gone = time_s - self.seen_s
        if not self.is_confirmed:
            return self.log_odds < config.deletion_log_odds or gone > config.max_coast_s
        return gone > (config.forget_s if self.watched_s > config.brief_s else config.brief_forget_s)

    def has_enough_evidence(self) -> bool:
        """Return whether there is enough evidence for confirmation."""
        config = self.existence
        is_enough = self.sightings >= config.sightings or self.surest >= config.at_once
        return is_enough and self.log_odds > config.confirmed
