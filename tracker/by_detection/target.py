"""A person who is followed, or who may be one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from peopleboy.tracker.by_detection.colours import Colours
from peopleboy.tracker.by_detection.config import ExistenceConfig
from peopleboy.tracker.by_detection.looks import Pattern
from peopleboy.tracker.by_detection.paths import Floats
from peopleboy.tracker.track import Status

_LEARNING: Final = 0.1  # share of what is seen now in what is remembered
_LEAST_SIGHTINGS: Final = 3


@dataclass(slots=True, kw_only=True)
class Target:
    """What is known of somebody besides the path.

    Attributes:
        born_s: when it was first seen.
        seen_s: when it was last.
        looks: how it looks in the thermal image.
        colours: what it wears; 0 where nobody knows.
        ratio: width of its box over the height.
        origin_m: (3,) where it stood first, in the level frame of now.
        watched_s: for how long it was seen in all.
        log_odds: that it is a person.
        id: 0 as long as it is not told.
        sightings: images in which it was found.
        confidence: 0..1, of the last images in which it was seen.
        moved_m: how far from its origin it surely was at most.
        occluder: id of who hides it.
    """

    born_s: float
    seen_s: float
    looks: Pattern
    colours: Colours
    ratio: float
    origin_m: Floats
    watched_s: float = 0.0
    log_odds: float = 0.0
    id: int = 0
    sightings: int = 1
    confidence: float = 0.5
    moved_m: float = 0.0
    occluder: int | None = None

    @property
    def is_told(self) -> bool:
        """Whether it is believed to be a person."""
        return self.id > 0

    def see(self, score: float, ratio: float, shared: float, time_s: float, dt_s: float, config: ExistenceConfig) -> None:
        """Take in that it was found with a score, and a box so wide."""
        self.seen_s, self.occluder = time_s, None
        self.sightings += 1
        self.watched_s += dt_s
        self.ratio += _LEARNING * (ratio - self.ratio)
        doubt = 0.0 if self.moved_m > config.moved_m else config.still_doubt
        if not self.is_told:
            doubt += config.shared_doubt * shared
        evidence = (min(score + config.lean, config.highest_score) - doubt) * dt_s / config.independent_s
        self.log_odds = min(self.log_odds + evidence, config.highest)
        self.confidence += _LEARNING * (1.0 / (1.0 + math.exp(-score)) - self.confidence)

    def learn(self, looks: Pattern, colours: Colours) -> None:
        """Take in how it looks now."""
        self.looks = self.looks + np.float32(_LEARNING) * (looks - self.looks)
        if colours.any():
            before = self.colours if self.colours.any() else colours
            self.colours = before + np.float32(_LEARNING) * (colours - before)

    def miss(self, occluder: int | None, dt_s: float, config: ExistenceConfig) -> None:
        """Take in that it was not found, and who may hide it."""
        self.occluder = occluder
        loss = config.missed if occluder is None else config.missed_hidden
        self.log_odds -= loss * dt_s / config.independent_s

    def status(self, time_s: float) -> Status:
        """Tell how well it is seen now."""
        if not self.is_told:
            return Status.TENTATIVE
        if self.seen_s >= time_s:
            return Status.TRACKED
        return Status.PARTLY_OCCLUDED if self.occluder is None else Status.TOTALLY_OCCLUDED

    def is_shown(self, time_s: float, config: ExistenceConfig) -> bool:
        """Tell whether it is still said to be where it is expected."""
        doubt = config.doubt_s if self.occluder is None else config.hidden_doubt_s
        return self.is_told and self.log_odds > config.hopeless and time_s - self.seen_s <= doubt

    def is_forgotten(self, time_s: float, config: ExistenceConfig) -> bool:
        """Tell whether it would not be known again."""
        gone = time_s - self.seen_s
        if not self.is_told:
            return self.log_odds < config.hopeless or gone > config.doubt_s
        return gone > (config.forget_s if self.watched_s > config.brief_s else config.brief_forget_s)

    def is_confirmed(self, config: ExistenceConfig) -> bool:
        """Tell whether enough speaks for it to be told."""
        return self.sightings >= _LEAST_SIGHTINGS and self.log_odds > config.confirmed
