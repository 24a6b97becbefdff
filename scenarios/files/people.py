"""Keys of a scenario file for people, and what is sampled from the seed: bodies, clothes, detours."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import pairwise
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field, with_config

from peopleboy.bad_input import BadInput
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.validation import STRICT, Given
from peopleboy.settings import Name, meaning_of
from peopleboy.sim.people.appearance.traits import suit_age, usual_clothes
from peopleboy.sim.people.body.anthropometry import Build, Sex
from peopleboy.sim.people.body.bodies import Age
from peopleboy.sim.people.body.clothes import Clothes, random_clothes
from peopleboy.sim.people.person_config import SPEEDS_M_S, ActorConfig, PersonConfig, WalkConfig, Waypoint
from peopleboy.sim.people.walking.path import abreast

# Stature of adults [m]: mean and standard deviation (NCD-RisC 2016, young adults of central Europe, rounded).
# Older people are about 3 cm shorter; children are of 4 to 11 years: our choice.
_STATURE_M: Final = {"female": (1.66, 0.06), "male": (1.79, 0.07)}
_CHILD_M: Final = (1.25, 0.12)
_ELDER_M: Final = -0.03
_LIMITS_M: Final[Mapping[Age, tuple[float, float]]] = {
    "child": (1.0, 1.5), "adult": (1.5, 2.0), "elder": (1.5, 2.0),
}  # fmt: skip
_BUILDS: Final = {"slim": 0.3, "average": 0.5, "stout": 0.2}
_TRIES: Final = 50

# Colours that differ clearly in hue or brightness, a white top from a yellow one too.
_TOP_COLOURS: Final = ("white", "black", "red", "yellow", "green", "blue", "pink", "orange")
_BOTTOM_COLOURS: Final = ("black", "khaki", "blue", "white", "red", "green", "light_grey", "purple")

Path = tuple[Waypoint, ...]
GivenClothes = Annotated[
    dict[str, Any],
    Given(
        Clothes, "Clothes of a person; keys that you omit are sampled from the seed.", shows_defaults=False
    ),
]


@dataclass(frozen=True, kw_only=True)
class _Variations(WalkConfig):
    """Settings of a path that are varied by the seed."""

    jitter_m: Annotated[
        float, Field(ge=0.0, le=2.0, description="maximum random displacement of each waypoint")
    ] = 0.0
    speed_jitter: Annotated[
        float,
        Field(ge=0.0, le=0.5, description="maximum random change of all speeds, as a share"),
    ] = 0.0
    enter_jitter_s: Annotated[
        float, Field(ge=0.0, le=60.0, description="maximum random delay of the entry")
    ] = 0.0


@with_config(STRICT)
@dataclass(frozen=True, kw_only=True)
class PersonSpec(ActorConfig, _Variations):
    """A walking person. Keys of the appearance that you omit are sampled from the seed."""

    route: Annotated[
        bool | None,
        Field(
            description="whether to lead the path around walls and objects where the straight line between "
            "two waypoints is not free; by default, such a path is refused"
        ),
    ] = None
    height_m: Annotated[float | None, meaning_of(PersonConfig, "height_m")] = None
    age: Annotated[Age, meaning_of(PersonConfig, "age")] = "adult"
    sex: Annotated[Sex | None, meaning_of(PersonConfig, "sex")] = None
    build: Annotated[Build | None, meaning_of(PersonConfig, "build")] = None
    clothes: Annotated[GivenClothes | None, meaning_of(PersonConfig, "clothes")] = None


@dataclass(frozen=True, kw_only=True)
class GroupSpec(_Variations):
    """People who walk abreast along the same path."""

    path: Annotated[
        Path,
        Field(
            strict=False,
            min_length=2,
            max_length=500,
            description="waypoints of the path, in order; the walking direction defines left and right",
        ),
    ]
    names: Annotated[
        tuple[Name, ...],
        Field(
            strict=False,
            min_length=2,
            max_length=6,
            description="one name per person, from right to left",
        ),
    ]
    spacing_m: Annotated[float, Field(ge=0.5, le=3.0, description="distance between neighbours")] = 0.75

    def members(self) -> tuple[PersonSpec, ...]:
        """Return the members of the group, each with its own path, starting from the right."""
        points = [waypoint.at_m for waypoint in self.path]
        for index, (before, after) in enumerate(pairwise(points)):
            if before == after:
                raise BadInput("must differ from the point before", key=("path", index + 1, "at_m"))
        middle = (len(self.names) - 1) / 2.0
        shared = {one.name: getattr(self, one.name) for one in fields(_Variations)}
        return tuple(
            PersonSpec(
                **shared
                | {
                    "name": name,
                    "path": _moved(self.path, abreast(points, (index - middle) * self.spacing_m)),
                }
            )
            for index, name in enumerate(self.names)
        )


def resolve_person(
    person: PersonSpec,
    seed: int,
    can_walk: Callable[[PersonSpec], bool],
    routed: Callable[[PersonSpec], Path],
    usual_air_c: float | None = None,
) -> PersonSpec:
    """Sample everything about a person that the file leaves to the seed.

    Each person has separate random streams, so that adding a person to the file does not change the others.
    Values given in the file stay. The result is fully specified; resolving it again returns it unchanged.

    Args:
        person: the person as given in the file.
        seed: seed of the run.
        can_walk: whether a person's path is walkable; a path that the seed moves into a wall is sampled
            again, and after many tries the file's own path is kept.
        routed: returns a person's path, led around obstacles if the file asks for that.
        usual_air_c: [degC] air temperature for which people dress normally; None samples from all clothes.
    """
    drawn = _draw_person(stream(seed, f"scenario.{person.name}.looks"), person)
    if usual_air_c is not None:
        rng = stream(seed, f"scenario.{person.name}.clothes")
        usual = suit_age(usual_clothes(rng, drawn["sex"], usual_air_c), person.age)
        drawn["clothes"] = _keep_given(usual, person)
    rng = stream(seed, f"scenario.{person.name}.walk")
    delay = float(rng.uniform(0.0, person.enter_jitter_s)) if person.enter_jitter_s > 0.0 else 0.0
    later = replace(
        person,
        enter_s=_rounded(person.enter_s + delay),
        leave_s=None if person.leave_s is None else _rounded(person.leave_s + delay),
    )
    path = _vary_path(later, rng, can_walk)
    path = routed(replace(later, path=path))
    return replace(later, **drawn, path=path, route=None, jitter_m=0.0, speed_jitter=0.0, enter_jitter_s=0.0)


def make_config(person: PersonSpec) -> PersonConfig:
    """Return the settings of a resolved person."""
    given = {one.name: getattr(person, one.name) for one in fields(PersonConfig)}
    return PersonConfig(**given | {"clothes": Clothes(**person.clothes or {})})


def assign_distinct_colours(people: Sequence[PersonSpec], rng: np.random.Generator) -> tuple[PersonSpec, ...]:
    """Give each person a top and a bottom in colours that no other person wears, as far as possible.

    Colours that a person has already stay, and others may get them too. With more than eight people,
    colours repeat.
    """
    tops, bottoms = rng.permutation(_TOP_COLOURS), rng.permutation(_BOTTOM_COLOURS)
    colours = [
        {
            "top_colour": str(tops[index % len(tops)]),
            "bottom_colour": str(bottoms[index % len(bottoms)]),
        }
        for index in range(len(people))
    ]
    return tuple(
        replace(person, clothes=_in_order(own | (person.clothes or {})))
        for person, own in zip(people, colours, strict=True)
    )


def _moved(path: Path, points: Sequence[tuple[float, float]]) -> Path:
    return tuple(
        replace(waypoint, at_m=(_rounded(x), _rounded(y)))
        for waypoint, (x, y) in zip(path, points, strict=True)
    )


def _draw_person(rng: np.random.Generator, person: PersonSpec) -> dict[str, Any]:
    """Sample sex, build, height and clothes; sampling given values too keeps the others unchanged."""
    sex = str(rng.choice(list(_STATURE_M)))
    build = str(rng.choice(list(_BUILDS), p=list(_BUILDS.values())))
    above = float(rng.normal())
    clothes = random_clothes(rng)
    sex = sex if person.sex is None else person.sex
    mean, deviation = _CHILD_M if person.age == "child" else _STATURE_M[sex]
    mean += _ELDER_M if person.age == "elder" else 0.0
    shortest, tallest = _LIMITS_M[person.age]
    stature = min(max(mean + above * deviation, shortest), tallest)
    return {
        "sex": sex,
        "build": build if person.build is None else person.build,
        "height_m": _rounded(stature) if person.height_m is None else person.height_m,
        "clothes": _keep_given(clothes, person),
    }


def _keep_given(drawn: Clothes, person: PersonSpec) -> dict[str, Any]:
    """Return the sampled clothes, with values given in the file in their place."""
    worn = {key: value for key, value in asdict(drawn).items() if value is not None}
    return _in_order(worn | (person.clothes or {}))


def _in_order(clothes: dict[str, Any]) -> dict[str, Any]:
    return {one.name: clothes[one.name] for one in fields(Clothes) if one.name in clothes}


def _vary_path(person: PersonSpec, rng: np.random.Generator, can_walk: Callable[[PersonSpec], bool]) -> Path:
    jitter = abs(person.speed_jitter)  # of -0.0, NumPy refuses the range
    faster = 1.0 + float(rng.uniform(-jitter, jitter))
    path = person.path
    if person.speed_jitter > 0.0:
        speeds = [min(max(w.speed_m_s * faster, SPEEDS_M_S[0]), SPEEDS_M_S[1]) for w in path]
        path = tuple(replace(w, speed_m_s=_rounded(speed)) for w, speed in zip(path, speeds, strict=True))
    if person.jitter_m == 0.0:
        return path
    for _ in range(_TRIES):
        varied = _moved(path, [_near(waypoint.at_m, person.jitter_m, rng) for waypoint in path])
        if can_walk(replace(person, path=varied)):
            return varied
    return path


def _near(point: tuple[float, float], radius_m: float, rng: np.random.Generator) -> tuple[float, float]:
    """Return a point sampled uniformly from the disc around another point."""
    distance = radius_m * math.sqrt(rng.uniform())
    angle = rng.uniform(0.0, 2.0 * math.pi)
    return point[0] + distance * math.cos(angle), point[1] + distance * math.sin(angle)


def _rounded(value: float) -> float:
    """Round to a tenth of a millimetre or millisecond, so that a file shows the value in full."""
    return round(float(value), 4)
