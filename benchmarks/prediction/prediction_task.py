"""Predictions in one random world, from true tracks and from those of a tracker."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.prediction.prediction_metrics import TIMES_S, squared_mahalanobis
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import OracleTracker, make_named_tracker
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.engine.task import ReportProgress
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.prediction import Floats, Forecast, predict_positions
from peopleboy.tracker.track import FloorPlace, Status

_EVERY: Final = 6  # images between two predictions
_NEAR_M: Final = 1.0  # distance from a true person within which a track is of that person
_CONTROL_HZ: Final = 15.0


class Errors(NamedTuple):
    """Errors (N, T) [m] and squared Mahalanobis distances (N, T) of predictions at `TIMES_S`."""

    error_m: Floats
    mahalanobis2: Floats


@dataclass(frozen=True, slots=True)
class PredictionTask:
    """Predictions in one random world, by its number."""

    world: int
    tracker: str

    @property
    def name(self) -> str:
        """Name for messages."""
        return f"world {self.world}, {self.tracker}"

    @property
    def size(self) -> int:
        """Number of scenes."""
        return 1

    def __call__(self, report_progress: ReportProgress) -> dict[str, Errors]:
        """Run the world; return the errors by tracks."""
        found = _predictions(self.world, self.tracker)
        report_progress(1)
        return found


class Instant(NamedTuple):
    """Floor positions of the tracks at one frame, and the true robot."""

    frame: int
    places: Sequence[FloorPlace]
    robot: Pose2


def _predictions(number: int, tracker: str) -> dict[str, Errors]:
    data = random_world(number) | {"physics": "kinematic"}
    scenario = parse_scenario(data, source=f"world {number}", folder=Path())
    true_m: list[dict[int, tuple[float, float]]] = []
    truths: list[Truth] = []
    instants: dict[str, list[Instant]] = {name: [] for name in (ORACLE, tracker)}
    oracle = OracleTracker(lambda: truths[-1])
    people_tracker = make_named_tracker(tracker, number, lambda: world.truth())
    scenario = scenario.mounting(people_tracker.cameras)
    with SimulatedWorld(scenario.world(number)) as world:
        for tick in closed_loop(world, people_tracker, scenario.make_behaviour(), scenario.frames):
            truths.append(tick.truth)
            true_m.append({one.id: one.position_m for one in tick.truth.people})
            true_tracks = oracle.update(Frame(images={}, time_s=tick.observation.time_s))
            if tick.frame % _EVERY == 0:
                for name in instants:
                    tracks = true_tracks if name == ORACLE else tick.tracks
                    places = [one.place for one in tracks if one.place and one.status is not Status.TENTATIVE]
                    instants[name].append(Instant(len(true_m) - 1, places, tick.truth.robot))
    return {name: _errors(several, true_m) for name, several in instants.items()}


def _errors(instants: Sequence[Instant], true_m: Sequence[Mapping[int, tuple[float, float]]]) -> Errors:
    """Return the errors of all predictions of tracks that are of a person."""
    empty = np.empty((0, len(TIMES_S)))
    parts = [Errors(empty, empty)]
    for instant in instants:
        later_m, is_found = _true_places(instant, true_m)
        forecast = predict_positions(instant.places, TIMES_S)
        found = Forecast(forecast.mean_m[is_found], forecast.covariance_m2[is_found])
        error_m = np.linalg.norm(found.mean_m - later_m[is_found], axis=2)
        parts.append(Errors(error_m, squared_mahalanobis(found, later_m[is_found])))
    return Errors(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _true_places(
    instant: Instant, places: Sequence[Mapping[int, tuple[float, float]]]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return true places (K, T, 2) of the tracks at `TIMES_S`, and which tracks (K,) are of a person."""
    true_m = np.full((len(instant.places), len(TIMES_S), 2), np.nan)
    is_found = np.zeros(len(instant.places), np.bool_)
    robot = instant.robot
    now = {key: robot.to_local(at_m) for key, at_m in places[instant.frame].items()}
    for row, place in enumerate(instant.places):
        apart_m = {key: math.dist(place.position_m, at_m) for key, at_m in now.items()}
        key = min(apart_m, key=apart_m.__getitem__, default=None)
        if key is None or apart_m[key] > _NEAR_M:
            continue
        is_found[row] = True
        for column, after_s in enumerate(TIMES_S):
            frame = instant.frame + round(after_s * _CONTROL_HZ)
            if frame < len(places) and key in places[frame]:
                true_m[row, column] = robot.to_local(places[frame][key])
    return true_m, is_found
