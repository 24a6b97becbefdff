"""An episode as a run's folder: the same world once more, in which the robot repeats its commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.run_scores import RunScores


def save_episode(
    scenario: Scenario, commands: Sequence[Command], frames: int, options: RunOptions, rate_hz: int
) -> RunScores:
    """Write the folder of the run that an episode was.

    Args:
        scenario: what was played.
        commands: the robot's commands, one a step.
        frames: how many images there were.
        options: of the run.
        rate_hz: steps a second.

    Raises:
        BadInput: the folder cannot be written to.
    """
    lasted_s = frames / rate_hz
    # Whoever was still to come must be able to; the robot waits for them.
    latest_s = max((person.enter_s for person in scenario.people(options.seed)), default=0.0)
    if latest_s >= lasted_s:
        lasted_s = min(latest_s + 1.0 / rate_hz, scenario.duration_s)
    sound = replace(scenario, spec=replace(scenario.spec, faults=()))
    return run(sound.driven([*commands, STOP]).lasting(lasted_s), options, lambda _tick, _frames: None)
