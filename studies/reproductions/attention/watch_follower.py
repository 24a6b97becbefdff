"""Whether a robot goes on with the person it followed after that one was away, and with nobody else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_eyes
from peopleboy.studies.reproductions.attention.watch_absence import who_is_who

if TYPE_CHECKING:
    from peopleboy.sim.world import World

AWAY_S: Final = 8.0
"""Not followed for longer than this somebody is away."""

LEFT_S: Final = 30.0
"""Of a time like that which the end of the run cuts off sooner nobody knows how it would have ended."""


def watch_follower(scenario: Scenario, seed: int, name: str) -> dict[str, Any]:
    """Let a robot follow the first person of a scenario with a tracker.

    Returns:
        Plain data: "images"; "right" and "wrong", in how many it follows the person and somebody else;
        "absences", how often it did not follow the person for longer, and "resumed", after how many of those
        it went on with this one.
    """
    from peopleboy.sim.world import World  # here, as what was made before can be read without PyBullet

    world: World  # the tracker looks at it only once it is built
    eyes = make_eyes(name, seed, lambda: world.truth())
    scenario = scenario.mounting(eyes.cameras)
    config = scenario.world(seed)
    leader = config.people[0].name
    with World(config) as world:
        frames = round(scenario.duration_s * config.control_hz)
        ticks = closed_loop(world, eyes, scenario.make_behaviour(), frames)
        followed = [_followed(tick) for tick in ticks]
    after = resumptions(followed, leader, *(round(s * config.control_hz) for s in (AWAY_S, LEFT_S)))
    return {
        "images": len(followed),
        "right": sum(who == leader for who in followed),
        "wrong": sum(who not in (None, leader) for who in followed),
        "absences": len(after),
        "resumed": sum(after),
    }


def _followed(tick: Tick) -> str | None:
    """Name the person that the robot follows; None for nobody, or for what is none."""
    return None if tick.following is None else who_is_who(tick.tracks, tick.truth).get(tick.following)


def resumptions(followed: list[str | None], leader: str, away: int, left: int) -> list[bool]:
    """Tell of each time that the robot did not follow the person for longer whether it went on with this one.

    Args:
        followed: whom it followed, image by image.
        leader: the person's name.
        away: images from which on it counts ...
        left: ... and of the last time, which the end cuts off.
    """
    ours = [k for k, who in enumerate(followed) if who == leader]
    ends = [*ours[1:], len(followed)]
    least = [*(away for _ in ours[1:]), left]
    long = [
        (one, later)
        for one, later, at_least in zip(ours, ends, least, strict=False)
        if later - one > at_least
    ]
    return [later < len(followed) and not any(followed[one + 1 : later]) for one, later in long]
