"""Whether a robot goes on with the person it followed after that one was away, and with nobody else."""

from __future__ import annotations

from typing import Any, Final

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_eyes
from peopleboy.scenarios.studies.attention.watch_absence import who_is_who
from peopleboy.sim.world import World

AWAY_S: Final = 8.0
"""Not followed for longer than this somebody is away."""


def watch_follower(scenario: Scenario, seed: int, name: str) -> dict[str, Any]:
    """Let a robot follow the first person of a scenario with a tracker.

    Returns:
        Plain data: "images"; "right" and "wrong", in how many it follows the person and somebody else;
        "absences", how often it did not follow the person for longer, and "resumed", after how many of those
        it went on with this one.
    """
    world: World  # the tracker looks at it only once it is built
    eyes = make_eyes(name, seed, lambda: world.truth())
    scenario = scenario.mounting(eyes.cameras)
    config = scenario.world(seed)
    leader = config.people[0].name
    with World(config) as world:
        frames = round(scenario.duration_s * config.control_hz)
        ticks = closed_loop(world, eyes, scenario.make_behaviour(), frames)
        followed = [_followed(tick) for tick in ticks]
    away = round(AWAY_S * config.control_hz)
    after = resumptions(followed, leader, away)
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


def resumptions(followed: list[str | None], leader: str, away: int) -> list[bool]:
    """Tell of each time that the robot did not follow the person for longer whether it went on with this one.

    Args:
        followed: whom it followed, image by image.
        leader: the person's name.
        away: images from which on it counts.
    """
    ours = [k for k, who in enumerate(followed) if who == leader]
    ends = [*ours[1:], len(followed)]
    long = [(one, later) for one, later in zip(ours, ends, strict=True) if later - one > away]
    return [later < len(followed) and not any(followed[one + 1 : later]) for one, later in long]
