"""The people of one instant with their recent paths: the input of all predictors."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.track import FloorPlace, Status, Track

Floats = NDArray[np.float64]

STEP_S: Final = 0.2
"""Time between two places of a recent path [s]."""
STEPS: Final = 9
"""Number of places of a recent path, including the current one."""

_UNKNOWN_M_S: Final = 0.5  # deviation of a velocity that the tracker does not report


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TrackedPeople:
    """K people at one instant, in the robot frame of that instant, which stays where it is.

    Attributes:
        ids: (K,) ids of the tracks.
        path_m: (K, STEPS, 2) places every `STEP_S` until now, oldest first; NaN before the track began.
        covariance_m2: (K, 2, 2) of the current place.
        velocity_m_s: (K, 2) relative to the floor.
        velocity_covariance_m2_s2: (K, 2, 2).
        robot_m_s: (2,) velocity of the robot.
    """

    ids: NDArray[np.int64]
    path_m: Floats
    covariance_m2: Floats
    velocity_m_s: Floats
    velocity_covariance_m2_s2: Floats
    robot_m_s: Floats

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def position_m(self) -> Floats:
        """(K, 2) current places."""
        return self.path_m[:, -1]


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Predicted places of K people at T times, in the frame of the people.

    Attributes:
        mean_m: (K, T, 2).
        covariance_m2: (K, T, 2, 2).
    """

    mean_m: Floats
    covariance_m2: Floats


class Predictor(Protocol):
    """A model of how people walk on."""

    def predict(self, people: TrackedPeople, after_s: Floats) -> Forecast:
        """Predict the places of all people after times (T,) [s], which increase from above 0."""
        ...


class PathMemory:
    """Recent paths of all tracks with a place on the floor, on a floor that odometry holds still."""

    def __init__(self) -> None:
        self._pose = Pose2()
        self._time_s: float | None = None
        self._paths: dict[int, deque[tuple[float, float, float]]] = {}

    def update(self, tracks: Sequence[Track], time_s: float, moved: Odometry | None) -> TrackedPeople:
        """Add the tracks of one instant, and return the people who are confirmed.

        Args:
            tracks: output of a tracker.
            time_s: [s] time of the image.
            moved: motion of the robot since the last call; None for a camera that stands.
        """
        motion = Pose2() if moved is None else moved.motion
        self._pose = self._pose.integrate(motion)
        dt_s = np.inf if self._time_s is None else time_s - self._time_s
        self._time_s = time_s
        placed = [(one, one.place) for one in tracks if one.place and one.status is not Status.TENTATIVE]
        self._forget(time_s, {one.id for one, _ in placed})
        for track, place in placed:
            x, y = self._pose.transform_point(place.position_m)
            self._paths.setdefault(track.id, deque()).append((time_s, x, y))
        paths = [self._pose.points_to_local(self._path(one.id, time_s)) for one, _ in placed]
        velocities = [_velocity(place, path) for (_, place), path in zip(placed, paths, strict=True)]
        return TrackedPeople(
            ids=np.array([one.id for one, _ in placed], np.int64),
            path_m=np.reshape(paths, (-1, STEPS, 2)),
            covariance_m2=np.reshape([_matrix(place.covariance_m2) for _, place in placed], (-1, 2, 2)),
            velocity_m_s=np.reshape(velocities, (-1, 2)),
            velocity_covariance_m2_s2=np.reshape([_spread(place) for _, place in placed], (-1, 2, 2)),
            robot_m_s=np.array([motion.x, motion.y]) / dt_s,
        )

    def _forget(self, time_s: float, ids: set[int]) -> None:
        """Drop the paths of tracks that are not reported any more, and places that are too old."""
        self._paths = {key: path for key, path in self._paths.items() if key in ids}
        for path in self._paths.values():
            while len(path) > 1 and path[1][0] <= time_s - STEP_S * (STEPS - 1):
                path.popleft()

    def _path(self, key: int, time_s: float) -> Floats:
        """Return the places (STEPS, 2) [m] of a track, interpolated."""
        times_s, x, y = np.array(self._paths[key]).T
        at_s = time_s + STEP_S * np.arange(1 - STEPS, 1)
        return np.stack([np.interp(at_s, times_s, one, left=np.nan) for one in (x, y)], axis=1)


def _velocity(place: FloorPlace, path: Floats) -> Floats:
    """Return the velocity (2,) of the tracker, or that over the recent path; 0 for a new path."""
    if place.velocity_m_s is not None:
        return np.array(place.velocity_m_s)
    known = np.flatnonzero(np.isfinite(path[:, 0]))
    passed = STEPS - 1 - int(known[0])
    return (path[-1] - path[known[0]]) / (STEP_S * passed) if passed else np.zeros(2)


def _spread(place: FloorPlace) -> Floats:
    if place.velocity_covariance_m2_s2 is not None:
        return _matrix(place.velocity_covariance_m2_s2)
    return np.eye(2) * _UNKNOWN_M_S**2


def _matrix(covariance: tuple[float, float, float]) -> Floats:
    xx, xy, yy = covariance
    return np.array([[xx, xy], [xy, yy]])
