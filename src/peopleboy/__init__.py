"""Simulate, track and evaluate people around a mobile robot with thermal, colour and depth cameras.

Importing the package registers its gymnasium environments. The names below are loaded at their first use.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from peopleboy.registration import register_environments

if TYPE_CHECKING:
    __version__: str
    from peopleboy.bad_input import BadInput
    from peopleboy.behaviours.behaviour import Behaviour, Command
    from peopleboy.behaviours.make_behaviour import make_behaviour
    from peopleboy.behaviours.percept import Percept
    from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
    from peopleboy.scenarios.environments.environment import PeopleBoyEnv
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.files.scenario import Scenario
    from peopleboy.scenarios.loop.loop import Tick, closed_loop
    from peopleboy.scenarios.loop.scenario_world import World
    from peopleboy.scenarios.running.evaluate_run import evaluate_run
    from peopleboy.scenarios.running.frame_cache import Film, film, frames_of
    from peopleboy.scenarios.running.run import run
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.run_scores import RunScores
    from peopleboy.sim.observation import Observation
    from peopleboy.sim.truth.truth import PersonTruth, Truth
    from peopleboy.sim.world_config import WorldConfig
    from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
    from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
    from peopleboy.tracker.footage.box_kinds import BoxKind
    from peopleboy.tracker.frame import Frame, Odometry
    from peopleboy.tracker.track import FloorPlace, Status, Track
    from peopleboy.tracker.trackers import Tracker, make_tracker

_HOMES: Final = {
    "BadInput": "bad_input",
    "Behaviour": "behaviours.behaviour",
    "BoxKind": "tracker.footage.box_kinds",
    "Calibration": "geometry.camera_calibration",
    "Command": "behaviours.behaviour",
    "Film": "scenarios.running.frame_cache",
    "FloorPlace": "tracker.track",
    "Frame": "tracker.frame",
    "Observation": "sim.observation",
    "Odometry": "tracker.frame",
    "PeopleBoyEnv": "scenarios.environments.environment",
    "Percept": "behaviours.percept",
    "PersonTruth": "sim.truth.truth",
    "PinholeCalibration": "geometry.camera_calibration",
    "RunOptions": "scenarios.running.run_options",
    "RunScores": "scenarios.scores.run_scores",
    "Scenario": "scenarios.files.scenario",
    "Scores": "tracker.evaluation.evaluate",
    "Status": "tracker.track",
    "Tick": "scenarios.loop.loop",
    "Track": "tracker.track",
    "TrackBoxes": "tracker.evaluation.sequence",
    "Tracker": "tracker.trackers",
    "TrueBoxes": "tracker.evaluation.sequence",
    "Truth": "sim.truth.truth",
    "World": "scenarios.loop.scenario_world",
    "WorldConfig": "sim.world_config",
    "closed_loop": "scenarios.loop.loop",
    "evaluate": "tracker.evaluation.evaluate",
    "evaluate_run": "scenarios.running.evaluate_run",
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
    "Calibration",
    "Command",
    "Film",
    "FloorPlace",
    "Frame",
    "Observation",
    "Odometry",
    "PeopleBoyEnv",
    "Percept",
    "PersonTruth",
    "PinholeCalibration",
    "RunOptions",
    "RunScores",
    "Scenario",
    "Scores",
    "Status",
    "Tick",
    "Track",
    "TrackBoxes",
    "Tracker",
    "TrueBoxes",
    "Truth",
    "World",
    "WorldConfig",
    "closed_loop",
    "evaluate",
    "evaluate_run",
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
    if name == "__version__":
        from importlib.metadata import version  # here, as it takes a while

        return version("peopleboy")
    if name not in _HOMES:
        raise AttributeError(f"module 'peopleboy' has no attribute {name!r}")
    value = getattr(import_module(f"peopleboy.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
