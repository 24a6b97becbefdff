"""Environment steps per second of one and of many worlds, compared with PyBullet.

`python -m benchmarks.speed.environments` times environments by observation; `--many` times many worlds in one
process, by number of worlds and people.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import click
import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks import call
from benchmarks.compare import Turns
from benchmarks.speed.memory import reset_growth
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.physics.bullet_io import projection_matrix, view_matrix
from peopleboy.sim.physics.physics_engine import PHYSICS
from peopleboy.sim.shapes.bounds import FAR_M, NEAR_M
from peopleboy.sim.world import SimulatedWorld

SCENARIO: Final = "single_follow"
ACTION: Final = (0.0, 0.13)
WARM_UP: Final = 10
RUN_HZ, QUICK_HZ = 240, 60  # physics as in a run, and at a quarter of that rate
MANY: Final = 16  # worlds in one process
WORLDS: Final = (1, 4, 16, 64)
THREADS: Final = 2
PEOPLE: Final = (1, 15, 30, 60)
_ROUNDS: Final = 3

Clock = Callable[[], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A kind of observation, its goal [steps/s], and the number of steps to time."""

    observation: str
    image_size: tuple[int, int]
    goal: int
    steps: int

    @property
    def name(self) -> str:
        """Name in the table."""
        width, height = self.image_size
        return f"{self.observation}, {width} x {height}" if self.observation == "pixels" else self.observation


PIXELS: Final = Case(observation="pixels", image_size=(80, 60), goal=600, steps=600)
TRUTH: Final = Case(observation="truth", image_size=(320, 240), goal=1500, steps=1000)
CASES: Final = (
    Case(observation="pixels", image_size=(320, 240), goal=60, steps=200),
    PIXELS,
    Case(observation="pixels", image_size=(64, 48), goal=600, steps=600),
    Case(observation="tracks", image_size=(320, 240), goal=100, steps=300),
    TRUTH,
)


def steps_per_s(
    step: Callable[[int], object], steps: int, *, warm_up: int, clock: Clock = time.process_time
) -> float:
    """Return steps per second of CPU time, or of another clock, after warm-up."""
    for number in range(warm_up):
        step(number)
    start = clock()
    for number in range(steps):
        step(number)
    return steps / (clock() - start)


def step_rate(case: Case, physics_hz: int = RUN_HZ, clock: Clock = time.process_time) -> float:
    """Return environment steps per second of one process."""
    env = PeopleBoyEnv(
        SCENARIO, observation=case.observation, image_size=case.image_size, physics_hz=physics_hz
    )

    def step(number: int) -> None:  # noqa: ARG001
        *_, terminated, truncated, _ = env.step(ACTION)
        if terminated or truncated:
            env.reset()

    with closing(env):
        env.reset(seed=0)
        return steps_per_s(step, case.steps, warm_up=WARM_UP, clock=clock)


def vector_rate(
    case: Case, physics: str, worlds: int = MANY, physics_hz: int = QUICK_HZ, *, threads: int = 1
) -> float:
    """Return steps per second of many worlds in one process: CPU time, or real time with threads."""
    many = PeopleBoyVectorEnv(
        worlds,
        threads=threads,
        scenario=SCENARIO,
        observation=case.observation,
        image_size=case.image_size,
        physics=physics,
        physics_hz=physics_hz,
    )
    return worlds * _vector_steps_per_s(many, max(case.steps // worlds, 1), _clock(threads))


def _vector_steps_per_s(many: PeopleBoyVectorEnv, rounds: int, clock: Clock = time.process_time) -> float:
    actions = np.tile(np.array(ACTION, np.float32), (many.num_envs, 1))
    with closing(many):
        many.reset(seed=0)
        return steps_per_s(lambda _: many.step(actions), rounds, warm_up=1, clock=clock)


def _clock(threads: int) -> Clock:
    return time.process_time if threads == 1 else time.perf_counter


def step_rates(case: Case, processes: int, physics_hz: int = RUN_HZ) -> float:
    """Return the total rate of several processes at the same time."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        return sum(pool.map(step_rate, [case] * processes, [physics_hz] * processes))


def way_off_mm(seeds: int = 4, steps: int = 450) -> float:
    """Return the largest deviation of the path [mm] in random drives at the lower physics rate."""
    paths = [[_drive(seed, steps, hz) for hz in (RUN_HZ, QUICK_HZ)] for seed in range(seeds)]
    shortest = [min(map(len, pair)) for pair in paths]
    return 1e3 * max(
        float(np.linalg.norm(run[:n] - quick[:n], axis=1).max())
        for (run, quick), n in zip(paths, shortest, strict=True)
    )


def _drive(seed: int, steps: int, physics_hz: int) -> NDArray[np.float64]:
    """Return the robot's position after each step, (N, 2) [m], until it touches something."""
    rng, path = np.random.default_rng(seed), []
    with closing(PeopleBoyEnv(SCENARIO, observation="truth", physics_hz=physics_hz)) as env:
        env.reset(seed=seed)
        for step in range(steps):
            if step % 15 == 0:
                action = rng.uniform((-0.1, -0.25), (0.35, 0.25))
            *_, terminated, truncated, info = env.step(action)
            path.append((info["truth"].robot.x, info["truth"].robot.y))
            if terminated or truncated:
                break
    return np.array(path)


def bullet_rate(image_size: tuple[int, int], steps: int = 20) -> float:
    """Return steps per second of the same world with two plain calls of getCameraImage per step."""
    config = load_scenario(SCENARIO).world(0)
    cameras = [
        replace(camera, width=image_size[0], height=image_size[1])
        for camera in (one.camera for one in config.robot.cameras.values())
    ]
    with SimulatedWorld(config) as world:
        client, robot = world.physics._client, world.robot

        def step(number: int) -> None:  # noqa: ARG001
            world.step(0.0, 0.3)
            for camera in cameras:
                view = view_matrix(robot.world_from_robot() @ camera.robot_from_camera)
                client.getCameraImage(*image_size, view, projection_matrix(camera, NEAR_M, FAR_M))

        return steps_per_s(step, steps, warm_up=0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ManyRate:
    """Environment steps per second of CPU time, total of all worlds, and ratio to one PyBullet world.

    With several threads, both are per second of real time.
    """

    steps_s: float
    ratio: float


def many_rates(case: Case, worlds: Sequence[int] = WORLDS, threads: int = 1) -> dict[int, ManyRate]:
    """Measure kinematic worlds and one PyBullet world in turn, several times; return medians by worlds."""
    few, found = replace(case, steps=case.steps // _ROUNDS), {}
    for count in worlds:
        turns = Turns()
        for _ in range(_ROUNDS):
            many = vector_rate(case, "kinematic", count, threads=threads)
            turns.add({"many": many, "one": step_rate(few, clock=_clock(threads))})
        found[count] = ManyRate(steps_s=turns.median("many"), ratio=turns.ratio("many", "one"))
    return found


def whole_episodes_rate(worlds: int = MANY) -> float:
    """Return steps per second of CPU time of `truth`, over whole episodes including resets."""
    many = _kinematic_truth(worlds, SCENARIO)
    actions = np.tile(np.array(ACTION, np.float32), (worlds, 1))
    with closing(many):
        many.reset(seed=0)
        start, rounds, is_over = time.process_time(), 0, False
        while not is_over:
            _, _, ends, cuts, _ = many.step(actions)
            is_over, rounds = bool((ends | cuts).any()), rounds + 1
        many.step(actions)
        return (rounds + 1) * worlds / (time.process_time() - start)


def people_step_ms(people: int, *, yields: bool, worlds: int = 4, rounds: int = 40) -> float:
    """Return the CPU time [ms] of a step of a `truth` world by number of people, scripted or giving way."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "hall.yaml"
        path.write_text(yaml.safe_dump(_hall(people, yields=yields)))
        many = _kinematic_truth(worlds, path)
    return 1e3 / _vector_steps_per_s(many, rounds) / worlds


def _kinematic_truth(worlds: int, scenario: str | Path) -> PeopleBoyVectorEnv:
    return PeopleBoyVectorEnv(
        worlds, scenario=scenario, observation="truth", physics="kinematic", physics_hz=QUICK_HZ
    )


def _hall(people: int, *, yields: bool) -> dict[str, Any]:
    """Return a scenario of a hall in which people walk to and fro in front of the robot, in rows of ten."""
    rows = [divmod(number, 10) for number in range(people)]
    return {
        "name": "hall",
        "description": "People walk to and fro in front of the robot.",
        "duration_s": 30.0,
        "place": {"kind": "room", "length_m": 20.0, "width_m": 14.0},
        "people": [
            {
                "name": f"p{number}",
                "yields": yields,
                "path": [{"at_m": [4.0 + 2.5 * row, -6.0 + 1.2 * column]}, {"at_m": [5.5 + 2.5 * row, 5.5]}],
            }
            for number, (row, column) in enumerate(rows)
        ],
        "robot": {"at_m": [1.0, 0.0]},
    }


def _one_world_lines(resets: int) -> Iterator[str]:
    for case in CASES:
        for rate in (RUN_HZ, QUICK_HZ):
            one, two = step_rate(case, rate), step_rates(case, 2, rate)
            name, goal = f"{case.name}, physics at {rate} Hz", f"goal {case.goal}"
            yield f"{name:34s} {one:7.0f} steps/s, {goal}; 2 processes {two:7.0f}"
    for case in CASES:
        for physics in PHYSICS:
            rate = vector_rate(case, physics)
            yield f"{case.name}, {MANY} worlds, {physics}, {QUICK_HZ} Hz: {rate:.0f} steps/s"
    yield f"the robot's path at {QUICK_HZ} Hz deviates by at most {way_off_mm():.1f} mm in 30 s"
    for size in ((320, 240), (80, 60)):
        yield f"getCameraImage twice, {size[0]} x {size[1]}: {bullet_rate(size):.0f} steps/s"
    yield f"growth over {resets} resets: {reset_growth(resets):.0f} bytes per reset"


def _many_worlds_lines() -> Iterator[str]:
    beside = "times one PyBullet world"
    for case in (TRUTH, PIXELS):
        for worlds, rate in many_rates(case).items():
            yield f"{case.name}, {worlds} worlds: {rate.steps_s:.0f} steps/s, {rate.ratio:.1f} {beside}"
    for worlds, rate in many_rates(PIXELS, (MANY, WORLDS[-1]), THREADS).items():
        name = f"{PIXELS.name}, {worlds} worlds, {THREADS} threads"
        yield f"{name}: {rate.steps_s:.0f} steps/s of real time, {rate.ratio:.1f} {beside}"
    yield f"truth, {MANY} worlds, whole episodes: {whole_episodes_rate():.0f} steps/s"
    for people in PEOPLE:
        scripted, yielding = (people_step_ms(people, yields=yields) for yields in (False, True))
        yield f"truth, {people} people: {scripted:.2f} ms per step; {yielding:.2f} ms if they give way"


@click.command()
@click.option("--many", is_flag=True, help="Time many worlds in one process instead.")
@click.option("--resets", default=1000, show_default=True, help="Resets for measuring memory growth.")
def main(resets: int, *, many: bool) -> None:
    """Measure, and print one line per case."""
    for line in _many_worlds_lines() if many else _one_world_lines(resets):
        click.echo(line)


if __name__ == "__main__":
    call(main, "benchmarks.speed.environments")
