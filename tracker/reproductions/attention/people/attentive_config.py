"""Settings of the re-identification of lost people."""

from dataclasses import dataclass, fields
from typing import Final

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class AttentiveConfig:
    """How appearance is learned, and the similarity required for re-identification.

    Attributes:
        accept: least mean score for a new person to be a lost one ...
        slack: ... unless it is lower than the lost person's usual score by more than this.
        reject: mean score below which the tracker's identity is rejected.
        images: that scores are averaged over ...
        least_images: ... and their least number.
        learned_images: least number of learned images for re-identification.
        first_images: that are weighted equally; later ones have less weight.
        rate: update rate of later images.
        doubt: score below which the appearance is not updated.
        doubtful_images: number of images below that score after which a person is a stranger.
        gap_s: [s] out of sight after which the appearance is compared again ...
        proof_s: [s] ... and after which the tracker's id is not trusted.
        remembered_s: [s] after which a lost person is forgotten.

    Raises:
        BadInput: a value out of range.
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
        """Check the values."""
        for name in ("accept", "slack", "reject", "rate", "doubt"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise BadInput(f"AttentiveConfig: {name} must be in 0..1, got {getattr(self, name)}")
        for name in (field.name for field in fields(self)):
            if not getattr(self, name) >= 0:
                raise BadInput(f"AttentiveConfig: {name} must be 0 or more, got {getattr(self, name)}")


AS_FOUND: Final = AttentiveConfig(accept=0.24, slack=1.0, reject=0.0, doubt=0.0)
"""For the focus of attention as printed: it may miss a person who is there, so a low score rejects nobody;
and if no feature speaks for the box, patterns alone give a score of a quarter."""
