"""What the RGB-D tracker costs an image, beside OpenCV's HOG slid over the same image."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import cv2
import numpy as np

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.trackers import make_tracker

SCENARIO = "crossing_3"
"""Three people before a standing robot."""

SHIFT_PX, SCALE = 4, 1.05  # of the source's slowest and best sliding window (SA table 4.3)
_WARM_UP = 20

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdTimes:
    """Medians of processor time [ms] over the instants of one run.

    Attributes:
        tracker_ms: the whole tracker, `rgbd`.
        tracks: mean number of people that it tells.
        hog_ms: OpenCV's people detector with its defaults.
        sliding_ms: the same with the source's shift and scale.
    """

    tracker_ms: float
    tracks: float
    hog_ms: float
    sliding_ms: float


def rgbd_times(instants: int = 60) -> RgbdTimes:
    """Let the tracker see the instants of a run, and time it beside the detectors; on one thread."""
    cv2.setNumThreads(1)
    scenario = load_scenario(SCENARIO).mounting((DEPTH,))
    calibrations = calibrations_of(scenario.world(0).robot.cameras)
    tracker, rows = make_tracker("rgbd", np.random.default_rng(0)), []
    detector = cv2.HOGDescriptor()
    detector.setSVMDetector(cv2.HOGDescriptor.getDefaultPeopleDetector())
    for k, (_, observation) in enumerate(blind_drive(scenario, 0)):
        if k >= _WARM_UP + instants:
            break
        images = {name: observation.images[name] for name in (DEPTH, DEPTH_COLOUR)}
        frame = Frame(images=images, time_s=observation.time_s, calibrations=calibrations)
        took, tracks = _timed(partial(tracker.update, frame))
        if k >= _WARM_UP:
            hog, _ = _timed(partial(detector.detectMultiScale, images[DEPTH_COLOUR]))
            slid = partial(
                detector.detectMultiScale,
                images[DEPTH_COLOUR],
                winStride=(SHIFT_PX, SHIFT_PX),
                scale=SCALE,
            )
            sliding = _timed(slid)[0] if k % 6 == 0 else np.nan
            rows.append((took, len(tracks), hog, sliding))
    times = np.array(rows)
    return RgbdTimes(
        tracker_ms=1000.0 * float(np.median(times[:, 0])),
        tracks=float(times[:, 1].mean()),
        hog_ms=1000.0 * float(np.median(times[:, 2])),
        sliding_ms=1000.0 * float(np.nanmedian(times[:, 3])),
    )


def _timed(work: Callable[[], Result]) -> tuple[float, Result]:
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


if __name__ == "__main__":
    told = rgbd_times()
    print(f"HOG: {told.hog_ms:.1f} ms; shift {SHIFT_PX} px, scale {SCALE}: {told.sliding_ms:.0f} ms")
    share, times = told.tracker_ms / told.hog_ms, told.sliding_ms / told.tracker_ms
    print(f"rgbd, {told.tracks:.1f} people: {told.tracker_ms:.1f} ms, {share:.2f} of HOG; slid: {times:.0f}x")
