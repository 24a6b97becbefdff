"""What is said about how a person takes to the robot, and what is refused."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from peopleboy.bad_input import BadInput

Way = Literal["ignores", "makes_way", "curious", "wary", "blocks", "surprised"]

FROM_M: Final = (0.8, 20.0)
KEEP_M: Final = (0.6, 8.0)
LASTS_S: Final = (0.2, 600.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reaction:
    """How a person takes to the robot; a distance or time that its way does not ask for is 0.

    Distances are between the middles of person and robot, on the floor.

    Attributes:
        way: one of USUAL.
        from_m: [m] it begins when the robot is so near and in sight, and ends a metre farther off.
        keep_m: [m] the distance that the person keeps: at least (makes_way, wary), or about (curious,
            blocks).
        lasts_s: [s] how long it looks (curious), stands (surprised) or is in the way (blocks).

    Raises:
        BadInput: a value out of its limits, or that the way does not ask for.
    """

    way: Way
    from_m: float = 0.0
    keep_m: float = 0.0
    lasts_s: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if self.way not in USUAL:
            raise BadInput(f"reacts: {self.way!r} must be one of {', '.join(USUAL)}")
        for key, (low, high) in (("from_m", FROM_M), ("keep_m", KEEP_M), ("lasts_s", LASTS_S)):
            value = getattr(self, key)
            if key not in USUAL[self.way]:
                if value:
                    raise BadInput(f"reacts: {key} {value!r}: a person who {WORDS[self.way]} takes none")
            elif not low <= value <= high:
                raise BadInput(f"reacts: {key} {value!r} must be {low} .. {high}")
        if self.from_m < self.keep_m:
            raise BadInput(f"reacts: keep_m {self.keep_m!r} must be at most from_m, {self.from_m!r}")


# What a way asks for, and what is usual: a personal distance of 1.2 m (E. T. Hall, The Hidden Dimension,
# 1966) to stand before somebody or to pass; the rest is our choice.
USUAL: Final[Mapping[Way, Mapping[str, float]]] = {
    "ignores": {},
    "makes_way": {"from_m": 4.0, "keep_m": 1.2},
    "curious": {"from_m": 5.0, "keep_m": 1.2, "lasts_s": 5.0},
    "wary": {"from_m": 5.0, "keep_m": 2.5},
    "blocks": {"from_m": 4.0, "keep_m": 1.0, "lasts_s": 5.0},
    "surprised": {"from_m": 3.0, "lasts_s": 2.5},
}
WORDS: Final[Mapping[Way, str]] = {
    "ignores": "ignores the robot",
    "makes_way": "makes way for it",
    "curious": "is curious",
    "wary": "is wary",
    "blocks": "blocks its way",
    "surprised": "is surprised",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Lead:
    """How a person leads the robot along its path.

    Attributes:
        waits_beyond_m: [m] a robot farther away has fallen behind: the person stops, turns to it and calls.
        goes_on_within_m: [m] the person goes on when it is so near again.
        at_most_s: [s] after which the person goes on anyway, and does not wait until it was near again.

    Raises:
        BadInput: a value out of its limits.
    """

    waits_beyond_m: float = 4.5
    goes_on_within_m: float = 3.5
    at_most_s: float = 20.0

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if not FROM_M[0] <= self.goes_on_within_m < self.waits_beyond_m <= FROM_M[1]:
            raise BadInput(
                f"leads: goes_on_within_m {self.goes_on_within_m!r} must be {FROM_M[0]} or more, and less "
                f"than waits_beyond_m, {self.waits_beyond_m!r}"
            )
        if not LASTS_S[0] <= self.at_most_s <= LASTS_S[1]:
            raise BadInput(f"leads: at_most_s {self.at_most_s!r} must be {LASTS_S[0]} .. {LASTS_S[1]}")
