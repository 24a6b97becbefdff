"""All that is sensed in many worlds at an instant, and what is true then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.truth.scenes import Scenes
from peopleboy.sim.world import World

Image = NDArray[Any]


class BatchImages(Protocol):
    """The images of an instant in G worlds; see `Observation.images` for until when they can be had."""

    def of_world(self, row: int) -> Mapping[str, Image]:
        """Images by name of one of the worlds."""
        ...

    def of_camera(self, camera: str) -> tuple[Sequence[int], Sequence[Image] | Image]:
        """Images of a camera's own name: in which of the worlds it takes one, and these."""
        ...


class SeparateImages:
    """Images that each world makes by itself."""

    def __init__(self, images: Sequence[Mapping[str, Image]]) -> None:
        self._images = images

    def of_world(self, row: int) -> Mapping[str, Image]:
        """See `BatchImages.of_world`."""
        return self._images[row]

    def of_camera(self, camera: str) -> tuple[Sequence[int], Sequence[Image] | Image]:
        """See `BatchImages.of_camera`."""
        rows = [row for row, images in enumerate(self._images) if camera in images]
        return rows, [self._images[row][camera] for row in rows]


class Snapshot(NamedTuple):
    """What the robots of G worlds sense, and what is true at the same time.

    Attributes:
        numbers: (G,) of the worlds.
        sonar_m: (G, 16) [m].
        odometry: (G, 3) x, y [m], heading [rad].
        wheel_speeds_m_s: (G, 2) [m/s] as in `Senses`.
        scenes: what is true.
        images: None where there are no images.
    """

    numbers: Numbers
    sonar_m: NDArray[np.float64]
    odometry: NDArray[np.float64]
    wheel_speeds_m_s: NDArray[np.float64]
    scenes: Scenes
    images: BatchImages | None

    def senses(self, row: int) -> Senses:
        """What one robot senses; an `Observation` where there are images."""
        time_s, sonar_m = float(self.scenes.worlds["time_s"][row]), self.sonar_m[row]
        odometry = Pose2(*self.odometry[row].tolist())
        left, right = self.wheel_speeds_m_s[row].tolist()
        if self.images is None:
            return Senses(
                time_s=time_s, sonar_m=sonar_m, odometry=odometry, wheel_speeds_m_s=(left, right)
            )  # fmt: skip
        return Observation(
            time_s=time_s, sonar_m=sonar_m, odometry=odometry, wheel_speeds_m_s=(left, right),
            images=self.images.of_world(row),
        )  # fmt: skip


def take_snapshot(world: World) -> Snapshot:
    """Sense once in one world, images included where there are any."""
    senses, images = world.sense(), SeparateImages([world.take_images()]) if world.has_images else None
    at = senses.odometry
    return Snapshot(
        numbers=np.zeros(1, np.int64),
        sonar_m=senses.sonar_m[None],
        odometry=np.array([[at.x, at.y, at.heading]]),
        wheel_speeds_m_s=np.array([senses.wheel_speeds_m_s]),
        scenes=world.scenes(),
        images=images,
    )
