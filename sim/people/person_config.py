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
from peopleboy.sim.people.body.bodies import Age
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.equipment import RIDDEN, Equipment
from peopleboy.sim.people.motion.gait_styles import GaitName

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
    """Reaction of a person to a robot that is near and in sight, at every encounter.

    Raises:
        BadInput: a value is out of range, or the reaction does not use it.
    """

    to: Annotated[Literal["robot"], Field(description="what the person reacts to")] = "robot"
    way: Annotated[
        Way,
        Field(
            alias="as",
            description="`ignores`: does not look or make way, and stops only to avoid walking into the "
            "robot; `makes_way`: walks round the robot, steps aside when it approaches, and "
            "looks at it; `curious`: walks up to the robot, looks at it for a while, and walks "
            "on; `wary`: keeps clear of the robot, walks away when it approaches, and looks back "
            "at it; `blocks`: steps into the path of the robot, stands in front of it for a "
            "while, and walks on; `surprised`: stops and looks at the robot for a while, and "
            "walks on",
        ),
    ]
    from_m: Annotated[
        Meeting | None,
        Field(
            description="distance at which an encounter begins; it ends at a distance 1 m larger. The "
            "default is 3 for `surprised`, 4 for `makes_way` and `blocks`, and 5 for `curious` "
            "and `wary`; `ignores` does not use it"
        ),
    ] = None
    keep_m: Annotated[
        float | None,
        Field(
            ge=0.6,
            le=8.0,
            description="distance between the centres of person and robot. It is the minimum for "
            "`makes_way` (default 1.2) and `wary` (2.5), and the approximate distance for "
            "`curious` (1.2) and `blocks` (1.0); other reactions do not use it",
        ),
    ] = None
    lasts_s: Annotated[
        Lasting | None,
        Field(
            description="time for which the person looks (`curious`, default 5), blocks the path "
            "(`blocks`, 5) or stops (`surprised`, 2.5); other reactions do not use it"
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
    """How a person leads the robot along a path, looking back now and then, waiting and calling.

    Raises:
        BadInput: a value is out of range.
    """

    follower: Annotated[Literal["robot"], Field(description="who follows the person")] = "robot"
    waits_beyond_m: Annotated[
        Meeting,
        Field(description="distance beyond which the person stops, turns to the robot and calls it"),
    ] = 4.5
    goes_on_within_m: Annotated[
        Meeting,
        Field(description="distance within which the robot has caught up, so that the person walks on"),
    ] = 3.5
    at_most_s: Annotated[
        Lasting,
        Field(description="maximum wait; after that, the person walks on until the robot has caught up"),
    ] = 20.0

    def __post_init__(self) -> None:
        """Refuse distances that contradict each other."""
        check_limits(self)
        if self.goes_on_within_m >= self.waits_beyond_m:
            raise BadInput(
                f"goes_on_within_m {self.goes_on_within_m:g} must be less than waits_beyond_m, "
                f"{self.waits_beyond_m:g}"
            )


BodyShape = Literal["capsules", "skins"]
Arms = Literal["swinging", "crossed", "raised", "in_pockets", "telephone", "phone_in_hand"]
PostureName = Literal[*Posture]  # type: ignore[valid-type]
Face = Annotated[Annotated[Name, Tag("word")] | Annotated[Point, Tag("list")], Discriminator(word_or_list)]

SPEEDS_M_S: Final = (0.1, 2.5)
_RUNS_M_S: Final = 1.6  # an adult's stride is that of `RUNNING_AMPLITUDE` then
_WITH_EQUIPMENT: Final = (Posture.STANDING, Posture.CALLING)
_SAME_POINT_M: Final = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A point of a person's path."""

    at_m: Annotated[Point, Field(description="position")]
    speed_m_s: Annotated[
        float, Field(ge=SPEEDS_M_S[0], le=SPEEDS_M_S[1], description="walking speed towards this point")
    ] = 1.2
    pause_s: Annotated[Seconds, Field(description="duration of the stay at this point")] = 0.0
    face: Annotated[
        Face | None,
        Field(
            description="what the person faces during the pause: `robot`, the name of another person, or "
            "a point; by default, the walking direction"
        ),
    ] = None
    until_robot_within_m: Annotated[
        Meeting | None,
        Field(
            description="the pause is extended until the robot is within this distance; by default, the "
            "person does not wait for the robot. Without `face`, the person faces the robot"
        ),
    ] = None
    waits_at_most_s: Annotated[
        float, Field(gt=0.0, le=3600.0, description="maximum wait for the robot, after `pause_s`")
    ] = 60.0
    posture: Annotated[
        PostureName,
        Field(
            description="posture during the pause: `standing` is upright, with the arms at the sides; "
            "`sitting` is as on a chair, and a chair may stand at that point; `bending` is bent "
            "forward; `crouching` has knees and hips bent above the feet; `lying` is on the back on the "
            "floor, with the feet near the point and the head behind; `fallen` is on the front, after a "
            "fall of 0.6 s; `arms_raised` has both arms raised; `arms_crossed` has the arms crossed in "
            "front of the chest; `calling` has one arm raised, which waves until the robot is "
            "within `until_robot_within_m`; `kneeling` is on the right knee"
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
            description="waypoints of the path, in order",
        ),
    ]
    enter_s: Annotated[
        Seconds, Field(description="time at which the person appears, at the first waypoint")
    ] = 0.0
    leave_s: Annotated[
        Seconds | None,
        Field(
            description="time at which the person disappears; by default, people stay at the last waypoint"
        ),
    ] = None
    yields: Annotated[
        bool,
        Field(
            description="whether people give way to the robot and to each other. Otherwise, they follow "
            "their path exactly, and wait if the robot is in their way"
        ),
    ] = False
    group: Annotated[
        Name | None,
        Field(
            description="name of a group that stays together: people in front wait for those behind. All "
            "paths of the group must have the same number of points"
        ),
    ] = None
    reacts: Annotated[
        Reaction | None,
        Field(description="reaction to the robot; by default, none"),
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

    name: Annotated[Name, Field(description="name of the person, unique in the scenario")]
    bag: Annotated[bool, Field(description="whether the person carries a bag")] = False
    gait: Annotated[
        GaitName,
        Field(
            description="style of walking. `strolling` has short steps and little arm swing; `brisk` has "
            "long steps and bent elbows; `old` is stooped, with short steps and feet apart; `heavy` has wide "
            "steps and swaying hips; `shuffling` has very short steps, feet near the floor, and bent trunk, "
            "knees and elbows; `running` is running from 1.6 m/s on, and walking up to 1.1 m/s"
        ),
    ] = "usual"
    arms: Annotated[
        Arms,
        Field(
            description="position of the arms while walking; `telephone` has the left hand at the ear, "
            "`phone_in_hand` has it before the chest, and the person looks at it"
        ),
    ] = "swinging"
    equipment: Annotated[
        Equipment,
        Field(
            description="what the person carries with both arms (`box`), pushes (`walking_frame`, `trolley`, "
            "`pushchair`) or rides (`wheelchair`, `bicycle`). It is an object of its own in the ground "
            "truth, named by the person, a dot and its kind, as `ida.trolley`. Cameras see it; contacts and "
            "sonars do not"
        ),
    ] = "nothing"
    leads: Annotated[
        Lead | None,
        Field(description="how the person leads the robot along the path; by default, the person does not"),
    ] = None

    def __post_init__(self) -> None:
        """Refuse a person who leads the robot and reacts to it."""
        super().__post_init__()
        if self.leads is not None and self.reacts is not None:
            raise BadInput(
                "a person who leads the robot cannot also react to it; leave out reacts or leads",
                key=("leads",),
            )
        if self.gait == "running" and max((w.speed_m_s for w in self.path), default=_RUNS_M_S) < _RUNS_M_S:
            raise BadInput(
                f"'running' needs a speed_m_s of at least {_RUNS_M_S:g} on its path; slower people walk",
                key=("gait",),
            )
        if self.equipment != "nothing":
            self._check_equipment()

    def _check_equipment(self) -> None:
        """Refuse what a person with both hands on a thing, or on a seat, cannot do."""
        takes = f"a person with the equipment {self.equipment!r}"
        if self.bag:
            raise BadInput(f"{takes} has no hand for a bag; leave out bag or equipment", key=("bag",))
        if self.arms != "swinging":
            raise BadInput(f"{takes} holds it with both hands; leave out arms", key=("arms",))
        if self.equipment in RIDDEN and self.gait != "usual":
            raise BadInput(f"{takes} does not walk; leave out gait", key=("gait",))
        for index, waypoint in enumerate(self.path):
            if waypoint.posture not in _WITH_EQUIPMENT:
                raise BadInput(
                    f"{waypoint.posture.value!r} is not possible for {takes}; must be one of "
                    f"{', '.join(_WITH_EQUIPMENT)}",
                    key=("path", index, "posture"),
                )


@dataclass(frozen=True, kw_only=True)
class PersonConfig(ActorConfig):
    """One person with its body.

    Raises:
        BadInput: a value is out of range or contradicts another; with the person's name.
    """

    height_m: Annotated[
        float, Field(ge=1.0, le=2.0, description="height from the floor to the top of the head")
    ] = 1.75
    age: Annotated[
        Age,
        Field(
            description="age group; determines the default height, and the body of people with "
            "`bodies: skins`"
        ),
    ] = "adult"
    sex: Annotated[Sex, Field(description="sex; determines proportions and the default height")] = "male"
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
