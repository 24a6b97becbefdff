"""What a panorama costs: its view and truth, beside those of the thermal camera in the same run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import World

SCENARIO = "crossing_4"
CAMERAS = ("thermal", "panorama")


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaTimes:
    """Medians of processor time [ms] over the instants of one run, for each of `CAMERAS`.

    Attributes:
        truth_ms: view and truth.
        whole_ms: view, truth and image.
    """

    truth_ms: tuple[float, float]
    whole_ms: tuple[float, float]


def panorama_times(instants: int = 60) -> PanoramaTimes:
    """Let both cameras see the same instants in turn, and time each."""
    config = load_scenario(SCENARIO).mounting(("panorama",)).world(seed=0)
    times = np.empty((instants + 3, len(CAMERAS), 2))
    with World(config) as world:
        for row in times:
            world.step(0.0, 0.0)
            images = world.observe().images
            for found, name in zip(row, CAMERAS, strict=True):
                found[0] = _timed(partial(world.truth, name))
                found[1] = found[0] + _timed(partial(images.__getitem__, name))
    # The first instants compile the kernels.
    truth, whole = np.median(1000.0 * times[3:], axis=0).T
    return PanoramaTimes(truth_ms=tuple(truth.tolist()), whole_ms=tuple(whole.tolist()))


def _timed(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


if __name__ == "__main__":
    told = panorama_times()
    for what, (thermal, panorama) in (("view and truth", told.truth_ms), ("with image", told.whole_ms)):
        print(f"{what}: thermal {thermal:.2f} ms, panorama {panorama:.2f} ms, {panorama / thermal:.2f} times")
