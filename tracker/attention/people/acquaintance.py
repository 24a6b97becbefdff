"""A person who is known by its looks, and a track that somebody may wear."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Generic

import numpy as np

from peopleboy.tracker.attention.people.attentive_config import AttentiveConfig
from peopleboy.tracker.attention.people.recogniser import Look, Recogniser, Seen

_OF_LATE: Final = 0.05  # share of the newest image in the usual score


@dataclass(slots=True)
class Acquaintance(Generic[Look]):
    """A person as it looked.

    Attributes:
        number: of the person's tracks.
        looks: by camera.
        images: in which it was learned, by camera.
        usual: score that it has of late while it is there.
        seen_s: [s] when it was seen last.
    """

    number: int
    looks: dict[str, Look] = field(default_factory=dict)
    images: dict[str, int] = field(default_factory=dict)
    usual: float = 0.0
    seen_s: float = -np.inf

    def is_known(self, config: AttentiveConfig) -> bool:
        """Tell whether enough was seen of the person to know it again."""
        return max(self.images.values(), default=0) >= config.learned_images

    def score(self, seen: Mapping[str, Seen], recogniser: Recogniser[Look, Seen]) -> float | None:
        """Score somebody who is seen, by camera; None where none saw both."""
        scores = [
            recogniser.score(self.looks[camera], one) for camera, one in seen.items() if camera in self.looks
        ]
        return float(np.mean(scores)) if scores else None

    def needed(self, config: AttentiveConfig) -> float:
        """Give the score from which on somebody new is this person: who always looks the same must do so."""
        return max(config.accept, self.usual - config.slack)

    def note(self, score: float) -> None:
        """Take in the score of an image in which the person is there."""
        self.usual += _OF_LATE * (score - self.usual) if self.usual else score

    def learn(
        self, seen: Mapping[str, Seen], recogniser: Recogniser[Look, Seen], config: AttentiveConfig
    ) -> None:
        """Take in what is seen of the person: of the first images all alike, of later ones little."""
        for camera, one in seen.items():
            count = self.images[camera] = self.images.get(camera, 0) + 1
            rate = 1.0 / count if count <= config.first_images else config.rate
            self.looks[camera] = recogniser.learned(self.looks.get(camera), one, rate)


@dataclass(slots=True)
class Wearer:
    """A track of the tracker below, and who that is.

    Attributes:
        number: of the person; None for one who is known to be elsewhere.
        since_s: [s] since when it has been this track without a longer break.
        seen_s: [s] when it was seen last.
        is_new: whether it may still turn out to be somebody who was lost.
        scores: of late, by the number of those that it may be; its own among them.
    """

    number: int | None
    since_s: float
    seen_s: float
    is_new: bool = True
    scores: dict[int, deque[float]] = field(default_factory=dict)

    def note(self, number: int, score: float, most: int) -> None:
        """Remember a score."""
        self.scores.setdefault(number, deque(maxlen=most)).append(score)

    def mean(self, number: int, least: int) -> float | None:
        """Give the mean of the newest scores; None if there are too few."""
        scores = self.scores.get(number, ())
        return float(np.mean(scores)) if len(scores) >= least else None
