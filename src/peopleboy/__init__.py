"""Simulate, track and evaluate people around a mobile robot with thermal, colour and depth cameras.

Importing the package registers its gymnasium environments. All public names are loaded at their first use.
`__all__` and `dir()` list those to start with; the others are types of arguments and results, and parts of
the loop.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from peopleboy.registration import register_environments

if TYPE_CHECKING:
    __version__: str
    from peopleboy.bad_input import BadInput
    from peopleboy.behaviours.behaviour import Behaviour as Behaviour
    from peopleboy.behaviours.behaviour import Command as Command
    from peopleboy.behaviours.make_behaviour import make_behaviour as make_behaviour
    from peopleboy.behaviours.percept import Percept as Percept
    from peopleboy.geometry.camera_calibration import Calibration as Calibration
    from peopleboy.geometry.camera_calibration import PinholeCalibration as PinholeCalibration
    from peopleboy.scenarios.environments.environment import PeopleBoyEnv as PeopleBoyEnv
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.files.scenario import Scenario as Scenario
    from peopleboy.scenarios.loop.loop import Tick as Tick
    from peopleboy.scenarios.loop.loop import closed_loop as closed_loop
    from peopleboy.scenarios.loop.scenario_world import World
    from peopleboy.scenarios.running.evaluate_run import evaluate_run
    from peopleboy.scenarios.running.frame_cache import Film as Film
    from peopleboy.scenarios.running.frame_cache import film as film
    from peopleboy.scenarios.running.frame_cache import frames_of as frames_of
    from peopleboy.scenarios.running.run import run
    from peopleboy.scenarios.running.run_options import RunOptions
    from peopleboy.scenarios.scores.run_scores import RunScores as RunScores
    from peopleboy.sim.observation import Observation as Observation
    from peopleboy.sim.truth.truth import PersonTruth as PersonTruth
    from peopleboy.sim.truth.truth import Truth as Truth
    from peopleboy.sim.world_config import WorldConfig as WorldConfig
    from peopleboy.tracker.evaluation.evaluate import Scores as Scores
    from peopleboy.tracker.evaluation.evaluate import evaluate
    from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
    from peopleboy.tracker.footage.box_kinds import BoxKind as BoxKind
    from peopleboy.tracker.footage.grey import Radiometry as Radiometry
    from peopleboy.tracker.frame import Frame
    from peopleboy.tracker.frame import Odometry as Odometry
    from peopleboy.tracker.image_tracker import ImageTracker
    from peopleboy.tracker.track import FloorPlace as FloorPlace
    from peopleboy.tracker.track import Status as Status
    from peopleboy.tracker.track import Track
    from peopleboy.tracker.trackers import Tracker as Tracker
    from peopleboy.tracker.trackers import make_tracker

_HOMES: Final = {
    "BadInput": "bad_input",
    "Behaviour": "behaviours.behaviour",
    "BoxKind": "tracker.footage.box_kinds",
    "Calibration": "geometry.camera_calibration",
    "Command": "behaviours.behaviour",
    "Film": "scenarios.running.frame_cache",
    "FloorPlace": "tracker.track",
    "Frame": "tracker.frame",
    "ImageTracker": "tracker.image_tracker",
    "Observation": "sim.observation",
    "Odometry": "tracker.frame",
    "PeopleBoyEnv": "scenarios.environments.environment",
    "Percept": "behaviours.percept",
    "PersonTruth": "sim.truth.truth",
    "PinholeCalibration": "geometry.camera_calibration",
    "Radiometry": "tracker.footage.grey",
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
    "Frame",
    "ImageTracker",
    "RunOptions",
    "Track",
    "TrackBoxes",
    "TrueBoxes",
    "World",
    "evaluate",
    "evaluate_run",
    "load_scenario",
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
    return sorted([*__all__, "__version__"])
