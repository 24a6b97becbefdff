"""Sample a random world as the data of a scenario file: its scene, its objects, and its people."""

import math
from functools import partial
from pathlib import Path
from typing import Final

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.check import Ground
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.random_worlds.distribution import Distribution, Draws
from peopleboy.scenarios.random_worlds.draw_scene import (
    Data,
    air_of,
    colour,
    draw_door,
    draw_place,
    draw_point,
    draw_robot,
    is_before,
    is_valid,
    plan_of,
    rounded,
    with_one_more,
)
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.equipment import RIDDEN
from peopleboy.sim.places.furniture.thing_config import KINDS
from peopleboy.sim.places.pieces import Kind

_WAYPOINT_TRIES: Final = 12
_NEAREST_M: Final = 1.0  # minimum distance to the robot at the start


def draw_person(draws: Draws, kinds: Draws, scene: Data, ground: Ground, name: str) -> Data:
    """Sample a person with a free path; if none is found, the path is not free.

    Args:
        draws: samples everything else.
        kinds: samples the kind of person, apart, so that it does not depend on the rest.
        scene: the world.
        ground: its floor.
        name: name of the person.
    """
    person: Data = {
        "name": name,
        "yields": draws.happens("yields"),
        "bag": draws.happens("carries"),
        "arms": draws.one_of("arms"),
        "path": [],
        **_kind_of_person(kinds),
    }
    if "equipment" in person:
        person |= {"bag": False, "arms": "swinging"}
    lasts = scene["duration_s"]
    if draws.happens("enters_later"):
        person["enter_s"] = rounded(draws.rng.uniform(0.0, 0.6) * lasts)
    elif draws.happens("leaves"):
        person["leave_s"] = rounded(draws.rng.uniform(0.4, 0.9) * lasts)
    is_in_view = draws.happens("begins_in_view")
    for _ in range(draws.count("points")):
        person["path"] = _longer(draws, scene, ground, person, is_in_view)
    return person


def _kind_of_person(kinds: Draws) -> Data:
    """Sample age, gait and equipment; those that are the default are left out."""
    usual = {"age": "adult", "gait": "usual", "equipment": "nothing"}
    kind = {key: value for key in usual if (value := kinds.one_of(key)) != usual[key]}
    if kind.get("equipment") in RIDDEN:
        kind.pop("gait", None)
    return kind


def _longer(draws: Draws, scene: Data, ground: Ground, person: Data, is_in_view: bool) -> list[Data]:
    """Append a reachable waypoint to a path; if none is found, append one only to an empty path."""
    path: list[Data] = person["path"]
    for _ in range(_WAYPOINT_TRIES):
        longer = [*path, _suited(draws, _waypoint(draws, scene, is_in_view and not path), person)]
        if ground.fault(validated(PersonSpec, person | {"path": longer})) is None:
            return longer
    return path or longer


def _suited(draws: Draws, waypoint: Data, person: Data) -> Data:
    """Change a waypoint so that its person can do what it says: runners are fast, and nothing is let go."""
    if person.get("gait") == "running":
        waypoint["speed_m_s"] = draws.number("running_speed")
    if "equipment" in person and "posture" in waypoint:
        waypoint["posture"] = "standing"
    return waypoint


def _waypoint(draws: Draws, scene: Data, is_in_view: bool) -> Data:
    at = _point_in_view(draws, scene) if is_in_view else draw_point(draws, scene["place"])
    waypoint: Data = {"at_m": at, "speed_m_s": draws.number("speed")}
    if not draws.happens("pauses"):
        return waypoint
    waypoint |= {"pause_s": draws.number("pause"), "posture": draws.one_of("posture")}
    if draws.happens("looks_at_robot"):
        waypoint["face"] = "robot"
    if waypoint["posture"] == "sitting" and (seats := _seats(scene)):
        waypoint["at_m"] = seats[int(draws.rng.integers(len(seats)))]
    return waypoint


def _point_in_view(draws: Draws, scene: Data) -> list[float]:
    """Sample a floor point in the thermal camera's initial view; any point if hardly any floor is visible."""
    robot = scene["robot"]
    upright = math.radians(robot["cameras"]["thermal"]["vertical_fov_deg"]) / 2.0
    across = math.atan(math.tan(upright) * Pinhole().width / Pinhole().height)
    for _ in range(_WAYPOINT_TRIES):
        x, y = draw_point(draws, scene["place"])
        ahead, aside = x - robot["at_m"][0], y - robot["at_m"][1]
        off = math.atan2(aside, ahead) - math.radians(robot["heading_deg"])
        if math.hypot(ahead, aside) > _NEAREST_M and abs(math.remainder(off, math.tau)) < across:
            break
    return [x, y]


def _seats(scene: Data) -> list[list[float]]:
    """Return the positions of objects to sit on."""
    things = scene.get("things", ())
    return [thing["at_m"] for thing in things if "at_m" in thing and KINDS[thing["kind"]].is_seat]


_USUAL_AIR_C: Final = 21.5  # air temperature that the default temperatures of objects assume
_IN_STREETS: Final = (
    "bench", "bicycle", "bin", "block", "car", "dog", "market_stall", "plant", "pillar", "railing",
    "robot", "street_lamp", "tree", "vending_machine",
)  # fmt: skip
_LOW_M: Final = 0.65  # a lower object may stand on furniture
_TABLE_M: Final = (0.4, 1.3)
_PATTERNS: Final = ("stripes", "checks", "patch", "speckle")


def draw_thing(draws: Draws, place: Data, robot: Data, things: list[Data]) -> Data:
    """Sample an object; its position may be invalid."""
    is_hung = draws.happens("hung")
    kinds = [name for name, kind in KINDS.items() if kind.is_hung == is_hung]
    if place["kind"] == "street" and draws.happens("street_kind"):
        kinds = list(_IN_STREETS)
    name = str(draws.rng.choice(kinds))
    kind = KINDS[name]
    thing: Data = {
        "kind": name,
        "name": f"{name}_{len(things) + 1}",
        **_where(draws, place, robot, things, kind),
    }
    if not kind.is_to_ceiling and draws.happens("sized"):
        thing["size_m"] = [round(side * draws.number("thing_size"), 3) for side in kind.size_m]
    thing["temperature_c"] = _temperature(draws, place, kind)
    thing["emissivity"] = draws.number("emissivity")
    if draws.happens("coloured"):
        thing["colour"] = colour(draws.rng)
    if draws.happens("patterned"):
        period_m = rounded(draws.rng.uniform(0.05, 0.6))
        thing["pattern"] = {"kind": str(draws.rng.choice(_PATTERNS)), "period_m": period_m}
    return thing


def _where(draws: Draws, place: Data, robot: Data, things: list[Data], kind: Kind) -> Data:
    if kind.is_hung:
        walls = plan_of(place).walls()
        wall = walls[int(draws.rng.integers(len(walls)))]
        low, high = wall.side.span(wall.area)
        return {"wall": wall.name, "along_m": rounded(draws.rng.uniform(low, high))}
    tables = [thing["name"] for thing in things if _carries(thing)]
    if tables and kind.size_m[2] < _LOW_M and not kind.is_from_ceiling and draws.happens("on_top"):
        return {"on_top_of": str(draws.rng.choice(tables))}
    facing = round(float(draws.rng.uniform(-180.0, 180.0)))
    at = draw_point(draws, place)
    while is_before(robot, at):
        at = draw_point(draws, place)
    return {"at_m": at, "facing_deg": float(facing)}


def _carries(thing: Data) -> bool:
    low, high = _TABLE_M
    return thing["kind"] in ("table", "cabinet", "block") and low <= _height(thing) <= high


def _height(thing: Data) -> float:
    return float(thing["size_m"][2] if "size_m" in thing else KINDS[thing["kind"]].size_m[2])


def _temperature(draws: Draws, place: Data, kind: Kind) -> float:
    """Sample a temperature [degC]: close to the air; for a heated object, plus its own heat."""
    own = kind.temperature_c - _USUAL_AIR_C
    heat = own * draws.number("thing_heat") if kind.is_heated else own
    return rounded(air_of(place) + heat + draws.number("thing_over_air"))


LASTS_S: Final = 8.0
"""[s] Default duration of a random world's run."""

_TRIES: Final = 3


def world_name(seed: int) -> str:
    """Return the name of the world of a seed."""
    return f"world_{seed}"


def random_world(seed: int, duration_s: float = LASTS_S, distribution: Distribution | None = None) -> Data:
    """Sample the data of a random world, which depend only on seed, duration and distribution.

    The appearance of people is sampled from the run's seed, which should be the same.

    Args:
        seed: seed of the world, 0 or more.
        duration_s: [s] duration of a run.
        distribution: see `peopleboy.scenarios.random_worlds.distribution`; None for the default one.
    """
    draws = Draws(stream(seed, "random_world"), distribution)
    scene: Data = {
        "name": world_name(seed),
        "description": "A world drawn at random.",
        "duration_s": duration_s,
        "detail": "full",
        "clothes_differ": draws.one_of("clothes") == "all different",
        "lights": _lights(draws, duration_s),
    }
    kinds = Draws(stream(seed, "random_people"), distribution)
    scene["bodies"] = kinds.one_of("bodies")
    place = draw_place(draws)
    scene |= {"place": place, "robot": draw_robot(draws, place, duration_s)}
    for _ in range(draws.count("doors")):
        scene = _with_door(draws, scene)
    for _ in range(draws.count("things")):
        things = scene.get("things", [])
        scene = with_one_more(
            scene, "things", partial(draw_thing, draws, place, scene["robot"], things), _TRIES
        )
    ground = parse_scenario(scene, source=scene["name"], folder=Path()).ground
    for number in range(draws.count("people")):
        scene = with_one_more(
            scene, "people", partial(draw_person, draws, kinds, scene, ground, f"p{number}"), _TRIES
        )
    return scene


def random_scenario(
    seed: int, duration_s: float = LASTS_S, distribution: Distribution | None = None
) -> Scenario:
    """Sample a world, and return it as a scenario."""
    return parse_scenario(
        random_world(seed, duration_s, distribution), source=world_name(seed), folder=Path()
    )


def _with_door(draws: Draws, scene: Data) -> Data:
    """Add a door; add none if no sampled door fits."""
    place = scene["place"]
    for _ in range(_TRIES):
        doors = [*place.get("doors", []), draw_door(draws, place)]
        if is_valid(fuller := scene | {"place": place | {"doors": doors}}):
            return fuller
    return scene


def _lights(draws: Draws, duration_s: float) -> list[Data]:
    steps: list[Data] = [{"at_s": 0.0, "level": draws.number("light")}]
    if draws.one_of("light_changes") == "once":
        steps.append({"at_s": round(duration_s / 2.0, 2), "level": draws.number("light")})
    return steps
