"""Measure the cost of imperfect perception: one controller, three kinds of perception, the same worlds.

The controller turns towards the person in the image, and drives until the person has the wanted height there.
Perception is the tallest warm patch of the thermal image (`pixels`), the tracker (`tracks`), or the ground
truth (`truth`). The difference from `truth` is the cost of perception.

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

PHYSICS_HZ = 60  # a quarter of a run's; the path deviates by millimetres
KEEP_HEIGHT = 0.58
WARM = 40  # grey of the thermal image: 25.9 degC, warmer than most walls
UPRIGHT = 1.3  # least ratio of height to width
LEAST_HEIGHT = 0.15  # [image heights]
NEAREST_M = 0.7
FRONT_SONARS = slice(2, 6)


def see_warmth(observation: Observation) -> Person:
    """Return the tallest upright warm patch."""
    warm = (observation["thermal"][:, :, 0] > WARM).astype(np.uint8)
    height, width = warm.shape
    patches = cv2.connectedComponentsWithStats(warm)[2][1:]
    upright = [patch for patch in patches if patch[3] > max(UPRIGHT * patch[2], LEAST_HEIGHT * height)]
    if not upright:
        return None
    left, _, across, tall, _ = max(upright, key=lambda patch: int(patch[3]))
    return float((left + across / 2.0 - width / 2.0) / (width / 2.0)), float(tall / height)


def see_tallest(observation: Observation) -> Person:
    """Return the tallest track, of the tracker or of the ground truth."""
    number, x, height, *_ = observation["tracks"][:7].tolist()
    return (x, height) if number else None


def make_controller(see: Callable[[Observation], Person]) -> Controller:
    """Return a controller with a kind of perception."""

    def control(observation: Observation) -> tuple[float, float]:
        person = see(observation)
        if person is None:
            return 0.0, 0.2  # search
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
    "--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="Number of seeds, from 0 on."
)
@click.option("--eyes", default=",".join(EYES), show_default=True, help="Kinds of perception to compare.")
def main(scenario: str, seeds: int, eyes: str) -> None:
    """Run the controller with each kind of perception in the same worlds, and print metrics."""
    unknown = [name for name in eyes.split(",") if name not in EYES]
    if unknown:
        raise click.UsageError(f"--eyes: unknown {unknown[0]!r}; choose from {', '.join(EYES)}")
    runs = {}
    for name in eyes.split(","):
        env = PeopleBoyEnv(scenario, observation=name, physics_hz=PHYSICS_HZ)
        runs[name] = [play(env, make_controller(EYES[name]), seed) for seed in range(seeds)]
        env.close()
    print_figures(f"{scenario}, {seeds} seeds: mean [95 % interval]", runs, Console(width=110))


if __name__ == "__main__":
    main()
