"""Simulated walks without images: training samples of predictors."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.blind_drive import blind_percept
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.studies.training.samples import Arrays
from peopleboy.tracker.prediction.constant_velocity import axes
from peopleboy.tracker.prediction.motion_network import KNOTS_S
from peopleboy.tracker.prediction.tracked_people import STEP_S, STEPS, Floats, TrackedPeople

WORLD_S: Final = 30.0
"""Duration of a random world [s]."""

_FRAMES: Final = 3  # images in STEP_S, at 15 Hz
# Errors of a simulated tracker, greatest deviations along and across the line of sight.
_NOISE_M: Final = (0.5, 0.12)  # of a place
_NOISE_M_S: Final = (0.5, 0.35)  # of a velocity
_EXACT: Final = 0.25  # share of people without errors
_REPORTED: Final = (
    0.8,
    2.5,
)  # reported deviation relative to the true one; the filter of `detection` doubts more
_KEPT: Final = 0.9  # correlation of the errors of two places that are STEP_S apart
_YOUNG: Final = 0.3  # share of people whose path is known in part only


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Walks(Arrays):
    """People and robot of one run, every `STEP_S`, in the world frame.

    Attributes:
        people: (N, P, 4) position [m] and velocity [m/s]; NaN while a person is absent.
        robot: (N, 5) position [m], heading [rad], and velocity [m/s].
    """

    people: Floats
    robot: Floats


class WalkSample(NamedTuple):
    """People at one instant, and where they are later.

    Attributes:
        people: as a tracker reports them.
        later_m: (K, 5, 2) places at `KNOTS_S`, in the frame of the people; NaN where they are absent.
    """

    people: TrackedPeople
    later_m: Floats


def collect_world(seed: int) -> Walks:
    """Simulate a random world."""
    data = random_world(seed, WORLD_S) | {"physics": "kinematic", "detail": "plain"}
    return collect(parse_scenario(data, source=f"world {seed}", folder=Path()), seed)


def collect_library(name: str, seed: int) -> Walks:
    """Simulate a scenario of the library; a robot that needs a tracker stands."""
    scenario = load_scenario(name)
    return collect(scenario.steered_by("stand") if scenario.needs_tracker else scenario, seed)


def collect(scenario: Scenario, seed: int) -> Walks:
    """Simulate a scenario."""
    rows: list[dict[int, tuple[float, ...]]] = []
    robots = []
    for scene in _scenes(scenario, seed):
        rows.append({one.id: (*one.position_m, *one.velocity_m_s) for one in scene.people})
        pose, speed = scene.robot, scene.robot_velocity[0]
        ahead = speed * np.array([np.cos(pose.heading), np.sin(pose.heading)])
        robots.append((pose.x, pose.y, pose.heading, *ahead))
    ids = {key: column for column, key in enumerate(sorted({key for row in rows for key in row}))}
    people = np.full((len(rows), len(ids), 4), np.nan)
    for number, row in enumerate(rows):
        for key, values in row.items():
            people[number, ids[key]] = values
    return Walks(people=people, robot=np.reshape(robots, (-1, 5)))


def _scenes(scenario: Scenario, seed: int) -> Iterator[ImageFreeTruth]:
    """Simulate a scenario without images, and yield its people every `STEP_S`."""
    from peopleboy.sim.world import (
        SimulatedWorld,  # imported late: reading existing samples does not need PyBullet
    )

    drive = scenario.make_behaviour()
    with SimulatedWorld(scenario.world(seed)) as world:
        for frame in range(scenario.frames):
            if frame % _FRAMES == 0:
                yield world.scene()
            command = drive.command(blind_percept(world.sense()))
            world.step(command.linear_m_s, command.angular_rad_s)


def samples_of(walks: Walks, rng: np.random.Generator, every: int = 2) -> Iterator[WalkSample]:
    """Yield the people at every second instant, with the errors of a tracker."""
    knots = np.round(KNOTS_S / STEP_S).astype(int)
    for now in range(STEPS - 1, len(walks.people) - int(knots[0]), every):
        is_here = np.isfinite(walks.people[now, :, 0])
        if not is_here.any():
            continue
        later = np.full((is_here.sum(), len(knots), 2), np.nan)
        is_known = now + knots < len(walks.people)
        future = walks.people[now + knots[is_known]][:, is_here, :2].swapaxes(0, 1)
        later[:, is_known] = future - walks.robot[now, :2]
        yield WalkSample(_tracked(walks, now, is_here, rng), later)


def _tracked(walks: Walks, now: int, is_here: NDArray[np.bool_], rng: np.random.Generator) -> TrackedPeople:
    """Return the people who are present as a tracker with errors of random size reports them."""
    count = int(is_here.sum())
    path = walks.people[now - STEPS + 1 : now + 1, is_here, :2].swapaxes(0, 1) - walks.robot[now, :2]
    size = np.where(rng.random(count) < _EXACT, 0.0, rng.random(count) ** 2)[:, None]
    noise_m, noise_m_s = size * _NOISE_M, size * _NOISE_M_S
    turn = axes(path[:, -1])
    known = np.where(rng.random(count) < _YOUNG, rng.integers(1, STEPS, count), STEPS)
    path = path + (noise_m[:, None] * _walk_errors(count, rng)) @ turn.swapaxes(1, 2)
    path[np.arange(STEPS) < STEPS - known[:, None]] = np.nan
    error_m_s = turn @ (noise_m_s * rng.standard_normal((count, 2)))[..., None]
    reported = rng.uniform(*_REPORTED, (2, count, 1))
    return TrackedPeople(
        ids=np.flatnonzero(is_here) + 1,
        path_m=path,
        covariance_m2=(turn * np.square(reported[0] * noise_m)[:, None]) @ turn.swapaxes(1, 2),
        velocity_m_s=walks.people[now, is_here, 2:] + error_m_s[..., 0],
        velocity_covariance_m2_s2=(turn * np.square(reported[1] * noise_m_s)[:, None]) @ turn.swapaxes(1, 2),
        robot_m_s=walks.robot[now, 3:],
    )


def _walk_errors(count: int, rng: np.random.Generator) -> Floats:
    """Draw errors (K, STEPS, 2) of paths with a deviation of 1, correlated over time."""
    errors = rng.standard_normal((count, STEPS, 2))
    for step in range(1, STEPS):
        errors[:, step] = _KEPT * errors[:, step - 1] + np.sqrt(1.0 - _KEPT**2) * errors[:, step]
    return errors
