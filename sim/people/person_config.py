"""The settings of one person: its path, its reaction to the robot, its actions on the way, and its body."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated, Final, Literal

from pydantic import Discriminator, Field, Tag

from peopleboy.bad_input import BadInput, found_in
from peopleboy.settings import Name, Point, Seconds, check_limits, word_or_list
from peopleboy.sim.people.body.anthropometry import Build, Sex
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.skeleton import Posture

Way = Literal["ignores", "makes_way", "curious", "wary", "blocks", "surprised"]
Meeting = Annotated[float, Field(ge=0.8, le=20.0)]
Lasting = Annotated[float, Field(ge=0.2, le=600.0)]

# Settings of each reaction, with their default values: a personal distance of 1.2 m (E. T. Hall, The Hidden
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
    """Reaction of a person to a robot that comes near and is in sight; it repeats at each encounter.

    Raises:
        BadInput: a value is out of range, or the reaction does not use it.
    """

    to: Annotated[Literal["robot"], Field(description="what the person reacts to")] = "robot"
    way: Annotated[
        Way,
        Field(
            alias="as",
            description="`ignores`: neither looks nor makes way, and stops only to avoid walking into the "
            "robot; `makes_way`: walks round it, steps aside when it approaches, and looks at it; "
            "`curious`: walks up to it, looks at it for a while, and goes on; `wary`: keeps clear of it, "
            "walks away when it approaches, and looks back at it; `blocks`: steps into its way, "
            "stands before it for a while, and goes on; `surprised`: stops and looks at it for a while, and "
            "goes on",
        ),
    ]
    from_m: Annotated[
        Meeting | None,
        Field(
            description="distance at which an encounter begins; it ends 1 m farther away; default 3 for "
            "`surprised`, 4 for `makes_way` and `blocks`, 5 for `curious` and `wary`; unused by `ignores`"
        ),
    ] = None
    keep_m: Annotated[
        float | None,
        Field(
            ge=0.6,
            le=8.0,
            description="distance between the centres of person and robot: the minimum for `makes_way` "
            "(default 1.2) and `wary` (2.5), approximate for `curious` (1.2) and `blocks` (1.0); unused by "
            "others",
        ),
    ] = None
    lasts_s: Annotated[
        Lasting | None,
        Field(
            description="how long the person looks (`curious`; default 5), blocks (`blocks`; 5) or stands "
            "(`surprised`; 2.5); unused by others"
        ),
    ] = None

    def __post_init__(self) -> None:
        """Refuse settings that the reaction does not use, and distances that contradict each other."""
        if self.way not in USUAL:
            raise BadInput(f"{self.way!r} must be one of {', '.join(USUAL)}", key=("as",))
        check_limits(self)
        for key in ("from_m", "keep_m", "lasts_s"):
            value = getattr(self, key)
            if value is not None and key not in USUAL[self.way]:
                raise BadInput(f"{key} {value:g}: not used by a person who {_WORDS[self.way]}; leave it out")
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
    """How a person leads the robot along its path: it looks back now and then, waits and calls.

    Raises:
        BadInput: a value is out of range.
    """

    follower: Annotated[Literal["robot"], Field(description="robot that follows")] = "robot"
    waits_beyond_m: Annotated[
        Meeting,
        Field(description="distance beyond which the person stops for the robot, turns to it and calls it"),
    ] = 4.5
    goes_on_within_m: Annotated[
        Meeting, Field(description="distance within which the robot has caught up and the person goes on")
    ] = 3.5
    at_most_s: Annotated[
        Lasting, Field(description="longest wait; the person then goes on until the robot has caught up")
    ] = 20.0

    def __post_init__(self) -> None:
        """Refuse distances that contradict each other."""
        check_limits(self)
        if self.goes_on_within_m >= self.waits_beyond_m:
            raise BadInput(
                f"goes_on_within_m {self.goes_on_within_m:g} must be less than waits_beyond_m, "
                f"{self.waits_beyond_m:g}"
            )


Arms = Literal["swinging", "crossed", "raised"]
PostureName = Literal[*Posture]  # type: ignore[valid-type]
Face = Annotated[Annotated[Name, Tag("word")] | Annotated[Point, Tag("list")], Discriminator(word_or_list)]

SPEEDS_M_S: Final = (0.1, 2.5)
_SAME_POINT_M: Final = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A point of a person's path."""

    at_m: Annotated[Point, Field(description="position")]
    speed_m_s: Annotated[
        float, Field(ge=SPEEDS_M_S[0], le=SPEEDS_M_S[1], description="walking speed on the way to this point")
    ] = 1.2
    pause_s: Annotated[Seconds, Field(description="how long the person stays there")] = 0.0
    face: Annotated[
        Face | None,
        Field(
            description="what the person faces in the pause: robot, another person's name, or a point; by "
            "default the direction stays"
        ),
    ] = None
    until_robot_within_m: Annotated[
        Meeting | None,
        Field(
            description="the pause also lasts until the robot is this near; without `face` the person faces "
            "the robot; by default it does not wait for the robot"
        ),
    ] = None
    waits_at_most_s: Annotated[
        float, Field(gt=0.0, le=3600.0, description="longest wait for the robot, after `pause_s`")
    ] = 60.0
    posture: Annotated[
        PostureName,
        Field(
            description="posture during the pause: `standing` upright, arms at the sides; `sitting` as on a "
            "chair, which may stand at that point; `bending` forward; `arms_raised`, both of them; "
            "`arms_crossed` in front of the chest; `calling` with one arm raised, which waves, until the "
            "robot is as near as `until_robot_within_m` says"
        ),
    ] = Posture.STANDING

    def __post_init__(self) -> None:
        """Refuse values that are out of range."""
        check_limits(self)
        for key in ("at_m", "face"):
            point = getattr(self, key)
            if isinstance(point, tuple) and not all(math.isfinite(c) for c in point):
                raise BadInput(f"{point!r} must be finite", key=(key,))


@dataclass(frozen=True, kw_only=True)
class WalkConfig:
    """A path, and how people walk it."""

    path: Annotated[
        tuple[Waypoint, ...],
        Field(
            strict=False,
            min_length=1,
            max_length=500,
            description="the points of the path, in order",
        ),
    ]
    enter_s: Annotated[Seconds, Field(description="time of appearance, at the first waypoint")] = 0.0
    leave_s: Annotated[
        Seconds | None,
        Field(description="time of disappearance; by default people stay at the last waypoint"),
    ] = None
    yields: Annotated[
        bool,
        Field(
            description="whether people give way to the robot and to each other; if not, they walk their "
            "path exactly, and wait for a robot that is in their way"
        ),
    ] = False
    group: Annotated[
        Name | None,
        Field(
            description="name of a group that keeps together: people ahead wait for those behind; "
            "all its paths have the same number of points"
        ),
    ] = None
    reacts: Annotated[
        Reaction | None,
        Field(description="reaction to the robot; none by default"),
    ] = None

    def __post_init__(self) -> None:
        """Refuse times that contradict each other.

        Raises:
            BadInput: with the key of the value.
        """
        check_limits(self)
        if self.leave_s is not None and not self.enter_s < self.leave_s:
            raise BadInput(f"{self.leave_s:g} must be after enter_s {self.enter_s:g}", key=("leave_s",))


@dataclass(frozen=True, kw_only=True)
class ActorConfig(WalkConfig):
    """A person whose body is not specified yet."""

    name: Annotated[Name, Field(description="unique name in the scenario")]
    bag: Annotated[bool, Field(description="whether the person carries a bag")] = False
    arms: Annotated[Arms, Field(description="what the arms do while walking")] = "swinging"
    leads: Annotated[
        Lead | None,
        Field(description="how the person leads the robot along its path; by default it does not"),
    ] = None

    def __post_init__(self) -> None:
        """Refuse a person who leads the robot and reacts to it."""
        super().__post_init__()
        if self.leads is not None and self.reacts is not None:
            raise BadInput(
                "a person who leads the robot cannot also react to it; leave out reacts or leads",
                key=("leads",),
            )


@dataclass(frozen=True, kw_only=True)
class PersonConfig(ActorConfig):
    """One person with its body.

    Raises:
        BadInput: a value is out of range or contradicts another; with the person's name.
    """

    height_m: Annotated[float, Field(ge=1.5, le=2.0, description="from the floor to the top of the head")] = (
        1.75
    )
    sex: Annotated[Sex, Field(description="determines proportions and the default height")] = "male"
    build: Annotated[Build, Field(description="body width relative to height")] = "average"
    clothes: Annotated[Clothes, Field(description="clothes of the person")] = field(default_factory=Clothes)

    def __post_init__(self) -> None:
        """Refuse values that contradict each other."""
        if not self.name:
            raise BadInput("person: name must not be empty")
        with found_in(f"person {self.name!r}"):
            super().__post_init__()
            if not self.path:
                raise BadInput("must have at least 1 entry, got ()", key=("path",))
            for index, (a, b) in enumerate(pairwise(self.path), start=1):
                if math.dist(a.at_m, b.at_m) < _SAME_POINT_M:
                    raise BadInput(
                        f"{b.at_m!r} repeats the previous point; to stay there, use its pause_s",
                        key=("path", index, "at_m"),
                    )
