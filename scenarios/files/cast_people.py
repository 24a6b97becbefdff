"""Who walks through a scenario: looks and small variations drawn from the seed, groups spread out abreast."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from peopleboy.scenarios.files.schema.people import ClothesSpec, GroupSpec, PersonSpec, WaypointSpec
from peopleboy.scenarios.files.schema.reactions import ReactionSpec
from peopleboy.sim.people.appearance.traits import usual_clothes
from peopleboy.sim.people.body.clothes import Clothes, random_clothes
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.person import PersonConfig
from peopleboy.sim.people.person_config import Waypoint
from peopleboy.sim.people.reaction import USUAL, Lead, Reaction
from peopleboy.sim.people.walking.path import abreast
from peopleboy.sim.random_streams import stream

# Stature of adults [m]: mean and standard deviation (NCD-RisC 2016, young adults of central Europe, rounded).
_STATURE_M = {"female": (1.66, 0.06), "male": (1.79, 0.07)}
_SHORTEST_M, _TALLEST_M = 1.5, 2.0
_BUILDS = {"slim": 0.3, "average": 0.5, "stout": 0.2}
_SPEEDS_M_S = (0.1, 2.5)
_TRIES = 50

Path = tuple[WaypointSpec, ...]


def cast(
    person: PersonSpec,
    seed: int,
    can_walk: Callable[[PersonSpec], bool],
    usual_air_c: float | None = None,
) -> PersonSpec:
    """Decide everything about a person that the file leaves to the seed.

    Each person has random streams of its own, so that another person in the file changes nothing for it.
    What the file says stays; the result has nothing left to draw, and casting it again returns it.

    Args:
        person: as in the file.
        seed: of the run.
        can_walk: whether somebody can walk the way that it has; one that the seed moves into a wall is drawn
            again, and after many tries the file's own path is kept.
        usual_air_c: [degC] air for which people dress as is usual; None draws from the whole catalogue.
    """
    looks = _draw_looks(stream(seed, f"scenario.{person.name}.looks"), person)
    if usual_air_c is not None:
        rng = stream(seed, f"scenario.{person.name}.clothes")
        usual = ClothesSpec(**asdict(usual_clothes(rng, looks["sex"], usual_air_c)))
        looks["clothes"] = _keep_given(usual, person)
    rng = stream(seed, f"scenario.{person.name}.walk")
    delay = float(rng.uniform(0.0, person.enter_jitter_s)) if person.enter_jitter_s > 0.0 else 0.0
    later = person.model_copy(
        update={
            "enter_s": _rounded(person.enter_s + delay),
            "leave_s": None if person.leave_s is None else _rounded(person.leave_s + delay),
        }
    )
    return later.model_copy(
        update={
            **looks,
            "path": _vary_path(later, rng, can_walk),
            "jitter_m": 0.0,
            "speed_jitter": 0.0,
            "enter_jitter_s": 0.0,
        }
    )


def make_config(person: PersonSpec) -> PersonConfig:
    """Turn a person who was cast into settings of the simulator."""
    assert person.height_m is not None
    assert person.sex is not None
    assert person.build is not None
    clothes = ClothesSpec() if person.clothes is None else person.clothes
    return PersonConfig(
        name=person.name,
        path=make_way(person.path),
        height_m=person.height_m,
        sex=person.sex,
        build=person.build,
        clothes=Clothes(**clothes.model_dump(exclude_none=True)),
        enter_s=person.enter_s,
        leave_s=person.leave_s,
        yields=person.yields,
        bag=person.bag,
        arms=person.arms,
        reacts=None if person.reacts is None else _make_reaction(person.reacts),
        leads=None if person.leads is None else Lead(**person.leads.model_dump(exclude={"whom"})),
        group=person.group,
    )


def _make_reaction(spec: ReactionSpec) -> Reaction:
    given = {key: value for key, value in spec.distances().items() if value is not None}
    return Reaction(way=spec.way, **(dict(USUAL[spec.way]) | given))


def make_way(path: Path) -> tuple[Waypoint, ...]:
    """Turn a path into waypoints of the simulator."""
    return tuple(
        Waypoint(
            at_m=spec.at_m,
            speed_m_s=spec.speed_m_s,
            pause_s=spec.pause_s,
            face=spec.face,
            posture=Posture(spec.posture),
            until_robot_within_m=spec.until_robot_within_m,
            waits_at_most_s=spec.waits_at_most_s,
        )
        for spec in path
    )


def members(group: GroupSpec) -> tuple[PersonSpec, ...]:
    """The people of a group, each on a path of its own, the first on the right."""
    points = [waypoint.at_m for waypoint in group.path]
    middle = (len(group.names) - 1) / 2.0
    shared = {
        key: getattr(group, key) for key in type(group).model_fields if key not in ("names", "spacing_m")
    }
    return tuple(
        PersonSpec.model_construct(**shared, name=name).model_copy(
            update={"path": _moved(group.path, abreast(points, (index - middle) * group.spacing_m))}
        )
        for index, name in enumerate(group.names)
    )


def _moved(path: Path, points: Sequence[tuple[float, float]]) -> Path:
    return tuple(
        waypoint.model_copy(update={"at_m": (_rounded(x), _rounded(y))})
        for waypoint, (x, y) in zip(path, points, strict=True)
    )


def _draw_looks(rng: np.random.Generator, person: PersonSpec) -> dict[str, Any]:
    """Sex, build, height and clothes; each is drawn even where the file gives it, so the others stay."""
    sex = str(rng.choice(list(_STATURE_M)))
    build = str(rng.choice(list(_BUILDS), p=list(_BUILDS.values())))
    above = float(rng.normal())
    clothes = ClothesSpec(**asdict(random_clothes(rng)))
    sex = sex if person.sex is None else person.sex
    mean, deviation = _STATURE_M[sex]
    stature = min(max(mean + above * deviation, _SHORTEST_M), _TALLEST_M)
    return {
        "sex": sex,
        "build": build if person.build is None else person.build,
        "height_m": _rounded(stature) if person.height_m is None else person.height_m,
        "clothes": _keep_given(clothes, person),
    }


def _keep_given(drawn: ClothesSpec, person: PersonSpec) -> ClothesSpec:
    """Clothes that were drawn, but what the file says."""
    given = {} if person.clothes is None else person.clothes.model_dump(exclude_none=True)
    return drawn.model_copy(update=given)


def _vary_path(person: PersonSpec, rng: np.random.Generator, can_walk: Callable[[PersonSpec], bool]) -> Path:
    faster = 1.0 + float(rng.uniform(-person.speed_jitter, person.speed_jitter))
    path = person.path
    if person.speed_jitter > 0.0:
        speeds = [min(max(w.speed_m_s * faster, _SPEEDS_M_S[0]), _SPEEDS_M_S[1]) for w in path]
        path = tuple(
            w.model_copy(update={"speed_m_s": _rounded(speed)}) for w, speed in zip(path, speeds, strict=True)
        )
    if person.jitter_m == 0.0:
        return path
    for _ in range(_TRIES):
        varied = _moved(path, [_near(waypoint.at_m, person.jitter_m, rng) for waypoint in path])
        if can_walk(person.model_copy(update={"path": varied})):
            return varied
    return path


def _near(point: tuple[float, float], radius_m: float, rng: np.random.Generator) -> tuple[float, float]:
    """A point drawn evenly from the disc around another."""
    distance = radius_m * math.sqrt(rng.uniform())
    angle = rng.uniform(0.0, 2.0 * math.pi)
    return point[0] + distance * math.cos(angle), point[1] + distance * math.sin(angle)


def _rounded(value: float) -> float:
    """To a tenth of a millimetre or millisecond: a file shows it in full."""
    return round(float(value), 4)
