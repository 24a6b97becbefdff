"""Builds observations, with numbers within -1..1 if asked, as most learners want; images stay as they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numba import njit
from numpy.typing import NDArray

from peopleboy.scenarios.environments.observations import (
    COLUMNS,
    MOST_TRACKS,
    Arrays,
    image_shape,
    observe_truth,
    read_sensors,
)
from peopleboy.sim.batch.sensing import Snapshot
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.scenes import Records

AWAY_M: Final = 20.0
"""[m] x and y of `odometry` that become 1."""

IMAGES: Final = 2.0
"""[image heights] height, top and bottom of `tracks` that become 1."""

_SCALES: Final = (1.0, 1.0, IMAGES, IMAGES, IMAGES, 1.0, 1.0)
_LOWEST: Final = (0.0, -1.0, 0.0, -1.0, -1.0, 0.0, 0.0)


class Normaliser:
    """Brings the numbers of an observation within -1..1; what is beyond is clipped.

    | entry | becomes |
    |---|---|
    | `sonar` | 0..1, shares of the sonars' reach |
    | `odometry` x, y | -1..1 for -20..20 m |
    | `odometry` cosine, sine | as they are |
    | `odometry` speed, turn rate | -1..1, shares of the drive's limits |
    | `tracks` id | 1 for a person, 0 for none; all keep their rows, newcomers take the first free one |
    | `tracks` x | -1..1, half image widths |
    | `tracks` height, top, bottom | 0..1, -1..1, -1..1 for two image heights |
    | `tracks` confidence, is_visible | as they are |
    | images | as they are |
    """

    def __init__(self, robot: RobotConfig) -> None:
        drive = robot.drive
        self._reach_m = robot.sonar.farthest_m
        self._odometry = np.array(
            [AWAY_M, AWAY_M, 1.0, 1.0, drive.max_linear_m_s, drive.max_angular_rad_s], np.float32
        )

    def space(self, raw: spaces.Space[Arrays]) -> spaces.Space[Arrays]:
        """Return the space of what comes out for that of what goes in."""
        lowest = {
            "sonar": np.zeros(raw["sonar"].shape, np.float32),  # type: ignore[index]  # it is a Dict
            "odometry": -np.ones(len(self._odometry), np.float32),
            "tracks": np.tile(np.array(_LOWEST, np.float32), MOST_TRACKS),
        }
        return spaces.Dict(  # type: ignore[return-value]  # typed there as if samples were spaces
            {
                name: spaces.Box(lowest[name], 1.0, dtype=np.float32) if name in lowest else space
                for name, space in raw.spaces.items()  # type: ignore[attr-defined]
            }
        )

    def __call__(self, observation: Arrays, holders: NDArray[np.float64]) -> Arrays:
        """Bring the next observations of G worlds within bounds.

        Args:
            observation: as `observation_space` says, with worlds first.
            holders: (G, 5) numbers of the people who have the rows of `tracks`, kept up to date; 0 for none,
                as at the beginning of an episode.
        """
        found = observation | {
            "sonar": np.clip(observation["sonar"] / self._reach_m, 0.0, 1.0),
            "odometry": np.clip(observation["odometry"] / self._odometry, -1.0, 1.0),
        }
        if "tracks" in observation:
            given = observation["tracks"].reshape(-1, MOST_TRACKS, len(COLUMNS))
            shares = np.clip(given / _SCALES, _LOWEST, 1.0)
            found["tracks"] = np.empty_like(observation["tracks"])
            _keep_rows(given, shares, holders, found["tracks"].reshape(given.shape))
        return found


@njit(cache=True, nogil=True)
def _keep_rows(given: NDArray[np.float32], shares: Array, holders: Array, found: NDArray[np.float32]) -> None:
    """Put everybody into the row of before, and newcomers into the first that is free.

    Args:
        given: (G, 5, 7) as in observations.
        shares: (G, 5, 7) the same within bounds.
        holders: (G, 5) see `Normaliser`.
        found: (G, 5, 7).
    """
    found[:] = 0.0
    for world in range(len(given)):
        numbers, places = given[world, :, 0], holders[world]
        for place in range(len(places)):
            if not (numbers == places[place]).any():
                places[place] = 0.0
        for row in range(len(numbers)):
            if numbers[row] > 0.0 and not (places == numbers[row]).any():
                places[np.argmax(places == 0.0)] = numbers[row]
        for place in range(len(places)):
            if places[place] > 0.0:
                found[world, place] = shares[world, np.argmax(numbers == places[place])]


class ObservationBuilder:
    """Builds the observations of one kind, in one world as in many.

    Args:
        kind: one of `KINDS`.
        robot: with the cameras of all worlds.
        shown: names of those whose images `pixels` has.
        normaliser: brings numbers within -1..1; None to leave them.

    Attributes:
        tracks: whether trackers look for people.
        slow: names of the cameras that do not take an image at every step.
    """

    def __init__(
        self, kind: str, robot: RobotConfig, shown: Sequence[str], normaliser: Normaliser | None
    ) -> None:
        self._kind, self._robot, self._normaliser = kind, robot, normaliser
        self._shapes = {name: image_shape(robot.cameras[name]) for name in shown} if kind == "pixels" else {}
        self.tracks = kind == "tracks"
        self.slow = [name for name in self._shapes if robot.cameras[name].rate_hz]

    def build(self, snapshot: Snapshot, episodes: Records, tracks: NDArray[np.float32] | None) -> Arrays:
        """Return all but images, with worlds first.

        Args:
            snapshot: of G worlds, by their numbers.
            episodes: (B,) records EPISODE.
            tracks: (G, 35) where trackers look, None elsewhere.
        """
        numbers = snapshot.numbers
        found = read_sensors(snapshot, episodes["start"][numbers])
        if self._kind == "truth":
            found["tracks"] = observe_truth(snapshot.scenes, self._robot)
        elif tracks is not None:
            found["tracks"] = tracks
        if self._normaliser is not None:
            holders = episodes["holders"][numbers]
            found = self._normaliser(found, holders)
            episodes["holders"][numbers] = holders
        return found

    def images(self, snapshot: Snapshot) -> dict[str, tuple[Sequence[int], NDArray[Any]]]:
        """Return the images of `pixels`: for each camera which of the worlds have a new one, and these."""
        found = {}
        for name, shape in self._shapes.items():
            assert snapshot.images is not None
            rows, images = snapshot.images.of_camera(name)
            if rows:
                found[name] = rows, np.asarray(images).reshape(-1, *shape)
        return found
