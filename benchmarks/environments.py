"""Environment steps per second, beside PyBullet's own way to images; and what resets leave behind."""

from __future__ import annotations

import argparse
import gc
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray

from benchmarks.memory import resident_mb
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.physics.bullet_io import projection_matrix, view_matrix
from peopleboy.sim.physics.physics import PHYSICS
from peopleboy.sim.shapes.bounds import FAR_M, NEAR_M
from peopleboy.sim.world import World

SCENARIO = "single_follow"
ACTION = (0.0, 0.13)
WARM_UP = 10
MANY = 16  # worlds in one process
RUN_HZ, QUICK_HZ = 240, 60  # physics as in a run, and at a quarter of that rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One way to observe, how many steps a second it should reach, and how many to time."""

    observation: str
    image_size: tuple[int, int]
    goal: int
    steps: int

    @property
    def name(self) -> str:
        """What it is called in the table."""
        width, height = self.image_size
        return f"{self.observation}, {width} x {height}" if self.observation == "pixels" else self.observation


CASES = (
    Case(observation="pixels", image_size=(320, 240), goal=60, steps=200),
    Case(observation="pixels", image_size=(80, 60), goal=600, steps=600),
    Case(observation="pixels", image_size=(64, 48), goal=600, steps=600),
    Case(observation="tracks", image_size=(320, 240), goal=100, steps=300),
    Case(observation="truth", image_size=(320, 240), goal=1500, steps=1000),
)


def step_rate(case: Case, physics_hz: int = RUN_HZ, clock: Callable[[], float] = time.process_time) -> float:
    """Return environment steps per second of CPU time, or by another clock, of one process."""
    env = PeopleBoyEnv(
        SCENARIO, observation=case.observation, image_size=case.image_size, physics_hz=physics_hz
    )
    env.reset(seed=0)
    for _ in range(WARM_UP):
        env.step(ACTION)
    start = clock()
    for _ in range(case.steps):
        *_, terminated, truncated, _ = env.step(ACTION)
        if terminated or truncated:
            env.reset()
    spent = clock() - start
    env.close()
    return case.steps / spent


def vector_rate(
    case: Case, physics: str, worlds: int = MANY, physics_hz: int = QUICK_HZ, *, threads: int = 1
) -> float:
    """Return steps per second of CPU time, of many worlds in one process; of time, with several threads."""
    clock = time.process_time if threads == 1 else time.perf_counter
    many = PeopleBoyVectorEnv(
        worlds,
        threads=threads,
        scenario=SCENARIO,
        observation=case.observation,
        image_size=case.image_size,
        physics=physics,
        physics_hz=physics_hz,
    )
    many.reset(seed=0)
    actions = np.tile(np.array(ACTION, np.float32), (worlds, 1))
    many.step(actions)
    rounds = max(case.steps // worlds, 1)
    start = clock()
    for _ in range(rounds):
        many.step(actions)
    spent = clock() - start
    many.close()
    return rounds * worlds / spent


def step_rates(case: Case, processes: int, physics_hz: int = RUN_HZ) -> float:
    """Return the same of several processes at once, added up."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        return sum(pool.map(step_rate, [case] * processes, [physics_hz] * processes))


def way_off_mm(seeds: int = 4, steps: int = 450) -> float:
    """Return how far [mm] the robot gets off its way at most, in drives by chance, if physics is quick."""
    ways = [[_drive(seed, steps, hz) for hz in (RUN_HZ, QUICK_HZ)] for seed in range(seeds)]
    shortest = [min(map(len, pair)) for pair in ways]
    return 1e3 * max(
        float(np.linalg.norm(run[:n] - quick[:n], axis=1).max())
        for (run, quick), n in zip(ways, shortest, strict=True)
    )


def _drive(seed: int, steps: int, physics_hz: int) -> NDArray[np.float64]:
    """Return where the robot was after each step, (N, 2) [m], until it touched something."""
    env = PeopleBoyEnv(SCENARIO, observation="truth", physics_hz=physics_hz)
    env.reset(seed=seed)
    rng = np.random.default_rng(seed)
    way = []
    for step in range(steps):
        if step % 15 == 0:
            action = rng.uniform((-0.1, -0.25), (0.35, 0.25))
        *_, terminated, truncated, info = env.step(action)
        way.append((info["truth"].robot.x, info["truth"].robot.y))
        if terminated or truncated:
            break
    env.close()
    return np.array(way)


def bullet_rate(image_size: tuple[int, int], steps: int = 20) -> float:
    """Return steps per second of the same world with two plain calls of getCameraImage a step."""
    config = load_scenario(SCENARIO).world(0)
    cameras = [
        replace(camera, width=image_size[0], height=image_size[1])
        for camera in (one.camera for one in config.robot.cameras.values())
    ]
    with World(config) as world:
        client, robot = world._physics._client, world._robot
        start = time.process_time()
        for _ in range(steps):
            world.step(0.0, 0.3)
            for camera in cameras:
                view = view_matrix(robot.world_from_robot() @ camera.robot_from_camera)
                client.getCameraImage(*image_size, view, projection_matrix(camera, NEAR_M, FAR_M))
        return steps / (time.process_time() - start)


def reset_growth(resets: int) -> float:
    """Return by how many bytes the memory of a process of its own grows with each reset."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(_reset_growth, resets).result()


def _reset_growth(resets: int) -> float:
    env = PeopleBoyEnv(SCENARIO, observation="truth")
    # What the C library keeps for later use grows with the first hundred.
    for seed in range(max(resets, 100)):
        env.reset(seed=seed)
    before = _held_mb()
    for seed in range(resets):
        env.reset(seed=seed)
    grown = _held_mb() - before
    env.close()
    return 1e6 * grown / resets


def _held_mb() -> float:
    gc.collect()
    return resident_mb()


def main() -> None:
    """Measure, and print a line each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.environments", description=__doc__)
    parser.add_argument("--resets", type=int, default=1000)
    options = parser.parse_args()
    for case in CASES:
        for rate in (RUN_HZ, QUICK_HZ):
            one, two = step_rate(case, rate), step_rates(case, 2, rate)
            name, goal = f"{case.name}, physics at {rate} Hz", f"goal {case.goal}"
            print(f"{name:34s} {one:7.0f} steps/s, {goal}; 2 processes {two:7.0f}", flush=True)
    for case in CASES:
        for physics in PHYSICS:
            rate = vector_rate(case, physics)
            print(f"{case.name}, {MANY} worlds, {physics}, {QUICK_HZ} Hz: {rate:.0f} steps/s", flush=True)
    print(f"the robot's way at {QUICK_HZ} Hz is off by at most {way_off_mm():.1f} mm in 30 s", flush=True)
    for size in ((320, 240), (80, 60)):
        print(f"getCameraImage twice, {size[0]} x {size[1]}: {bullet_rate(size):.0f} steps/s", flush=True)
    print(f"growth over {options.resets} resets: {reset_growth(options.resets):.0f} bytes a reset")


if __name__ == "__main__":
    main()
