"""Simulate the sensor and tracker faults of a scenario, to test how controllers cope with them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import Stage, TrackerDown
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.observation import Observation, OnDemand, Senses
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.frame import Frame, Odometry, joined
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import Tracker, explanation_of, knows_again

Current = tuple[FaultSpec, float]  # a fault that is active, and the time [s] since it began
_REPEATING = ("camera_frozen", "camera_shutter", "frames_dropped", "frames_late", "frames_duplicated")
_SPOILING = (
    "camera_lost", "camera_black", "camera_saturated", "dead_rows", "noise_bursts", "calibration_off",
)  # fmt: skip
JUMP_EVERY_S = 1.0
JUMP = Pose2(x=0.7, y=-0.4, heading=math.radians(50.0))


_SHUTTER_S, _SHUTTER_EVERY_S = 0.4, 2.0
_HISTORY_S = 2.1  # images are kept for so long; a delay is at most 2 s

Image = NDArray[Any]
Sensed = TypeVar("Sensed", bound=Senses)


class SensorFaults:
    """Applies the sensor faults of a scenario to readings, instant by instant.

    Args:
        faults: faults of the scenario.
        sonar_reach_m: [m] reading of a sonar without an echo.
    """

    def __init__(self, faults: Sequence[FaultSpec], sonar_reach_m: float) -> None:
        self._faults = faults
        self._reach_m = sonar_reach_m
        self._rng = np.random.default_rng(0)
        self._needs_images = any(fault.kind in _REPEATING for fault in faults)
        self._may_be_late = any(fault.kind == "frames_late" for fault in faults)
        self._moves = any(fault.kind in ("wheel_slip", "odometry_drift") for fault in faults)
        self._shown: dict[str, Image] = {}
        self._history: list[tuple[float, dict[str, Image]]] = []
        self._sonar_m: NDArray[np.float64] | None = None
        self._true: Pose2 | None = None
        self._odometry = Pose2()

    def apply(self, seen: Sensed) -> Sensed:
        """Return the readings with the active faults."""
        if not self._faults:
            return seen
        now = _current(self._faults, seen.time_s)
        if isinstance(seen, Observation):
            seen = replace(seen, images=self._faulty_images(seen, now))
        for fault, _ in now:
            if fault.kind == "sonar_maximum":
                seen = replace(seen, sonar_m=_overwritten(seen.sonar_m, fault, self._reach_m))
            elif fault.kind == "sonar_stuck" and self._sonar_m is not None:
                seen = replace(seen, sonar_m=_overwritten(seen.sonar_m, fault, self._sonar_m))
        self._sonar_m = seen.sonar_m
        if self._moves:
            seen = self._with_drift(seen, now)
        for fault, since_s in now:
            if fault.kind == "odometry_jumps":
                seen = replace(seen, odometry=_jumped(seen.odometry, since_s))
        return seen

    def slip(self, time_s: float) -> float:
        """Return the share of the commanded motion that the robot makes."""
        return _product_of(_current(self._faults, time_s), "wheel_slip", lambda lost: 1.0 - lost)

    def _faulty_images(self, seen: Observation, now: Sequence[Current]) -> Mapping[str, Image]:
        """Return the images with the faults; those that later images depend on are rendered at once."""
        found = seen.images
        if self._needs_images:
            taken = {name: found[name] for name in found}
            self._history = [old for old in self._history if seen.time_s - old[0] < _HISTORY_S]
            if self._may_be_late:
                self._history.append((seen.time_s, taken))
            shown = {name: self._repeated(name, image, seen.time_s, now) for name, image in taken.items()}
            self._shown |= shown
            found = shown
        spoilt = [(fault, self._rng.integers(2**31)) for fault, _ in now if fault.kind in _SPOILING]
        if not spoilt:
            return found

        def spoil(name: str) -> Image:
            image = found[name]
            for fault, seed in spoilt:
                if _is_hit(fault, name):
                    image = _spoilt(image, fault, int(seed))
            return image

        return OnDemand(found, spoil)

    def _repeated(self, name: str, image: Image, time_s: float, now: Sequence[Current]) -> Image:
        """Return a camera's image, or an earlier one."""
        for fault, since_s in now:
            if not _is_hit(fault, name) or fault.kind not in _REPEATING:
                continue
            if fault.kind == "frames_late":
                late = [images[name] for then_s, images in self._history
                        if name in images and then_s <= time_s - fault.chosen_strength + 1e-6]  # fmt: skip
                image = late[-1] if late else self._shown.get(name, image)
            elif self._is_repeating(fault, since_s):
                image = self._shown.get(name, image)
        return image

    def _is_repeating(self, fault: FaultSpec, since_s: float) -> bool:
        if fault.kind == "camera_shutter":
            return since_s % _SHUTTER_EVERY_S < _SHUTTER_S
        if fault.kind == "frames_dropped":
            # All layers of a camera's image are dropped together.
            frame = round(since_s * 1e3)
            return bool(np.random.default_rng(frame).random() < fault.chosen_strength)
        if fault.kind == "frames_duplicated":
            return round(since_s * CONTROL_HZ) % (1 + int(fault.chosen_strength)) != 0
        return True

    def _with_drift(self, seen: Sensed, now: Sequence[Current]) -> Sensed:
        """Integrate the motion that the wheels report; they turn more than the robot moves if they slip."""
        if self._true is None:
            self._true = self._odometry = seen.odometry
        motion = seen.odometry.relative_to(self._true)
        slip = 1.0 / _product_of(now, "wheel_slip", lambda lost: 1.0 - lost)
        longer = slip * _product_of(now, "odometry_drift", lambda excess: 1.0 + excess)
        moved = Pose2(motion.x * longer, motion.y * longer, motion.heading * slip)
        self._true, self._odometry = seen.odometry, self._odometry.compose(moved)
        left, right = seen.wheel_speeds_m_s
        return replace(seen, odometry=self._odometry, wheel_speeds_m_s=(left * slip, right * slip))


class FaultySensors:
    """A world whose sensors and wheels fail as the scenario asks; the ground truth stays correct."""

    def __init__(self, world: Stage, faults: Sequence[FaultSpec], sonar_reach_m: float) -> None:
        self._world = world
        self._faults = SensorFaults(faults, sonar_reach_m)
        self._time_s = 0.0

    def observe(self) -> Observation:
        """Read every sensor once, and apply the active faults."""
        seen = self._faults.apply(self._world.observe())
        self._time_s = seen.time_s
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
        share = self._faults.slip(self._time_s)
        self._world.step(share * linear_m_s, share * angular_rad_s, is_emergency=is_emergency)


class FaultyTracker:
    """A tracker that raises an error at every image while the scenario's fault is active."""

    def __init__(self, tracker: Tracker, faults: Sequence[FaultSpec]) -> None:
        self._tracker = tracker
        self._faults = faults
        self._skipped = 0
        self._way: Odometry | None = Odometry()
        self._tracks: tuple[Track, ...] = ()

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
        now = {fault.kind: fault for fault, _ in _current(self._faults, frame.time_s)}
        if "tracker_raises" in now:
            raise TrackerDown("RuntimeError: as the scenario asks")
        overload = now.get("tracker_overload")
        if overload is None and self._skipped == 0:
            return self._tracker.update(frame)
        self._way = joined(self._way, frame.odometry)
        if overload is not None and self._skipped < overload.chosen_strength:
            self._skipped += 1
            return self._tracks
        frame, self._way, self._skipped = replace(frame, odometry=self._way), Odometry(), 0
        self._tracks = self._tracker.update(frame)
        return self._tracks


def active(faults: Sequence[FaultSpec], time_s: float) -> dict[str, float]:
    """Return the kinds of faults that are active at a time, with the time [s] since each began."""
    return {fault.kind: since_s for fault, since_s in _current(faults, time_s)}


def _current(faults: Sequence[FaultSpec], time_s: float) -> list[Current]:
    return [
        (fault, time_s - fault.from_s)
        for fault in faults
        if 0.0 <= time_s - fault.from_s < (math.inf if fault.lasts_s is None else fault.lasts_s)
    ]


def _is_hit(fault: FaultSpec, image: str) -> bool:
    """Return whether a fault concerns an image, such as `thermal` or `thermal_c`."""
    return fault.camera is None or image == fault.camera or image.startswith(f"{fault.camera}_")


def _product_of(now: Sequence[Current], kind: str, factor: Callable[[float], float]) -> float:
    return math.prod(factor(fault.chosen_strength) for fault, _ in now if fault.kind == kind)


def _overwritten(
    ranges: NDArray[np.float64], fault: FaultSpec, value: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return ranges in which the fault's sonar, or all of them, have another value."""
    is_hit = np.ones(len(ranges), bool) if fault.sonar is None else np.arange(len(ranges)) == fault.sonar
    return np.where(is_hit, value, ranges)


def _spoilt(image: Image, fault: FaultSpec, seed: int) -> Image:
    """Spoil an 8-bit or 16-bit image; images with other values, such as temperatures, stay."""
    if image.dtype not in (np.uint8, np.uint16):
        return image
    highest = np.iinfo(image.dtype).max
    if fault.kind == "camera_lost":
        return np.zeros_like(image)
    # A dead grey camera still has noise.
    flicker = image & np.uint8(1) if image.ndim == 2 and image.dtype == np.uint8 else np.zeros_like(image)
    if fault.kind == "camera_black":
        return flicker
    if fault.kind == "camera_saturated":
        return highest - flicker if image.dtype == np.uint8 else np.zeros_like(image)
    if fault.kind == "calibration_off":
        return np.roll(image, round(fault.chosen_strength * image.shape[1]), axis=1)
    if fault.kind == "dead_rows":
        rows = np.random.default_rng(0).random(image.shape[0]) < fault.chosen_strength
        found = image.copy()
        found[rows] = 0
        return found
    rng = np.random.default_rng(seed)
    if seed % 2:
        return image
    noise = rng.normal(0.0, fault.chosen_strength * highest / 255.0, image.shape)
    return np.clip(image + noise, 0, highest).astype(image.dtype)


def _jumped(pose: Pose2, lasted_s: float) -> Pose2:
    """Return the odometry after a jump at the start of the fault and one every second since."""
    jumps = 1 + int(lasted_s / JUMP_EVERY_S)
    return Pose2(
        pose.x + jumps * JUMP.x,
        pose.y + jumps * JUMP.y,
        math.remainder(pose.heading + jumps * JUMP.heading, math.tau),
    )
