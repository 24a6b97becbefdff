"""Train the follower's correction with an evolution strategy on the CPU.

Members of a generation run in the same worlds, one per scenario, and each generation in new ones. The score
is the gain in reward over the scripted follower. Equal options give equal weights.

    python -m examples.learning.train --out policy.npz
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click
import joblib
import numpy as np
from rich.console import Console

from examples.learning.evolution import evolve
from examples.learning.follower import SIZE, Weights
from examples.learning.worlds import LEARNED_ON, earn
from peopleboy.random_streams import stream

SPREAD = 0.25  # of the first generation's weights; a correction is MOST * tanh(weight * feature)


def judge(
    number: int, members: Sequence[Weights], *, first: int, scenarios: Sequence[str], workers: joblib.Parallel
) -> list[float]:
    """Return the mean gain in reward per episode of each member over the scripted follower."""
    scenes = [(scenario, first + number) for scenario in scenarios]
    tasks = [(who, *scene) for who in (None, *members) for scene in scenes]
    earned = np.array(workers(joblib.delayed(earn)(*task) for task in tasks)).reshape(-1, len(scenes))
    return [float(gain) for gain in (earned[1:] - earned[0]).mean(axis=1)]


@click.command()
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed for drawing members."
)
@click.option(
    "--generations", type=click.IntRange(min=1), default=8, show_default=True, help="Number of generations."
)
@click.option(
    "--members", type=click.IntRange(min=4), default=10, show_default=True, help="Members per generation."
)
@click.argument("scenarios", nargs=-1)
@click.option(
    "--first-seed",
    type=click.IntRange(min=0),
    default=100,
    show_default=True,
    help="First seed of the worlds.",
)
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), required=True, help="File of weights."
)
def main(
    seed: int,
    generations: int,
    members: int,
    scenarios: tuple[str, ...],
    first_seed: int,
    workers: int,
    out: Path,
) -> None:
    """Train, and save the weights after every generation, so that you may interrupt training."""
    out.parent.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    with joblib.Parallel(workers) as pool:
        score = partial(judge, first=first_seed, scenarios=scenarios or LEARNED_ON, workers=pool)
        rng = stream(seed, "examples.learning.members")
        for found in evolve(np.zeros(SIZE), SPREAD, score, rng, members=members, generations=generations):
            np.savez(out, weights=found.mean)
            Console().print(
                f"generation {found.number + 1} of {generations}: {np.mean(found.scores):+.2f} on average, "
                f"best {max(found.scores):+.2f}; spread {found.spread:.3f}; "
                f"{(time.monotonic() - start) / 60.0:.1f} min"
            )


if __name__ == "__main__":
    main()
