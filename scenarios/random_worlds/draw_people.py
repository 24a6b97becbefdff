"""Draw who walks, stands and sits in a random world; looks that are left out follow the world's seed."""

from __future__ import annotations

import math
from typing import Final

from peopleboy.scenarios.files.check import Ground
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.scenarios.random_worlds.draw_scene import Data, draw_point, rounded
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.places.furniture.thing_config import KINDS

_TRIES: Final = 12
_NEAREST_M: Final = 1.0  # to the robot, at first


def draw_person(draws: Draws, scene: Data, ground: Ground, name: str) -> Data:
    """Draw a person whose way is free; if none is found, one whose way is not."""
    person: Data = {
        "name": name,
        "yields": draws.happens("yields"),
        "bag": draws.happens("carries"),
        "arms": draws.one_of("arms"),
        "path": [],
    }
    lasts = scene["duration_s"]
    if draws.happens("enters_later"):
        person["enter_s"] = rounded(draws.rng.uniform(0.0, 0.6) * lasts)
    elif draws.happens("leaves"):
        person["leave_s"] = rounded(draws.rng.uniform(0.4, 0.9) * lasts)
    is_in_view = draws.happens("begins_in_view")
    for _ in range(draws.count("points")):
        person["path"] = _longer(draws, scene, ground, person, is_in_view)
    return person


def _longer(draws: Draws, scene: Data, ground: Ground, person: Data, is_in_view: bool) -> list[Data]:
    """Add a point to the path that can be walked to; none, if there is none."""
    path: list[Data] = person["path"]
    for _ in range(_TRIES):
        longer = [*path, _waypoint(draws, scene, is_in_view and not path)]
        if ground.fault(validated(PersonSpec, person | {"path": longer})) is None:
            return longer
    return path or longer


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
    """Draw a point of the floor that the thermal camera sees at first; any, if hardly any is seen."""
    robot = scene["robot"]
    upright = math.radians(robot["cameras"]["thermal"]["vertical_fov_deg"]) / 2.0
    across = math.atan(math.tan(upright) * Pinhole().width / Pinhole().height)
    for _ in range(_TRIES):
        x, y = draw_point(draws, scene["place"])
        ahead, aside = x - robot["at_m"][0], y - robot["at_m"][1]
        off = math.atan2(aside, ahead) - math.radians(robot["heading_deg"])
        if math.hypot(ahead, aside) > _NEAREST_M and abs(math.remainder(off, math.tau)) < across:
            break
    return [x, y]


def _seats(scene: Data) -> list[list[float]]:
    """Places of what one may sit on."""
    things = scene.get("things", ())
    return [thing["at_m"] for thing in things if "at_m" in thing and KINDS[thing["kind"]].is_seat]
