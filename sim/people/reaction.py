"""The settings of how a person reacts to the robot, and of how one leads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Final, Literal

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.settings import check_limits

Way = Literal["ignores", "makes_way", "curious", "wary", "blocks", "surprised"]
Meeting = Annotated[float, Field(ge=0.8, le=20.0)]
Lasting = Annotated[float, Field(ge=0.2, le=600.0)]

# What each reaction takes, and its usual value: a personal distance of 1.2 m (E. T. Hall, The Hidden
# Dimension, 1966) to stand before a person or to pass; the rest is our choice.
USUAL: Final[Mapping[Way, Mapping[str, float]]] = {
    "ignores": {},
    "makes_way": {"from_m": 4.0, "keep_m": 1.2},
    "curious": {"from_m": 5.0, "keep_m": 1.2, "lasts_s": 5.0},
    "wary": {"from_m": 5.0, "keep_m": 2.5},
    "blocks": {"from_m": 4.0, "keep_m": 1.0, "lasts_s": 5.0},
    "surprised": {"from_m": 3.0, "lasts_s": 2.5},
}
_WORDS: Final[Mapping[Way, str]] = {
    "ignores": "ignores the robot",
    "makes_way": "makes way for it",
    "curious": "is curious",
    "wary": "is wary",
    "blocks": "blocks its way",
    "surprised": "is surprised",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Reaction:
    """What a person does when the robot comes near, while nothing hides it; again at each encounter.

    Raises:
        BadInput: a value beyond its limits, or that this reaction does not take.
    """

    to: Annotated[Literal["robot"], Field(description="to whom")] = "robot"
    way: Annotated[
        Way,
        Field(
            alias="as",
            description="`ignores`: neither looks nor makes way, and stops only where it would walk into the "
            "robot; `makes_way`: walks round it, steps aside for one that comes, and looks at it; "
            "`curious`: walks up to it, looks at it for a while, and goes on; `wary`: keeps clear of it, "
            "walks away from one that comes nearer, and looks back at it; `blocks`: steps into its way, "
            "stands before it for a while, and goes on; `surprised`: stops and looks at it for a while, and "
            "goes on",
        ),
    ]
    from_m: Annotated[
        Meeting | None,
        Field(
            description="distance at which an encounter begins; it ends 1 m farther off; left out, 3 for "
            "`surprised`, 4 for `makes_way` and `blocks`, 5 for `curious` and `wary`; `ignores` takes none"
        ),
    ] = None
    keep_m: Annotated[
        float | None,
        Field(
            ge=0.6,
            le=8.0,
            description="distance kept between the middles of person and robot: at least, for `makes_way` "
            "(left out, 1.2) and `wary` (2.5); about, for `curious` (1.2) and `blocks` (1.0); others take "
            "none",
        ),
    ] = None
    lasts_s: Annotated[
        Lasting | None,
        Field(
            description="how long it looks (`curious`; left out, 5), is in the way (`blocks`; 5) or stands "
            "(`surprised`; 2.5); others take none"
        ),
    ] = None

    def __post_init__(self) -> None:
        """Refuse what this reaction does not take, and distances that contradict each other."""
        if self.way not in USUAL:
            raise BadInput(f"{self.way!r} must be one of {', '.join(USUAL)}", key=("as",))
        check_limits(self)
        for key in ("from_m", "keep_m", "lasts_s"):
            value = getattr(self, key)
            if value is not None and key not in USUAL[self.way]:
                raise BadInput(f"{key} {value:g}: a person who {_WORDS[self.way]} takes none; leave it out")
        if self.distance_m > self.begins_m:
            raise BadInput(f"keep_m {self.distance_m:g} must be at most from_m, {self.begins_m:g}")

    @property
    def begins_m(self) -> float:
        """[m] distance at which an encounter begins; 0 if this reaction has none."""
        return self._value("from_m")

    @property
    def distance_m(self) -> float:
        """[m] distance that the person keeps; 0 if it keeps none."""
        return self._value("keep_m")

    @property
    def duration_s(self) -> float:
        """[s] how long the person looks, stands or blocks; 0 if it does not."""
        return self._value("lasts_s")

    def _value(self, key: str) -> float:
        value: float | None = getattr(self, key)
        return USUAL[self.way].get(key, 0.0) if value is None else value


@dataclass(frozen=True, slots=True, kw_only=True)
class Lead:
    """How a person leads the robot along its path: it looks back now and then, and waits, calling.

    Raises:
        BadInput: a value beyond its limits.
    """

    follower: Annotated[Literal["robot"], Field(description="what is led")] = "robot"
    waits_beyond_m: Annotated[
        Meeting,
        Field(
            description="a robot farther away has fallen behind: the person stops, turns to it and calls it"
        ),
    ] = 4.5
    goes_on_within_m: Annotated[
        Meeting, Field(description="the person goes on when the robot is so near again")
    ] = 3.5
    at_most_s: Annotated[
        Lasting, Field(description="after which the person goes on without it, until it has been near again")
    ] = 20.0

    def __post_init__(self) -> None:
        """Refuse distances that contradict each other."""
        check_limits(self)
        if self.goes_on_within_m >= self.waits_beyond_m:
            raise BadInput(
                f"goes_on_within_m {self.goes_on_within_m:g} must be less than waits_beyond_m, "
                f"{self.waits_beyond_m:g}"
            )
