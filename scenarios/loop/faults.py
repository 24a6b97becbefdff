"""Simulate the sensor and tracker faults of a scenario, to test how controllers cope with them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import Stage, TrackerDown
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.observation import Observation, OnDemand
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import Tracker, explanation_of, knows_again

JUMP_EVERY_S = 1.0
JUMP = Pose2(x=0.7, y=-0.4, heading=math.radians(50.0))


class FaultySensors:
    """A world whose sensors fail as the scenario asks; the ground truth stays correct."""

    def __init__(self, world: Stage, faults: Sequence[FaultSpec], sonar_reach_m: float) -> None:
        self._world = world
        self._faults = faults
        self._reach_m = sonar_reach_m
        self._may_freeze = any(fault.kind == "camera_frozen" for fault in faults)
        self._last: Mapping[str, NDArray[Any]] = {}

    def observe(self) -> Observation:
        """Read every sensor once, and apply the active faults."""
        seen = self._world.observe()
        now = active(self._faults, seen.time_s)
        if self._may_freeze:
            seen = replace(seen, images=self._freeze(seen.images, is_frozen="camera_frozen" in now))
        if "camera_black" in now:
            images = seen.images
            seen = replace(seen, images=OnDemand(images, lambda name: _blackened(images[name])))
        if "sonar_maximum" in now:
            seen = replace(seen, sonar_m=np.full_like(seen.sonar_m, self._reach_m))
        if "odometry_jumps" in now:
            seen = replace(seen, odometry=_jumped(seen.odometry, now["odometry_jumps"]))
        return seen

    @property
    def cameras(self) -> Mapping[str, CameraConfig]:
        """Cameras of the robot, by name."""
        return self._world.cameras

    def truths(self) -> Mapping[str, Truth]:
        """Return the ground truth of this instant, by camera that takes an image."""
        return self._world.truths()

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot for one control step."""
        self._world.step(linear_m_s, angular_rad_s, is_emergency=is_emergency)

    def _freeze(self, images: Mapping[str, NDArray[Any]], *, is_frozen: bool) -> Mapping[str, NDArray[Any]]:
        """Return current or frozen images; reads all images, to have the last ones when a freeze begins."""
        old = self._last if is_frozen else {}
        now = {name: old[name] if name in old else images[name] for name in images}
        self._last = {**self._last, **now}
        return now


class FaultyTracker:
    """A tracker that raises an error at every image while the scenario's fault is active."""

    def __init__(self, tracker: Tracker, faults: Sequence[FaultSpec]) -> None:
        self._tracker = tracker
        self._faults = faults

    @property
    def cameras(self) -> tuple[str, ...]:
        """Cameras that the wrapped tracker needs."""
        return self._tracker.cameras

    @property
    def knows_again(self) -> bool:
        """Whether the wrapped tracker re-identifies people."""
        return knows_again(self._tracker)

    @property
    def explanation(self) -> object:
        """Explanation of the wrapped tracker."""
        return explanation_of(self._tracker)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Update the tracker with the next frame, or fail.

        Raises:
            TrackerDown: the fault is active.
        """
        if "tracker_raises" in active(self._faults, frame.time_s):
            raise TrackerDown("RuntimeError: as the scenario asks")
        return self._tracker.update(frame)


def active(faults: Sequence[FaultSpec], time_s: float) -> dict[str, float]:
    """Return the faults that are active at a time, with the time [s] since each began."""
    return {
        fault.kind: time_s - fault.from_s
        for fault in faults
        if 0.0 <= time_s - fault.from_s < (math.inf if fault.lasts_s is None else fault.lasts_s)
    }


def _blackened(image: NDArray[Any]) -> NDArray[Any]:
    """Blacken an 8-bit or 16-bit image; images with other values, such as temperatures, stay."""
    if image.dtype not in (np.uint8, np.uint16):
        return image
    is_grey = image.ndim == 2 and image.dtype == np.uint8
    return image & np.uint8(1) if is_grey else np.zeros_like(image)  # a dead grey camera still has noise


def _jumped(pose: Pose2, lasted_s: float) -> Pose2:
    """Return the odometry after a jump at the start of the fault and one every second since."""
    jumps = 1 + int(lasted_s / JUMP_EVERY_S)
    return Pose2(
        pose.x + jumps * JUMP.x,
        pose.y + jumps * JUMP.y,
        math.remainder(pose.heading + jumps * JUMP.heading, math.tau),
    )
