"""Simulate the faults and disturbances of a scenario, to test how controllers cope with them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import TrackerDown
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.observation import Observation, OnDemand, Senses
from peopleboy.sim.robot.peoplebot import PeopleBot
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.frame import Frame, Odometry, joined
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import Tracker, explanation_of

if TYPE_CHECKING:
    from peopleboy.sim.world import SimulatedWorld  # which reports need not load

Current = tuple[FaultSpec, float]  # a fault that is active, and the time [s] since it began
_REPEATING = ("camera_frozen", "camera_shutter", "frames_dropped", "frames_late", "frames_duplicated")
_SPOILING = (
    "camera_lost", "camera_black", "camera_saturated", "dead_rows", "noise_bursts", "calibration_off",
    "calibration_turned",
)  # fmt: skip
JUMP_EVERY_S = 1.0
JUMP = Pose2(x=0.7, y=-0.4, heading=math.radians(50.0))

CARRIED_TURN = Pose2(heading=math.radians(90.0))

_SHUTTER_S, _SHUTTER_EVERY_S = 0.4, 2.0
_FAR_M = 1e4  # so far away, the position of a camera does not matter
_HISTORY_S = 2.1  # images are kept for so long; a delay is at most 2 s

Image = NDArray[Any]
Pixels = tuple[NDArray[np.int64], NDArray[np.int64]]  # rows and columns (H, W)
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
        self._path: list[Pose2] = []  # true poses, one per step, until the robot is lifted
        self._is_carried = any(fault.kind == "robot_lifted" for fault in faults)
        self._turned: dict[tuple[str, float], Pixels] = {}

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

    def disturb(self, robot: PeopleBot, time_s: float) -> float:
        """Push or carry the robot at the start of a control step.

        Returns:
            The share of the commanded motion that the robot makes in this step.
        """
        now = _current(self._faults, time_s)
        share = _product_of(now, "wheel_slip", lambda lost: 1.0 - lost)
        for fault, _ in now:
            if fault.kind == "robot_pushed":
                robot.push(0.0, fault.chosen_strength / CONTROL_HZ)
        lifted = [fault for fault, _ in now if fault.kind == "robot_lifted"]
        if self._is_carried and (not lifted or self._path):
            self._path.append(robot.pose())
        if not lifted:
            return share
        if self._path:
            robot.put(_pose_before(self._path, lifted[0].chosen_strength).compose(CARRIED_TURN))
            self._path.clear()
        return 0.0

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
                if not _is_hit(fault, name):
                    continue
                if fault.kind == "calibration_turned":
                    image = self._turned_down(name, image, fault, seen.calibrations)
                else:
                    image = _spoilt(image, fault, int(seed))
            return image

        return OnDemand(found, spoil)

    def _turned_down(
        self, name: str, image: Image, fault: FaultSpec, calibrations: Mapping[str, Calibration]
    ) -> Image:
        """Return the image of a camera that looks lower; beyond its edge the image of the edge."""
        camera = next((each for each in calibrations if _is_of(name, each)), None)
        if camera is None:
            return image
        key = name, fault.chosen_strength
        if key not in self._turned:
            down_rad = math.radians(fault.chosen_strength)
            self._turned[key] = _pixels_below(calibrations[camera], image.shape[:2], down_rad)
        rows, columns = self._turned[key]
        return image[rows, columns]

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

    def __init__(self, world: "SimulatedWorld", faults: Sequence[FaultSpec]) -> None:
        self._world = world
        self._faults = SensorFaults(faults, world.config.robot.sonar.farthest_m)

    def observe(self) -> Observation:
        """Read every sensor once, and apply the active faults."""
        return self._faults.apply(self._world.observe())

    @property
    def cameras(self) -> Mapping[str, CameraConfig]:
        """Cameras of the robot, by name."""
        return self._world.cameras

    def truths(self) -> Mapping[str, Truth]:
        """Return the ground truth of this instant, by camera that takes an image."""
        return self._world.truths()

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot for one control step."""
        share = self._faults.disturb(self._world.robot, self._world.time_s)
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
            self._tracks = self._tracker.update(frame)
            return self._tracks
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
    return fault.camera is None or _is_of(image, fault.camera)


def _is_of(image: str, camera: str) -> bool:
    return image == camera or image.startswith(f"{camera}_")


def _product_of(now: Sequence[Current], kind: str, factor: Callable[[float], float]) -> float:
    return math.prod(factor(fault.chosen_strength) for fault, _ in now if fault.kind == kind)


def _overwritten(
    ranges: NDArray[np.float64], fault: FaultSpec, value: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return ranges in which the fault's sonar, or all of them, have another value."""
    is_hit = np.ones(len(ranges), bool) if fault.sonar is None else np.arange(len(ranges)) == fault.sonar
    return np.where(is_hit, value, ranges)


def _pixels_below(calibration: Calibration, shape: Sequence[int], down_rad: float) -> Pixels:
    """Return the row and column (H, W) in an image at which each pixel of a camera that looks lower looks."""
    height, width = shape
    v, u = np.mgrid[:height, :width]
    rays = calibration.rays(np.stack([u.ravel(), v.ravel()], axis=1).astype(np.float64))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    cos, sin = math.cos(down_rad), math.sin(down_rad)
    lower = rays @ np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    found = np.nan_to_num(calibration.project(calibration.position_m + _FAR_M * lower), nan=height)
    columns, rows = np.rint(found.T).astype(np.int64).reshape(2, height, width)
    return np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)


def _pose_before(path: Sequence[Pose2], distance_m: float) -> Pose2:
    """Return the pose at which a robot was, so far back along its path; the first one of a shorter path."""
    left_m = distance_m
    for k in range(len(path) - 1, 0, -1):
        left_m -= math.hypot(path[k].x - path[k - 1].x, path[k].y - path[k - 1].y)
        if left_m <= 0.0:
            return path[k - 1]
    return path[0]


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
