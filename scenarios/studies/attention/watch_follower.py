"""Whether a robot goes on with the person it followed after that one was away, and with nobody else."""

from __future__ import annotations

from typing import Any, Final

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_eyes
from peopleboy.scenarios.studies.attention.watch_absence import longest_gap, who_is_who
from peopleboy.sim.world import World

AWAY_S: Final = 8.0
"""Out of the robot's sight for longer than this somebody is away."""


def watch_follower(scenario: Scenario, seed: int, name: str) -> dict[str, Any]:
    """Let a robot follow the first person of a scenario with a tracker.

    Returns:
        Plain data: "images"; "right" and "wrong", in how many it follows the person and somebody else;
        "absences", how often it had not followed the person for a while and the person had been out of sight
        as long, and "resumed", after how many of those it went on with this one.
    """
    world: World  # the tracker looks at it only once it is built
    eyes = make_eyes(name, seed, lambda: world.truth())
    scenario = scenario.mounting(eyes.cameras)
    config = scenario.world(seed)
    followed: list[str | None] = []
    leader = config.people[0].name
    with World(config) as world:
        frames = round(scenario.duration_s * config.control_hz)
        for tick in closed_loop(world, eyes, scenario.make_behaviour(), frames):
            followed.append(_followed(tick))
    away = round(AWAY_S * config.control_hz)
    after = resumptions(followed, leader, away)
    return {
        "images": len(followed),
        "right": sum(who == leader for who in followed),
        "wrong": sum(who not in (None, leader) for who in followed),
        "absences": len(after),
        "resumed": sum(after),
    }
