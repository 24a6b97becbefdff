"""How many steps a second come of many worlds in one process, as worlds and people become more."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
import yaml

from benchmarks.environments import ACTION, CASES, MANY, QUICK_HZ, SCENARIO, Case, step_rate, vector_rate
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv

WORLDS: Final = (1, 4, 16, 64)
THREADS: Final = 2
PEOPLE: Final = (1, 15, 30, 60)
_ROUNDS: Final = 3
_BY_NAME: Final = {case.name: case for case in CASES}
TRUTH: Final = _BY_NAME["truth"]
PIXELS: Final = _BY_NAME["pixels, 80 x 60"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ManyRate:
    """Environment steps a second of CPU time, of all worlds together, and that against one PyBullet world.

    With several threads, seconds are those of the clock, for both.
    """

    steps_s: float
    ratio: float


def many_rates(case: Case, worlds: Sequence[int] = WORLDS, threads: int = 1) -> dict[int, ManyRate]:
    """Measure kinematic worlds and one PyBullet world in turn, some times, and give the medians by worlds."""
    return {count: _beside_one(case, count, threads) for count in worlds}


def _beside_one(case: Case, worlds: int, threads: int) -> ManyRate:
    few = replace(case, steps=case.steps // _ROUNDS)
    clock = time.process_time if threads == 1 else time.perf_counter
    pairs = [
        (vector_rate(case, "kinematic", worlds, threads=threads), step_rate(few, clock=clock))
        for _ in range(_ROUNDS)
    ]
    return ManyRate(
        steps_s=median(many for many, _ in pairs), ratio=median(many / one for many, one in pairs)
    )


def whole_episodes_rate(worlds: int = MANY) -> float:
    """Return steps per second of CPU time of `truth`, over whole episodes with all that begins them."""
    many = PeopleBoyVectorEnv(
        worlds, scenario=SCENARIO, observation="truth", physics="kinematic", physics_hz=QUICK_HZ
    )
    many.reset(seed=0)
    actions = np.tile(np.array(ACTION, np.float32), (worlds, 1))
    start, rounds, is_over = time.process_time(), 0, False
    while not is_over:
        _, _, ends, cuts, _ = many.step(actions)
        is_over, rounds = bool((ends | cuts).any()), rounds + 1
    many.step(actions)
    spent = time.process_time() - start
    many.close()
    return (rounds + 1) * worlds / spent


def people_step_ms(people: int, *, yields: bool, worlds: int = 4, rounds: int = 40) -> float:
    """Return CPU time [ms] of a step of one world of `truth` with so many people, scripted or making way."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "hall.yaml"
        path.write_text(yaml.safe_dump(_hall(people, yields=yields)))
        many = PeopleBoyVectorEnv(
            worlds, scenario=path, observation="truth", physics="kinematic", physics_hz=QUICK_HZ
        )
    many.reset(seed=0)
    actions = np.tile(np.array(ACTION, np.float32), (worlds, 1))
    many.step(actions)
    start = time.process_time()
    for _ in range(rounds):
        many.step(actions)
    spent = time.process_time() - start
    many.close()
    return 1e3 * spent / rounds / worlds


def _hall(people: int, *, yields: bool) -> dict[str, Any]:
    """A hall in which people walk to and fro before the robot, in rows of ten."""
    rows = [divmod(number, 10) for number in range(people)]
    return {
        "name": "hall",
        "description": "People walk to and fro before the robot.",
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


def main() -> None:
    """Measure, and print a line each."""
    for case in (TRUTH, PIXELS):
        for worlds, rate in many_rates(case).items():
            print(
                f"{case.name}, {worlds} worlds: {rate.steps_s:.0f} steps/s, "
                f"{rate.ratio:.1f} times one PyBullet world",
                flush=True,
            )
    for worlds, rate in many_rates(PIXELS, (MANY, WORLDS[-1]), THREADS).items():
        print(
            f"{PIXELS.name}, {worlds} worlds, {THREADS} threads: {rate.steps_s:.0f} steps/s by the clock, "
            f"{rate.ratio:.1f} times one PyBullet world",
            flush=True,
        )
    print(f"truth, {MANY} worlds, whole episodes: {whole_episodes_rate():.0f} steps/s", flush=True)
    for people in PEOPLE:
        scripted, yielding = (people_step_ms(people, yields=yields) for yields in (False, True))
        print(
            f"truth, {people} people: {scripted:.2f} ms a step; {yielding:.2f} if they make way", flush=True
        )


if __name__ == "__main__":
    main()
