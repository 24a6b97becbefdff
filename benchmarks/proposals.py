"""`python -m benchmarks.proposals`: what the detector of people costs an image, beside OpenCV's HOG."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import THERMAL, Odometry
from peopleboy.tracker.proposals.detector import PeopleDetector

WORLDS = (0, 1, 2, 3)
LASTS_S = 1.5  # of each world
_WARM_UP = 4
_TWICE = 2.0  # OpenCV's detector finds people of about 96 px, in this image of 48 px


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposalTimes:
    """Medians of processor time [ms] over images of random worlds.

    Attributes:
        known_ms: with odometry and the camera's mount.
        unknown_ms: without.
        hog_ms: OpenCV's people detector on the image of twice the size, strides of 8 px, sizes 7 % apart.
    """

    known_ms: float
    unknown_ms: float
    hog_ms: float


def proposal_times() -> ProposalTimes:
    """Let the detectors see the same images; on one thread."""
    cv2.setNumThreads(1)
    hog = cv2.HOGDescriptor()
    hog.setSVMDetector(cv2.HOGDescriptor.getDefaultPeopleDetector())
    rows = []
    for seed in WORLDS:
        known, unknown = PeopleDetector(), PeopleDetector()
        for k, (grey, time_s, mount) in enumerate(_images(seed)):
            larger = cv2.resize(grey, None, fx=_TWICE, fy=_TWICE)
            row = (
                _timed(partial(known.update, grey, time_s, Odometry(), mount)),
                _timed(partial(unknown.update, grey, time_s)),
                _timed(partial(hog.detectMultiScale, larger, winStride=(8, 8), padding=(16, 16), scale=1.07)),
            )
            if k >= _WARM_UP:
                rows.append(row)
    return ProposalTimes(**dict(zip(ProposalTimes.__slots__, np.median(rows, axis=0).tolist(), strict=True)))


def _images(seed: int) -> list[tuple[NDArray[np.uint8], float, Mount]]:
    scenario = random_scenario(seed, LASTS_S)
    calibration = calibrations_of(scenario.world(seed).robot.cameras).get(THERMAL)
    return [
        (seen.images[THERMAL].copy(), seen.time_s, mount_of(calibration, len(seen.images[THERMAL])))
        for _, seen in blind_drive(scenario, seed)
    ]


def _timed(call: Callable[[], object]) -> float:
    begin = time.process_time()
    call()
    return 1000.0 * (time.process_time() - begin)


if __name__ == "__main__":
    told = proposal_times()
    print(
        f"mount known {told.known_ms:.1f} ms, unknown {told.unknown_ms:.1f} ms; HOG {told.hog_ms:.1f} ms, "
        f"{told.hog_ms / told.known_ms:.0f} and {told.hog_ms / told.unknown_ms:.0f} times as long"
    )
