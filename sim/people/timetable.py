"""When a person that nobody disturbs is where."""

from __future__ import annotations

from typing import NamedTuple

from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.people.walking.surroundings import ALONE
from peopleboy.sim.people.walking.walk import Walker

_STEP_S = 0.05
_LONGEST_S = 3600.0


class Entry(NamedTuple):
    """One line of a timetable: time [s], place [m], and what happens."""

    time_s: float
    x_m: float
    y_m: float
    what: str


def timetable(config: PersonConfig) -> list[Entry]:
    """List when a person enters, passes or reaches its waypoints, sets off again and leaves.

    It is what happens when neither the robot nor other people are in the way.
    """
    walker = Walker(config.path, yields=False, radius_m=0.0)
    time_s = config.enter_s
    entries = [_entry(time_s, walker, "enters")]
    while walker.reached < len(config.path) - 1 and not _has_left(config, time_s):
        was_walking, reached = walker.is_walking, walker.reached
        walker.step(_STEP_S, ALONE)
        time_s += _STEP_S
        if walker.reached > reached:
            is_stop = not walker.is_walking
            entries.append(_entry(time_s, walker, f"{'reaches' if is_stop else 'passes'} {walker.reached}"))
        has_stood = len(entries) > 1 or config.path[0].pause_s > 0.0
        if walker.is_walking and not was_walking and has_stood:
            entries.append(_entry(time_s, walker, f"leaves {walker.reached}"))
        if time_s > _LONGEST_S:
            break
    if config.leave_s is not None:
        entries.append(_entry(config.leave_s, walker, "leaves the world"))
    return entries


def _has_left(config: PersonConfig, time_s: float) -> bool:
    return config.leave_s is not None and time_s >= config.leave_s - 1e-9


def _entry(time_s: float, walker: Walker, what: str) -> Entry:
    return Entry(round(time_s, 3), float(walker.position[0]), float(walker.position[1]), what)
