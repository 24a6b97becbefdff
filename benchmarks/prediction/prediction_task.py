"""Predictions in one random world, from true tracks and from those of a tracker."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.loop.tracker_by_name import OracleTracker, make_named_tracker
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.engine.task import ReportProgress
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import Frame, Odometry
from peopleboy.tracker.prediction.prediction_metrics import TIMES_S, squared_mahalanobis
from peopleboy.tracker.prediction.predictors import PREDICTORS, make_predictor
from peopleboy.tracker.prediction.tracked_people import Floats, Forecast, PathMemory, TrackedPeople

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
        """Run the world; return the errors by tracks and predictor."""
        found = _predictions(self.world, self.tracker)
        report_progress(1)
        return found


class Instant(NamedTuple):
    """Tracked people at one frame, and the true people and robot."""

    frame: int
    people: TrackedPeople
    truth: Truth


def _predictions(number: int, tracker: str) -> dict[str, Errors]:
    data = random_world(number) | {"physics": "kinematic"}
    scenario = parse_scenario(data, source=f"world {number}", folder=Path())
    places: list[dict[int, tuple[float, float]]] = []
    truths: list[Truth] = []
    memories = {name: PathMemory() for name in dict.fromkeys((ORACLE, tracker))}
    instants: dict[str, list[Instant]] = {name: [] for name in memories}
    oracle, moved = OracleTracker(lambda: truths[-1]), _Motion()
    people_tracker = make_named_tracker(tracker, number, lambda: world.truth())
    scenario = scenario.mounting(people_tracker.cameras)
    with SimulatedWorld(scenario.world(number)) as world:
        for tick in closed_loop(world, people_tracker, scenario.make_behaviour(), scenario.frames):
            truths.append(tick.truth)
            places.append({one.id: one.position_m for one in tick.truth.people})
            motion, frame = moved.since(tick), Frame(images={}, time_s=tick.observation.time_s)
            for name, memory in memories.items():
                tracks = oracle.update(frame) if name == ORACLE else tick.tracks
                people = memory.update(tracks, frame.time_s, motion)
                if tick.frame % _EVERY == 0 and len(people):
                    instants[name].append(Instant(len(places) - 1, people, tick.truth))
    return {
        f"{predictor}, {name}": _errors(predictor, several, places)
        for predictor in PREDICTORS
        for name, several in instants.items()
    }


class _Motion:
    """Motion of the robot between ticks by odometry."""

    def __init__(self) -> None:
        self._last: Tick | None = None

    def since(self, tick: Tick) -> Odometry | None:
        last, self._last = self._last, tick
        if last is None:
            return None
        return Odometry.from_motion(tick.observation.odometry.relative_to(last.observation.odometry))


def _errors(
    predictor: str, instants: Sequence[Instant], places: Sequence[Mapping[int, tuple[float, float]]]
) -> Errors:
    """Return the errors of all predictions of tracks that are of a person."""
    model, parts = make_predictor(predictor), []
    for instant in instants:
        true_m, is_found = _true_places(instant, places)
        forecast = model.predict(instant.people, TIMES_S)
        found = Forecast(forecast.mean_m[is_found], forecast.covariance_m2[is_found])
        error_m = np.linalg.norm(found.mean_m - true_m[is_found], axis=2)
        parts.append(Errors(error_m, squared_mahalanobis(found, true_m[is_found])))
    empty = np.empty((0, len(TIMES_S)))
    return (
        Errors(*(np.concatenate([empty, *part]) for part in zip(*parts, strict=True)))
        if parts
        else Errors(empty, empty)
    )


def _true_places(
    instant: Instant, places: Sequence[Mapping[int, tuple[float, float]]]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return true places (K, T, 2) of the tracks at `TIMES_S`, and which tracks (K,) are of a person."""
    true_m = np.full((len(instant.people), len(TIMES_S), 2), np.nan)
    is_found = np.zeros(len(instant.people), np.bool_)
    robot = instant.truth.robot
    now = {key: robot.to_local(at_m) for key, at_m in places[instant.frame].items()}
    for row, place in enumerate(instant.people.position_m):
        key = min(now, key=lambda one: float(np.hypot(*(place - now[one]))), default=None)
        if key is None or np.hypot(*(place - now[key])) > _NEAR_M:
            continue
        is_found[row] = True
        for column, after_s in enumerate(TIMES_S):
            frame = instant.frame + round(after_s * _CONTROL_HZ)
            if frame < len(places) and key in places[frame]:
                true_m[row, column] = robot.to_local(places[frame][key])
    return true_m, is_found
