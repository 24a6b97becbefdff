"""A robot testbed in simulation: thermal and colour cameras among walking people, with exact truth.

Importing it registers the environments with gymnasium; the names below are loaded when they are first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from peopleboy.registration import register_environments

if TYPE_CHECKING:
    from peopleboy.bad_input import BadInput
    from peopleboy.behaviours.behaviour import Behaviour, Command
    from peopleboy.behaviours.make_behaviour import make_behaviour
    from peopleboy.behaviours.percept import Percept
    from peopleboy.scenarios.environments.environment import PeopleBoyEnv
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.loop.loop import closed_loop
    from peopleboy.scenarios.running.frame_cache import film, frames_of
    from peopleboy.scenarios.running.run import run
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.sim.world import World
    from peopleboy.tracker.evaluation.evaluate import evaluate
    from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
    from peopleboy.tracker.footage.box_kinds import BoxKind
    from peopleboy.tracker.frame import Frame
    from peopleboy.tracker.track import Status, Track
    from peopleboy.tracker.trackers import Tracker, make_tracker

_HOMES: Final = {
    "BadInput": "bad_input",
    "Behaviour": "behaviours.behaviour",
    "BoxKind": "tracker.footage.box_kinds",
    "Command": "behaviours.behaviour",
    "Frame": "tracker.frame",
    "PeopleBoyEnv": "scenarios.environments.environment",
    "Percept": "behaviours.percept",
    "RunOptions": "scenarios.running.run_options",
    "Status": "tracker.track",
    "Track": "tracker.track",
    "TrackBoxes": "tracker.evaluation.sequence",
    "Tracker": "tracker.trackers",
    "TrueBoxes": "tracker.evaluation.sequence",
    "World": "sim.world",
    "closed_loop": "scenarios.loop.loop",
    "evaluate": "tracker.evaluation.evaluate",
    "film": "scenarios.running.frame_cache",
    "frames_of": "scenarios.running.frame_cache",
    "load_scenario": "scenarios.files.load",
    "make_behaviour": "behaviours.make_behaviour",
    "make_tracker": "tracker.trackers",
    "run": "scenarios.running.run",
}

__all__ = [
    "BadInput",
    "Behaviour",
    "BoxKind",
    "Command",
    "Frame",
    "PeopleBoyEnv",
    "Percept",
    "RunOptions",
    "Status",
    "Track",
    "TrackBoxes",
    "Tracker",
    "TrueBoxes",
    "World",
    "closed_loop",
    "evaluate",
    "film",
    "frames_of",
    "load_scenario",
    "make_behaviour",
    "make_tracker",
    "run",
]

register_environments()


def __getattr__(name: str) -> Any:
    """Load a public name when it is first used: most users need few of them, and all cost seconds."""
    if name not in _HOMES:
        raise AttributeError(f"module 'peopleboy' has no attribute {name!r}")
    value = getattr(import_module(f"peopleboy.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
