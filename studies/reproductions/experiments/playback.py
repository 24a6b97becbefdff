"""Scenarios played for trackers and models that are compared: the same frames for each, and the truth."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.observation import Observation
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.frame import Frame

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """One instant of a played scenario.

    Attributes:
        number: of the camera's image, from 1.
        frame: what a tracker is given.
        truth: in the camera's image.
        observation: all that the robot sensed.
    """

    number: int
    frame: Frame
    truth: Truth
    observation: Observation


def play(
    scenario: Scenario, seed: int, camera: str, images: Sequence[str] = (), every: int = 1
) -> Iterator[Moment]:
    """Play a scenario whose robot drives without a tracker, and yield the instants with a camera's image.

    Args:
        scenario: what is played.
        seed: of the run.
        camera: in whose image the truth is.
        images: names of those that are rendered before a frame is handed on. An image is rendered when it is
            first read, and that must not count as the tracker's time.
        every: interval between the images that are handed on, from the first on.

    Raises:
        BadInput: the robot needs a tracker to drive.
    """
    calibrations = calibrations_of(scenario.world(seed).robot.cameras)
    before: Pose2 | None = None
    number = 0
    for world, observation in blind_drive(scenario, seed):
        if camera not in observation.images:
            continue
        number += 1
        if (number - 1) % every == 0:
            frame = Frame.from_observation(observation, before, calibrations)
            for name in images:
                frame.images.get(name)
            yield Moment(number, frame, world.truth(camera), observation)
        before = observation.odometry


def unbroken(numbers: NDArray[Any] | Sequence[int], gap: int = 1) -> list[NDArray[np.int64]]:
    """Split ascending numbers (N,) where the step is larger than the gap; return the places in each part."""
    return np.split(np.arange(len(numbers)), np.flatnonzero(np.diff(numbers) > gap) + 1)


@dataclass(slots=True)
class Stopwatch:
    """Processor time [ms] of the work that it is given."""

    times_ms: list[float] = field(default_factory=list)

    def __call__(self, work: Callable[[], Result]) -> Result:
        """Do some work, and keep its time."""
        start = time.process_time()
        result = work()
        self.times_ms.append(1000.0 * (time.process_time() - start))
        return result

    @property
    def median_ms(self) -> float:
        """The median [ms]."""
        return float(np.median(self.times_ms))
