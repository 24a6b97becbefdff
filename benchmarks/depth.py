"""What a depth camera costs: view, depth and colour, and noise alone, beside OpenCV's HOG in the same run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.cameras.depth import structured_light
from peopleboy.sim.random_streams import stream
from peopleboy.sim.world import World

SCENARIO = "crossing_4"


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthTimes:
    """Medians of processor time [ms] over the instants of one run.

    Attributes:
        view_ms: the exact depth of what is seen, and whose it is.
        images_ms: view, depth with noise, and colour.
        noise_ms: a depth image with noise and holes, the view being there.
        hog_ms: OpenCV's people detector with its defaults in the colour image, the peer: 307 200 pixels, too.
    """

    view_ms: float
    images_ms: float
    noise_ms: float
    hog_ms: float


def depth_times(instants: int = 30) -> DepthTimes:
    """Let the camera see the instants of a run, and time each part; on one thread."""
    cv2.setNumThreads(1)
    config = load_scenario(SCENARIO).mounting(("depth",)).world(seed=0)
    camera, rng = config.robot.cameras["depth"], stream(0, "benchmark")
    assert isinstance(camera, DepthConfig)
    detector = cv2.HOGDescriptor()
    detector.setSVMDetector(cv2.HOGDescriptor.getDefaultPeopleDetector())
    times = np.empty((instants + 3, 4))
    with World(config) as world:
        for row in times:
            world.step(0.0, 0.0)
            images = world.observe().images
            row[0] = _timed(partial(world._see, camera))
            row[1] = row[0] + _timed(partial(images.__getitem__, "depth"))
            row[2] = _timed(partial(structured_light, world._see(camera).view, camera, rng))
            row[3] = _timed(partial(detector.detectMultiScale, images["depth_colour"]))
    # The first instants compile the kernels.
    view, whole, noise, hog = np.median(1000.0 * times[3:], axis=0).tolist()
    return DepthTimes(view_ms=view, images_ms=whole, noise_ms=noise, hog_ms=hog)


def _timed(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


if __name__ == "__main__":
    told = depth_times()
    print(f"HOG: {told.hog_ms:.1f} ms")
    parts = (("view", told.view_ms), ("view, depth and colour", told.images_ms), ("noise", told.noise_ms))
    for what, cost in parts:
        print(f"{what}: {cost:.2f} ms, {cost / told.hog_ms:.3f} of HOG")
