"""Observations within -1..1, as most learners want them; images stay as they are, as learners scale them."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from peopleboy.scenarios.environments.observations import COLUMNS, MOST_TRACKS, Arrays
from peopleboy.sim.robot.robot_config import RobotConfig

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
    | `tracks` id | 1 for somebody, 0 for nobody; all keep their rows, newcomers take the first free one |
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
        self._rows = _Rows()

    def space(self, raw: spaces.Space[Arrays]) -> spaces.Space[Arrays]:
        """Give the space of what comes out for that of what goes in."""
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

    def begin(self) -> None:
        """Forget who had which row."""
        self._rows = _Rows()

    def __call__(self, observation: Arrays) -> Arrays:
        """Bring the next observation of an episode within bounds."""
        found = observation | {
            "sonar": np.clip(observation["sonar"] / self._reach_m, 0.0, 1.0),
            "odometry": np.clip(observation["odometry"] / self._odometry, -1.0, 1.0),
        }
        if "tracks" in observation:
            found["tracks"] = self._rows.sorted(observation["tracks"])
        return found


class _Rows:
    """Knows who had which row of `tracks` in the last observation."""

    def __init__(self) -> None:
        self._holders = [0.0] * MOST_TRACKS

    def sorted(self, tracks: NDArray[Any]) -> NDArray[np.float32]:
        """Put everybody into the row of before, and the numbers within bounds."""
        people = {float(row[0]): row for row in tracks.reshape(MOST_TRACKS, len(COLUMNS)) if row[0] > 0}
        holders = [number if number in people else 0.0 for number in self._holders]
        for newcomer in [number for number in people if number not in holders]:
            holders[holders.index(0.0)] = newcomer
        self._holders = holders
        table = np.zeros((MOST_TRACKS, len(COLUMNS)), np.float32)
        for row, number in zip(table, holders, strict=True):
            if number:
                row[:] = np.clip(people[number] / _SCALES, _LOWEST, 1.0)
        return table.reshape(-1)
