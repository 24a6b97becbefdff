"""Behaviours by name, each under guard."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Behaviour, Command, make_own_behaviour
from peopleboy.behaviours.corridor.follow_corridor import CorridorConfig, FollowCorridor
from peopleboy.behaviours.following.follow_person import FollowConfig, FollowPerson
from peopleboy.behaviours.patrol import Patrol
from peopleboy.behaviours.safety_guard import Guarded
from peopleboy.behaviours.safety_limits import SafetyConfig
from peopleboy.behaviours.scripted import Scripted, Stand


def make_behaviour(
    name: str,
    *,
    script: Sequence[tuple[float, Command]] = (),
    follow: FollowConfig | None = None,
    corridor: CorridorConfig | None = None,
    safety: SafetyConfig | None = None,
) -> Guarded:
    """Make a behaviour by its name; whatever it commands, the sonars limit.

    Args:
        name: "stand", "follow_person", "follow_corridor", "patrol" or "scripted"; or "module:Class", a class
            of your own, which is called without an argument.
        script: for "scripted", pairs of a time [s] and the command from then on.
        follow: for "follow_person", its gains and limits.
        corridor: for "follow_corridor", its sense, gains and limits.
        safety: the robot's limits and outline.

    Raises:
        BadInput: there is no such behaviour, or the script's times do not rise.
    """
    if ":" in name:
        return Guarded(make_own_behaviour(name), safety)
    makers: dict[str, Callable[[], Behaviour]] = {
        "stand": Stand,
        "follow_person": lambda: FollowPerson(follow),
        "follow_corridor": lambda: FollowCorridor(corridor),
        "patrol": lambda: Patrol(FollowCorridor(corridor), follow),
        "scripted": lambda: Scripted(script),
    }
    if name not in makers:
        known = ", ".join(sorted(makers))
        raise BadInput(f"behaviour: unknown name '{name}'; there are {known}, and your own as module:Class")
    return Guarded(makers[name](), safety)
