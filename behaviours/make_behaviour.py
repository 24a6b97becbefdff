"""Registry of behaviours; each is wrapped by the safety guard, which limits its commands by the sonars."""

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

from peopleboy.bad_input import BadInput
from peopleboy.own_code import guarded, load_own
from peopleboy.registry import Registry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from peopleboy.behaviours.behaviour import Behaviour, Command
    from peopleboy.behaviours.corridor.follow_corridor import FollowCorridorConfig
    from peopleboy.behaviours.following.follow_person import FollowConfig
    from peopleboy.behaviours.safety_guard import Guarded
    from peopleboy.behaviours.safety_limits import SafetyConfig

BEHAVIOURS: Final = Registry("behaviour", "peopleboy.behaviours")
"""The behaviours by name. Built-in ones are called with `BehaviourSettings`, others without arguments.

A behaviour is registered by decorating the function below that makes it.
"""
SCRIPTED: Final = "scripted"
"""The behaviour that is only available in scenario files, since they contain the commands."""

_CALL: Final = "without an argument"


@dataclass(frozen=True, slots=True, kw_only=True)
class BehaviourSettings:
    """Settings of the behaviour in a scenario.

    Attributes:
        script: pairs of a start time [s] and a command.
        follow: gains and limits of person following; None for the defaults.
        corridor: sensor, gains and limits of corridor following; None for the defaults.
    """

    script: "Sequence[tuple[float, Command]]" = ()
    follow: "FollowConfig | None" = None
    corridor: "FollowCorridorConfig | None" = None


@BEHAVIOURS.register("stand", summary="stands still")
def _stand(settings: BehaviourSettings) -> "Behaviour":  # noqa: ARG001
    from peopleboy.behaviours.scripted import Stand

    return Stand()


@BEHAVIOURS.register(
    "follow_person",
    summary="searches for a person, and follows at the distance at which the person is `keep_height` "
    "tall in the image",
)
def _follow_person(settings: BehaviourSettings) -> "Behaviour":
    from peopleboy.behaviours.following.follow_person import FollowPerson

    return FollowPerson(settings.follow)


@BEHAVIOURS.register(
    "follow_corridor",
    summary="drives along the middle of a corridor, turns at its end, and waits for people in its path",
)
def _follow_corridor(settings: BehaviourSettings) -> "Behaviour":
    from peopleboy.behaviours.corridor.follow_corridor import FollowCorridor

    return FollowCorridor(settings.corridor)


@BEHAVIOURS.register(
    "patrol",
    summary="follows a corridor until it detects a person, follows that person for a while, and returns",
)
def _patrol(settings: BehaviourSettings) -> "Behaviour":
    from peopleboy.behaviours.corridor.follow_corridor import FollowCorridor
    from peopleboy.behaviours.patrol import Patrol

    return Patrol(FollowCorridor(settings.corridor), settings.follow)


@BEHAVIOURS.register(
    "go_to",
    summary="drives to `goal_m`, around obstacles and people that it detects on the way",
)
def _go_to(settings: BehaviourSettings) -> "Behaviour":  # noqa: ARG001
    from peopleboy.behaviours.go_to import GoTo

    return GoTo()


@BEHAVIOURS.register(SCRIPTED, summary="drives according to `commands`")
def _scripted(settings: BehaviourSettings) -> "Behaviour":
    from peopleboy.behaviours.scripted import Scripted

    return Scripted(settings.script)


def is_own(name: str) -> bool:
    """Return whether a name is that of an external behaviour: "module:Class", or of another package."""
    return ":" in name or BEHAVIOURS.is_plugged_in(name)


def make_behaviour(
    name: str,
    *,
    script: "Sequence[tuple[float, Command]]" = (),
    follow: "FollowConfig | None" = None,
    corridor: "FollowCorridorConfig | None" = None,
    goal_m: "tuple[float, float] | None" = None,
    safety: "SafetyConfig | None" = None,
) -> "Guarded":
    """Make a behaviour by its name, limited by the safety guard.

    Args:
        name: one of `BEHAVIOURS`; or "module:Class", your own class, which is called without arguments.
        script: for "scripted", pairs of a start time [s] and a command.
        follow: for "follow_person", its gains and limits.
        corridor: for "follow_corridor", its sensor, gains and limits.
        goal_m: [m] x, y of the robot's goal in the place; behaviours get it in `Percept.goal_m`.
        safety: the robot's limits and outline.

    Raises:
        BadInput: the name is unknown, or the script's times do not increase.
    """
    from peopleboy.behaviours.behaviour import checked_behaviour
    from peopleboy.behaviours.safety_guard import Guarded

    guarded_by = partial(Guarded, config=safety, goal_m=goal_m)
    if ":" in name:
        own = load_own("behaviour", name, _CALL)()
        return guarded_by(checked_behaviour(own, f"behaviour {name!r}"))
    if name not in BEHAVIOURS:
        known = ", ".join(sorted(BEHAVIOURS))
        raise BadInput(f"unknown behaviour {name!r}; choose from {known}, or your own as module:Class")
    if is_own(name):
        made = guarded("behaviour", name, _CALL, BEHAVIOURS[name])()
        return guarded_by(checked_behaviour(made, f"behaviour {name!r}"))
    settings = BehaviourSettings(script=script, follow=follow, corridor=corridor)
    return guarded_by(BEHAVIOURS[name](settings))
