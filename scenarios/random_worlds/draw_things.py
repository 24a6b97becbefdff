"""Draw what stands and hangs in a random world: things of all kinds."""

from __future__ import annotations

from typing import Final

from peopleboy.scenarios.random_worlds.attempts import Data, colour, rounded
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.scenarios.random_worlds.draw_place import air_of, draw_point, plan_of
from peopleboy.scenarios.random_worlds.draw_robot import is_before
from peopleboy.sim.places.furniture.thing_kinds import KINDS, Kind

_USUAL_AIR_C: Final = 21.5  # to which the kinds' own temperatures belong
_IN_STREETS: Final = (
    "bench", "bicycle", "bin", "block", "car", "dog", "market_stall", "plant", "pillar", "railing",
    "robot", "street_lamp", "tree", "vending_machine",
)  # fmt: skip
_LOW_M: Final = 0.65  # a thing that is lower may stand on furniture
_TABLE_M: Final = (0.4, 1.3)
_PATTERNS: Final = ("stripes", "checks", "patch", "speckle")


def draw_thing(draws: Draws, place: Data, robot: Data, things: list[Data]) -> Data:
    """Draw a thing; it may stand where it cannot."""
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
    """Draw a temperature [degC]: that of the air and a little, and for what heats itself its heat."""
    own = kind.temperature_c - _USUAL_AIR_C
    heat = own * draws.number("thing_heat") if kind.is_heated else own
    return rounded(air_of(place) + heat + draws.number("thing_over_air"))
