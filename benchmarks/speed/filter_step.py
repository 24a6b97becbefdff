"""One step of the person filter: predict, weigh, estimate, resample."""

from __future__ import annotations

import time
from dataclasses import replace
from statistics import median

import numpy as np

from peopleboy.tracker.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.contour.particle_filter import begin, step, view_frame
from peopleboy.tracker.contour.variants import CONTOUR
from peopleboy.tracker.frame import THERMAL, Frame, Odometry

SHAPE = (240, 320)


class FilterStep:
    """Follows a drawn person at 320x240 by so many samples; each call is a step.

    What is prepared once a frame for all filters is not in it.
    """

    def __init__(self, count: int) -> None:
        self._config = replace(CONTOUR, person=replace(CONTOUR.person, count=count))
        self._rng = np.random.default_rng(0)
        frame = Frame(images={THERMAL: _drawn_person()}, time_s=0.0, odometry=Odometry(turn_rad=0.01))
        model = ContourModel.build(SHAPE, self._config.contour)
        self._view = view_frame(frame, 1 / 15, model, self._config)
        self._belief = begin(self._view, self._config.detector, self._config, self._rng)
        self()  # which may compile

    def __call__(self) -> None:
        """Follow the person for one more frame."""
        self._belief = step(self._belief.core, self._view, self._config.person, self._config, self._rng)


def step_time_ms(count: int, steps: int = 300) -> float:
    """Return the median CPU time [ms] of one step with this many samples."""
    follow, times = FilterStep(count), []
    for _ in range(steps):
        start = time.process_time()
        follow()
        times.append(time.process_time() - start)
    return 1000.0 * median(times[10:])


def _drawn_person() -> np.ndarray:
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    body = ((u - 160) / 18) ** 2 + ((v - 130) / 42) ** 2 < 1
    head = ((u - 160) / 7) ** 2 + ((v - 78) / 10) ** 2 < 1
    return np.where(head, 210, np.where(body, 120, 10)).astype(np.uint8)
