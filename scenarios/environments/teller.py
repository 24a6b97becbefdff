"""Tells controllers what they are told, in one world as in many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.environments.normalise import Normaliser
from peopleboy.scenarios.environments.observations import Arrays, feel, image_shape, see_truth
from peopleboy.sim.batch.snapshot import Snapshot
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.scenes import Records


class Teller:
    """Makes the observations of one kind.

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

    def tell(self, snapshot: Snapshot, episodes: Records, tracks: NDArray[np.float32] | None) -> Arrays:
        """Give all but images, with worlds first.

        Args:
            snapshot: of G worlds, by their numbers.
            episodes: (B,) records EPISODE.
            tracks: (G, 35) where trackers look, None elsewhere.
        """
        numbers = snapshot.numbers
        found = feel(snapshot, episodes["start"][numbers])
        if self._kind == "truth":
            found["tracks"] = see_truth(snapshot.scenes, self._robot)
        elif tracks is not None:
            found["tracks"] = tracks
        if self._normaliser is not None:
            holders = episodes["holders"][numbers]
            found = self._normaliser(found, holders)
            episodes["holders"][numbers] = holders
        return found

    def show(self, snapshot: Snapshot) -> dict[str, tuple[Sequence[int], NDArray[Any]]]:
        """Give the images of `pixels`: for each camera which of the worlds have a new one, and these."""
        found = {}
        for name, shape in self._shapes.items():
            assert snapshot.pictures is not None
            rows, images = snapshot.pictures.together(name)
            if rows:
                found[name] = rows, np.asarray(images).reshape(-1, *shape)
        return found
