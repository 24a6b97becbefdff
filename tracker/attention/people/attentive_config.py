"""When a person is taken for a person who was lost."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class AttentiveConfig:
    """How appearance is learned, and how similar it must be to be a person's.

    Attributes:
        accept: mean score from which on a person new may be a person who was lost ...
        slack: ... if it is not so much below the one that this person usually had.
        reject: mean score below which a person is not who the tracker below takes him for.
        images: that scores are averaged over ...
        least_images: ... and how many there must be at least.
        learned_images: in which a person must have been seen to be known again.
        first_images: that count alike; later ones count less.
        rate: share of a new image that is learned then.
        doubt: score below which nothing is learned.
        doubtful_images: in which a person must have looked otherwise than that to be a stranger.
        gap_s: [s] out of sight from which on appearance is compared anew ...
        proof_s: [s] ... and from which on the number of the tracker below is no proof any more.
        remembered_s: [s] for which people are remembered.

    Raises:
        BadInput: a number out of its range.
    """

    accept: float = 0.62
    slack: float = 0.2
    reject: float = 0.45
    images: int = 8
    least_images: int = 2
    learned_images: int = 5
    first_images: int = 15
    rate: float = 0.02
    doubt: float = 0.6
    doubtful_images: int = 4
    gap_s: float = 0.5
    proof_s: float = 2.0
    remembered_s: float = 600.0

    def __post_init__(self) -> None:
        """Refuse what cannot be done."""
        for name in ("accept", "slack", "reject", "rate", "doubt"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise BadInput(f"AttentiveConfig: {name} must be in 0..1, got {getattr(self, name)}")
        for name in (field.name for field in fields(self)):
            if not getattr(self, name) >= 0:
                raise BadInput(f"AttentiveConfig: {name} must be 0 or more, got {getattr(self, name)}")


AS_FOUND: Final = AttentiveConfig(accept=0.24, slack=1.0, reject=0.0, doubt=0.0)
"""For the focus of attention as printed: it can be elsewhere while a person is there, so that nobody is
doubted for that; and where no feature speaks for the box, patterns alone make a score of a quarter."""
