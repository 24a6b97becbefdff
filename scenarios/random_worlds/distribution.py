"""The distribution of random worlds: all ranges and probabilities, by name, and how to narrow it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput, found_in
from peopleboy.wording import hint


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """A uniform distribution of the quantity `what`, from `low` to `high`, in `unit`."""

    low: float
    high: float
    unit: str
    what: str
    is_whole: bool = False


RANGES: Final[Mapping[str, Range]] = {
    "room_length": Range(low=4.0, high=20.0, unit="m", what="length of a room"),
    "room_width": Range(low=3.5, high=14.0, unit="m", what="width of a room"),
    "corridor_length": Range(
        low=7.0, high=24.0, unit="m", what="length of a corridor or of each of its legs"
    ),
    "corridor_width": Range(low=1.8, high=4.0, unit="m", what="width of a corridor"),
    "street_length": Range(low=10.0, high=40.0, unit="m", what="length of a street"),
    "street_width": Range(low=6.0, high=16.0, unit="m", what="width of a street"),
    "sky": Range(
        low=-35.0, high=5.0, unit="K", what="temperature of the sky at the horizon, relative to the air"
    ),
    "sun_azimuth": Range(low=-180.0, high=180.0, unit="deg", what="azimuth of the sun, if it shines"),
    "sun_elevation": Range(low=8.0, high=60.0, unit="deg", what="elevation of the sun"),
    "sun_warms": Range(low=2.0, high=16.0, unit="K", what="temperature rise of sunlit surfaces"),
    "ceiling": Range(low=2.4, high=5.0, unit="m", what="height of the ceiling"),
    "doors": Range(low=0, high=3, unit="", what="number of doors", is_whole=True),
    "door_width": Range(low=0.8, high=1.8, unit="m", what="width of a door"),
    "air": Range(
        low=8.0, high=31.0, unit="degC", what="temperature of the air and of reflected surroundings"
    ),
    "floor_over_air": Range(
        low=-3.0, high=3.0, unit="K", what="temperature of the floor, relative to the air"
    ),
    "walls_over_air": Range(
        low=-2.5, high=2.5, unit="K", what="temperature of the walls, relative to the air"
    ),
    "ceiling_over_air": Range(
        low=-0.5, high=4.0, unit="K", what="temperature of the ceiling, relative to the air"
    ),
    "wall_over_others": Range(
        low=-5.0, high=5.0, unit="K", what="temperature of a deviating wall, relative to the other walls"
    ),
    "things": Range(low=0, high=24, unit="", what="number of objects, as far as they fit", is_whole=True),
    "thing_over_air": Range(
        low=-1.5, high=1.5, unit="K", what="temperature of an unheated object, relative to the air"
    ),
    "thing_heat": Range(
        low=0.6,
        high=1.3,
        unit="",
        what="factor on the temperature difference between a heated object and the air",
    ),
    "thing_size": Range(low=0.75, high=1.35, unit="", what="factor on each side length of a resized object"),
    "emissivity": Range(low=0.75, high=0.97, unit="", what="emissivity of objects"),
    "people": Range(low=0, high=10, unit="", what="number of people, as far as they fit", is_whole=True),
    "points": Range(low=1, high=5, unit="", what="number of waypoints of a path", is_whole=True),
    "speed": Range(low=0.4, high=1.8, unit="m/s", what="walking speed"),
    "running_speed": Range(low=1.8, high=2.4, unit="m/s", what="running speed"),
    "pause": Range(low=0.3, high=4.0, unit="s", what="pause at a waypoint"),
    "camera_height": Range(low=0.4, high=1.8, unit="m", what="height of the cameras above the floor"),
    "pitch": Range(low=-15.0, high=15.0, unit="deg", what="pitch of the cameras; positive is down"),
    "vertical_fov": Range(
        low=20.0, high=60.0, unit="deg", what="vertical field of view of the thermal camera"
    ),
    "blur": Range(low=0.4, high=1.4, unit="px", what="optical blur of the thermal camera"),
    "netd": Range(low=0.02, high=0.15, unit="K", what="temporal noise (NETD)"),
    "fixed_pattern": Range(low=0.01, high=0.12, unit="K", what="fixed-pattern noise"),
    "dead_pixels": Range(low=0.0, high=0.0005, unit="", what="share of dead pixels"),
    "column_noise": Range(low=0.0, high=0.06, unit="K", what="column noise"),
    "vignetting": Range(low=0.0, high=0.6, unit="K", what="vignetting"),
    "drift": Range(low=0.0, high=0.6, unit="K/min", what="drift of the thermal image"),
    "gain_follows": Range(low=0.0, high=3.0, unit="s", what="time constant of the gain"),
    "tail": Range(low=0.05, high=0.4, unit="%", what="share of pixels clipped by the gain at each end"),
    "least_span": Range(low=2.0, high=10.0, unit="K", what="minimum span of the gain"),
    "plateau": Range(low=0.1, high=3.0, unit="%", what="plateau of a plateau gain"),
    "linear_share": Range(low=0.1, high=0.8, unit="", what="linear share of a plateau gain"),
    "sharpening": Range(low=0.0, high=1.8, unit="", what="sharpening"),
    "coring": Range(low=0.0, high=0.2, unit="K", what="coring threshold"),
    "shutter_every": Range(low=5.0, high=60.0, unit="s", what="shutter interval, if there is a shutter"),
    "jpeg_quality": Range(
        low=60, high=95, unit="", what="JPEG quality, if images are compressed", is_whole=True
    ),
    "heading_off": Range(
        low=-30.0,
        high=30.0,
        unit="deg",
        what="heading of the robot, relative to the direction of a distant point on the floor",
    ),
    "drive_speed": Range(low=-0.2, high=0.7, unit="m/s", what="commanded speed"),
    "drive_turn": Range(low=-40.0, high=40.0, unit="deg/s", what="commanded turn rate"),
    "drive_lasts": Range(low=0.8, high=4.0, unit="s", what="duration of a command"),
    "light": Range(low=0.25, high=1.2, unit="", what="light level"),
}
"""Values with a uniform distribution."""

SHARES: Final[Mapping[str, Mapping[str, float]]] = {
    "place": {"room": 0.32, "street": 0.5, "corridor": 0.06, "l_corridor": 0.06, "t_corridor": 0.06},
    "houses": {"both": 0.5, "north": 0.2, "south": 0.2, "none": 0.1},
    "door": {"open": 0.5, "closed": 0.5},
    "robot": {"stands": 0.5, "drives": 0.5},
    "gain": {"percentile": 0.3, "plateau": 0.7},
    "command": {"straight": 0.4, "curve": 0.35, "turn": 0.15, "stop": 0.1},
    "posture": {
        "standing": 0.55, "sitting": 0.1, "bending": 0.1, "arms_crossed": 0.07, "arms_raised": 0.06,
        "crouching": 0.04, "kneeling": 0.03, "lying": 0.03, "fallen": 0.02,
    },
    "arms": {
        "swinging": 0.8, "crossed": 0.06, "raised": 0.04, "in_pockets": 0.03, "telephone": 0.03,
        "phone_in_hand": 0.04,
    },
    "bodies": {"skins": 1.0, "capsules": 0.0},
    "age": {"adult": 0.75, "elder": 0.15, "child": 0.1},
    "gait": {
        "usual": 0.7, "strolling": 0.08, "brisk": 0.08, "old": 0.04, "heavy": 0.04, "shuffling": 0.02,
        "running": 0.04,
    },
    "equipment": {
        "nothing": 0.88, "box": 0.02, "walking_frame": 0.01, "trolley": 0.02, "pushchair": 0.02,
        "wheelchair": 0.01, "bicycle": 0.04,
    },
    "light_changes": {"never": 0.8, "once": 0.2},
    "clothes": {"as people dress": 0.75, "all different": 0.25},
}  # fmt: skip
"""Values with a categorical distribution, with their probabilities."""

ODDS: Final[Mapping[str, tuple[float, str]]] = {
    "has_sun": (0.4, "the sun shines into the room or onto the street"),
    "street_kind": (0.8, "an object in a street is a typical street object"),
    "wall_differs": (0.3, "a wall has a different temperature from the others"),
    "coloured": (0.6, "a surface or object has a random colour"),
    "patterned": (0.3, "an object has a pattern"),
    "sized": (0.5, "an object is resized"),
    "hung": (0.35, "an object hangs on a wall instead of standing"),
    "on_top": (0.5, "a small object stands on a piece of furniture, if there is one"),
    "begins_in_view": (0.7, "a person starts in the initial view of the thermal camera"),
    "has_shutter": (0.3, "the thermal camera has a shutter"),
    "is_film": (0.4, "the thermal images are JPEG-compressed"),
    "pauses": (0.25, "a person pauses at a waypoint"),
    "looks_at_robot": (0.3, "a person who pauses looks at the robot"),
    "enters_later": (0.25, "a person enters later"),
    "leaves": (0.15, "a person leaves before the end"),
    "yields": (0.5, "a person gives way"),
    "carries": (0.2, "a person carries a bag"),
}
"""Events with their probabilities."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Distribution:
    """A distribution of worlds; `ranges`, `shares` and `odds` are as above, each with all names."""

    ranges: Mapping[str, Range] = field(default_factory=lambda: RANGES)
    shares: Mapping[str, Mapping[str, float]] = field(default_factory=lambda: SHARES)
    odds: Mapping[str, tuple[float, str]] = field(default_factory=lambda: ODDS)


class Draws:
    """Sample from a distribution."""

    def __init__(self, rng: np.random.Generator, distribution: Distribution | None = None) -> None:
        """Use this distribution, or the default one above if None."""
        self.rng = rng
        self._of = Distribution() if distribution is None else distribution

    def number(self, name: str) -> float:
        """Sample from a range, rounded to a hundredth; dead pixels and emissivities are finer."""
        spread = self._of.ranges[name]
        if spread.is_whole:
            return int(self.rng.integers(int(spread.low), int(spread.high), endpoint=True))
        return round(float(self.rng.uniform(spread.low, spread.high)), 2 if spread.high > 0.7 else 6)

    def count(self, name: str) -> int:
        """Sample from a range of whole numbers."""
        return int(self.number(name))

    def one_of(self, name: str) -> str:
        """Sample from a categorical distribution."""
        shares = self._of.shares[name]
        return str(self.rng.choice(list(shares), p=list(shares.values())))

    def happens(self, name: str) -> bool:
        """Sample whether an event occurs."""
        return bool(self.rng.random() < self._of.odds[name][0])


def narrowed(given: object) -> Distribution:
    """Return the distribution of random worlds, with some parts replaced.

    Args:
        given: for a name in `RANGES`, a number, or a pair within its limits; for a name in `SHARES`, one of
            its values, a list of them, or their weights by value; for a name in `ODDS`, a probability, 0..1.

    Raises:
        BadInput: a name is unknown, or a value is outside its limits.
    """
    if not isinstance(given, Mapping):
        raise BadInput(f"{given!r}: must be a mapping of names to values, such as {{'people': [1, 2]}}")
    usual = Distribution()
    ranges, shares, odds = dict(usual.ranges), dict(usual.shares), dict(usual.odds)
    for name, value in given.items():
        with found_in(name):
            if name in RANGES:
                ranges[name] = _range(RANGES[name], value)
            elif name in SHARES:
                shares[name] = _share(SHARES[name], value)
            elif name in ODDS:
                odds[name] = (_odds(value), ODDS[name][1])
            else:
                raise BadInput(f"unknown name; {hint(str(name), [*RANGES, *SHARES, *ODDS])}")
    return Distribution(ranges=ranges, shares=shares, odds=odds)


def _range(usual: Range, value: Any) -> Range:
    bounds = list(value) if isinstance(value, tuple | list) else [value, value]
    fine = len(bounds) == 2 and all(is_number(bound, is_whole=usual.is_whole) for bound in bounds)
    if not fine or not usual.low <= bounds[0] <= bounds[1] <= usual.high:
        what = "a whole number" if usual.is_whole else "a number"
        unit = f" {usual.unit}" if usual.unit else ""
        raise BadInput(f"{value!r} must be {what} or a pair, within {usual.low:g} .. {usual.high:g}{unit}")
    return replace(usual, low=bounds[0], high=bounds[1])


def _share(usual: Mapping[str, float], value: Any) -> Mapping[str, float]:
    """Return the probabilities of some values: of one, of several, or by weights.

    Several are as usual among them; if one of them usually has a probability of 0, they are equal.
    """
    names = list(value) if isinstance(value, list | tuple | Mapping) else [value]
    for name in names or [value]:
        if name not in list(usual):
            raise BadInput(f"unknown value {name!r}; choose from {', '.join(usual)}")
    own = {name: usual[name] for name in names}
    weights = value if isinstance(value, Mapping) else own if all(own.values()) else dict.fromkeys(names, 1.0)
    if not all(is_number(weight, is_whole=False) and weight >= 0.0 for weight in weights.values()):
        raise BadInput(f"{value!r} must have weights of 0 or more")
    if not (total := math.fsum(weights.values())):
        raise BadInput(f"{value!r} must have a weight above 0")
    return {str(name): weight / total for name, weight in weights.items()}


def _odds(value: Any) -> float:
    if not is_number(value, is_whole=False) or not 0.0 <= value <= 1.0:
        raise BadInput(f"{value!r} must be a probability, 0 .. 1")
    return float(value)


def is_number(value: object, *, is_whole: bool) -> bool:
    """Return whether a value is a finite number, or a whole one."""
    if isinstance(value, bool):
        return False
    if isinstance(value, int | np.integer):
        return True
    return not is_whole and isinstance(value, float | np.floating) and math.isfinite(value)
