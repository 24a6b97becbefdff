"""What perception costs a controller: one law, three pairs of eyes, the same worlds.

The law turns to where the person stands in the image, and drives until the person is as tall there as wanted.
Its eyes are the thermal image itself (its tallest warm patch), the tracker, or the truth. What
the rows below `truth` lose is the price of seeing.

    python -m examples.price_of_perception --seeds 20
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click
import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from examples.show import Controller, play, print_figures
from peopleboy.scenarios.environments.environment import PeopleBoyEnv

Observation = dict[str, NDArray[Any]]
Person = tuple[float, float] | None  # column [half image widths] and height [image heights]

PHYSICS_HZ = 60  # a quarter of a run's: the way is off by millimetres
KEEP_HEIGHT = 0.58
WARM = 40  # grey of the thermal image: 25.9 degC, warmer than most walls
UPRIGHT = 1.3  # height of a patch in its widths
LEAST_HEIGHT = 0.15  # [image heights]
NEAREST_M = 0.7
FRONT_SONARS = slice(2, 6)


def see_warmth(observation: Observation) -> Person:
    """Take the tallest patch of warmth that stands upright for a person."""
    warm = (observation["thermal"][:, :, 0] > WARM).astype(np.uint8)
    height, width = warm.shape
    patches = cv2.connectedComponentsWithStats(warm)[2][1:]
    upright = [patch for patch in patches if patch[3] > max(UPRIGHT * patch[2], LEAST_HEIGHT * height)]
    if not upright:
        return None
    left, _, across, tall, _ = max(upright, key=lambda patch: int(patch[3]))
    return float((left + across / 2.0 - width / 2.0) / (width / 2.0)), float(tall / height)


def see_tallest(observation: Observation) -> Person:
    """Take the tallest track, of the tracker or of the truth."""
    number, x, height, *_ = observation["tracks"][:7].tolist()
    return (x, height) if number else None


def make_controller(see: Callable[[Observation], Person]) -> Controller:
    """Give the law the eyes."""

    def control(observation: Observation) -> tuple[float, float]:
        person = see(observation)
        if person is None:
            return 0.0, 0.2  # look round
        x, height = person
        forward = float(np.clip(2.0 * (KEEP_HEIGHT - height), -0.3, 1.0))
        if observation["sonar"][FRONT_SONARS].min() < NEAREST_M:
            forward = min(forward, 0.0)
        return forward, float(np.clip(-0.4 * x, -1.0, 1.0))

    return control


EYES = {"truth": see_tallest, "tracks": see_tallest, "pixels": see_warmth}


@click.command()
@click.argument("scenario", default="single_follow")
@click.option(
    "--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="How many, from 0 on."
)
@click.option("--eyes", default=",".join(EYES), show_default=True, help="Which to compare.")
def main(scenario: str, seeds: int, eyes: str) -> None:
    """Drive by each pair of eyes in the same worlds, and print how it went."""
    unknown = [name for name in eyes.split(",") if name not in EYES]
    if unknown:
        raise click.UsageError(f"--eyes {unknown[0]}: there is no such; choose from {', '.join(EYES)}")
    runs = {}
    for name in eyes.split(","):
        env = PeopleBoyEnv(scenario, observation=name, physics_hz=PHYSICS_HZ)
        runs[name] = [play(env, make_controller(EYES[name]), seed) for seed in range(seeds)]
        env.close()
    print_figures(f"{scenario}, {seeds} seeds: mean [95 % interval]", runs, Console(width=110))


if __name__ == "__main__":
    main()
