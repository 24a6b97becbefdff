"""Play scenarios for compared trackers and models: equal frames for all, with ground truth."""

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
        frame: input of a tracker.
        truth: ground truth in the camera's image.
        observation: all sensor data of the robot.
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
        scenario: the scenario.
        seed: seed of the run.
        camera: camera of the ground truth.
        images: names of images to render before a frame is yielded. An image is rendered when it is first
            read, and that must not count as the tracker's time.
        every: interval between yielded images, starting with the first.

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
    """Split ascending numbers (N,) at steps larger than the gap; return the indices of each part."""
    return np.split(np.arange(len(numbers)), np.flatnonzero(np.diff(numbers) > gap) + 1)


@dataclass(slots=True)
class Stopwatch:
    """Measures processor times [ms]."""

    times_ms: list[float] = field(default_factory=list)

    def __call__(self, work: Callable[[], Result]) -> Result:
        """Call a function, and record its time."""
        start = time.process_time()
        result = work()
        self.times_ms.append(1000.0 * (time.process_time() - start))
        return result

    @property
    def median_ms(self) -> float:
        """Median time [ms]."""
        return float(np.median(self.times_ms))
