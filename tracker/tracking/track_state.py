"""A person who is followed, or who may be one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.track import Status
from peopleboy.tracker.tracking.appearance import FEATURES, Colours, Pattern, blend_colours, colour_similarity
from peopleboy.tracker.tracking.config import ExistenceConfig
from peopleboy.tracker.tracking.template import Template

_LEARNING: Final = 0.1  # share of what is seen now in what is remembered
_LEARNING_SOON: Final = 0.2  # the same of what is compared with it
_OWN: Final = 0.6  # Bhattacharyya's coefficient above which it looks like itself


class DetectionEvidence(NamedTuple):
    """A person was found.

    Attributes:
        score: log odds of the detection.
        shared: how much of its box is of a person known, too, 0 to 1.
        speed_m_s: how fast this one goes.
    """

    score: float
    shared: float
    speed_m_s: float


@dataclass(slots=True, kw_only=True, eq=False)
class TrackState:
    """What is known of a person besides the path.

    Attributes:
        born_s: when it was first seen.
        seen_s: when it was last.
        pattern: how it looks in the thermal image.
        colours: what it wears; 0 where nobody knows.
        ratio: width of its box over the height.
        shown: (4,) its box in the image in which it was last seen [px].
        watched_s: for how long it was seen in all.
        trees: log odds by the detector's trees alone, when it was last found among all.
        score: log odds of the detection when the detector last found it.
        rescored_s: when that was.
        template: what it looked like then.
        searched_s: when trees last found it among all.
        log_odds: that it is a person.
        surest: most that a single image said.
        id: 0 as long as it is tentative.
        sightings: images in which it was found.
        confidence: 0..1, of the last images in which it was seen.
        occluder: id of who hides it.
        confirmed_s: since when it is confirmed.
        recent: what it wears since it was last seen apart from others.
        clear_s: for how long that is.
    """

    born_s: float
    seen_s: float
    pattern: Pattern
    colours: Colours
    ratio: float
    shown: Floats
    watched_s: float = 0.0
    trees: float = 0.0
    score: float = 0.0
    rescored_s: float = -math.inf
    template: Template | None = None
    searched_s: float = -math.inf
    log_odds: float = 0.0
    surest: float = -math.inf
    id: int = 0
    sightings: int = 1
    confidence: float = 0.5
    occluder: int | None = None
    confirmed_s: float = math.inf
    recent: Colours = field(default_factory=lambda: np.zeros(FEATURES, np.float32))
    clear_s: float = 0.0

    @property
    def is_confirmed(self) -> bool:
        """Whether it is believed to be a person."""
        return self.id > 0

    def update_seen(
        self, seen: DetectionEvidence, time_s: float, dt_s: float, config: ExistenceConfig
    ) -> None:
        """Take in that it was found."""
        self.seen_s, self.occluder = time_s, None
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
        self.confidence += _LEARNING * (1.0 / (1.0 + math.exp(-seen.score)) - self.confidence)

    def update_box(self, box: Floats) -> None:
        """Take in its box (4,), and how wide that is over the height."""
        self.shown = box
        self.ratio += _LEARNING * (float(box[2] / box[3]) - self.ratio)

    def mark_separate(self, dt_s: float) -> None:
        """Take in that it is seen apart from others now."""
        self.clear_s += dt_s

    def update_appearance(self, pattern: Pattern, colours: Colours) -> None:
        """Take in how it looks now, apart from others."""
        self.pattern = self.pattern + np.float32(_LEARNING) * (pattern - self.pattern)
        self.recent = blend_colours(self.recent, colours, _LEARNING_SOON)
        if not self.colours.any() or colour_similarity(self.recent, self.colours) > _OWN:
            self.colours = blend_colours(self.colours, colours, max(_LEARNING, 1.0 / self.sightings))

    def mark_overlapping(self) -> None:
        """Take in that it is not seen apart from others now."""
        self.clear_s, self.recent = 0.0, np.zeros_like(self.recent)

    def inherit(self, before: TrackState) -> None:
        """Go on as a person who was lost, and is no more."""
        self.id, self.born_s = before.id, before.born_s
        self.confirmed_s = min(self.confirmed_s, before.confirmed_s)
        self.colours = blend_colours(before.colours, self.colours, _LEARNING)
        self.pattern = before.pattern + np.float32(_LEARNING) * (self.pattern - before.pattern)
        self.watched_s += before.watched_s
        self.log_odds = max(self.log_odds, before.log_odds)
        before.id, before.seen_s = 0, -math.inf

    def update_missed(self, occluder: int | None, dt_s: float, config: ExistenceConfig) -> None:
        """Take in that it was not found, and who may hide it.

        However long a person known is not found, the first image that says so brings him back.
        """
        self.occluder = occluder
        loss = config.missed if occluder is None else config.missed_hidden
        least = min(self.log_odds, config.deletion_log_odds) if self.is_confirmed else -math.inf
        self.log_odds = max(self.log_odds - loss * dt_s / config.independent_s, least)

    def status(self, time_s: float) -> Status:
        """Return how well it is seen now."""
        if not self.is_confirmed:
            return Status.TENTATIVE
        if self.seen_s >= time_s:
            return Status.TRACKED
        return Status.PARTLY_OCCLUDED if self.occluder is None else Status.TOTALLY_OCCLUDED

    def is_output(self, time_s: float, config: ExistenceConfig) -> bool:
        """Return whether it is still said to be where it is expected."""
        doubt = config.max_coast_s
        if self.occluder is not None:
            doubt = max(doubt, min(config.max_coast_occluded_s, config.coast_occluded_share * self.watched_s))
        return (
            self.is_confirmed and self.log_odds > config.deletion_log_odds and time_s - self.seen_s <= doubt
        )

    def is_deleted(self, time_s: float, config: ExistenceConfig) -> bool:
        """Return whether it would not be known again."""
        gone = time_s - self.seen_s
        if not self.is_confirmed:
            return self.log_odds < config.deletion_log_odds or gone > config.max_coast_s
        return gone > (config.forget_s if self.watched_s > config.brief_s else config.brief_forget_s)

    def has_enough_evidence(self, config: ExistenceConfig) -> bool:
        """Return whether it has enough evidence to be confirmed."""
        is_enough = self.sightings >= config.sightings or self.surest >= config.at_once
        return is_enough and self.log_odds > config.confirmed
