"""Joint sensing of many robots, with the ground truth of the same instant."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.batch.drive import BatchWalks, JoinedWorlds, slice_world
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.physics.solid_shapes import Array, cast_into
from peopleboy.sim.robot.sonar import read_rings
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.truth.scenes import BYSTANDER, Records, Scenes, known_people, look_at_people
from peopleboy.sim.world import SimulatedWorld

Image = NDArray[Any]


class BatchSonar:
    """The sonar rings of B worlds, with equal settings.

    Args:
        worlds: of a batch.
        joined: where all is that they hear.
    """

    def __init__(self, worlds: Sequence[SimulatedWorld], joined: JoinedWorlds) -> None:
        self._rings = [world.robot.ring for world in worlds]
        self._joined = joined

    def read(self, active: Numbers, poses: Matrix) -> Matrix:
        """(G, 16) [m] readings in some worlds (G,), which are up to date, of robots at poses (G, 4, 4)."""
        rings = [self._rings[number] for number in active.tolist()]
        return read_rings(rings, poses, partial(_cast, self._joined, active))


class PeopleVisibility:
    """Visibility of the people of B worlds for their robots' thermal cameras, with equal settings.

    Args:
        worlds: of a batch.
        walks: where everybody goes.
        joined: where all is that may hide them.
    """

    def __init__(self, worlds: Sequence[SimulatedWorld], walks: BatchWalks, joined: JoinedWorlds) -> None:
        self._walks, self._joined = walks, joined
        self._camera = flat_geometry(worlds[0].config.robot.cameras, "thermal")
        self._known = np.concatenate(
            [np.zeros(0, BYSTANDER), *(known_people(world.crowd.people) for world in worlds)]
        )

    def look(self, active: Numbers, poses: Matrix, robots: Matrix) -> tuple[Records, Numbers]:
        """Return positions and visibility of the people who are present in some worlds.

        Args:
            active: (G,) numbers of the worlds, rising, which are up to date.
            poses: (G, 4, 4) of their robots.
            robots: (G, 3) [m, m, rad] the same.

        Returns:
            (Q,) records BYSTANDER of all of them, and (G + 1,) where those of each world begin.
        """
        walks, records = self._walks, self._walks.records
        row = np.full(len(walks.is_scripted), -1)
        row[active] = np.arange(len(active))
        present = np.flatnonzero(records["is_present"] & (row[walks.world] >= 0))
        row = row[walks.world[present]]
        found, walking = self._known[present], records[present]
        found["position_m"], found["velocity_m_s"] = walking["position"], walking["velocity"]
        found["heading_rad"] = walking["heading"]

        def cast(looked: Numbers, starts: Matrix, ends: Matrix) -> Matrix:
            return _cast(self._joined, active[row[looked]], starts, ends)

        cameras = (poses @ self._camera.robot_from_camera)[row]
        look_at_people(found, robots[row], self._camera, cameras, cast)
        return found, np.searchsorted(row, np.arange(len(active) + 1))


def _cast(joined: JoinedWorlds, worlds: Numbers, starts: Matrix, ends: Matrix) -> Matrix:
    """Return (G, R) fractions at which rays (G, R, 3) in worlds (G,) hit anything but the robots."""
    fraction = np.ones(starts.shape[:2])
    _cast_rays(worlds, joined, starts, ends, fraction)
    return fraction


@njit(cache=True, nogil=True)
def _cast_rays(worlds: Numbers, joined: JoinedWorlds, starts: Array, ends: Array, fraction: Array) -> None:
    part = np.empty(starts.shape[1], np.int64)
    for row in range(len(worlds)):
        bodies, solids = slice_world(joined, worlds[row])
        cast_into(starts[row], ends[row], bodies, solids, joined.own[worlds[row]], fraction[row], part)


# All sensor readings of many worlds at an instant, and their ground truth.


class BatchImages(Protocol):
    """The images of an instant in G worlds; see `Observation.images` for until when they can be had."""

    def of_world(self, row: int) -> Mapping[str, Image]:
        """Return the images of one world by name."""
        ...

    def of_camera(self, camera: str) -> tuple[Sequence[int], Sequence[Image] | Image]:
        """Return the worlds in which a camera takes an image, and the images of its first layer."""
        ...


class SeparateImages:
    """Images that each world renders by itself."""

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
    """Sensor readings of the robots of G worlds, and the ground truth of the same instant.

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
        """Return the readings of one robot, as an `Observation` if there are images."""
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

    def with_senses(self, senses: Sequence[Senses]) -> "Snapshot":
        """Return the snapshot with other readings of its G robots, for example those of failing sensors."""
        images = [one.images for one in senses if isinstance(one, Observation)]
        return self._replace(
            sonar_m=np.stack([one.sonar_m for one in senses]),
            odometry=np.array([(one.odometry.x, one.odometry.y, one.odometry.heading) for one in senses]),
            wheel_speeds_m_s=np.array([one.wheel_speeds_m_s for one in senses]),
            images=SeparateImages(images) if images else None,
        )


def take_snapshot(world: SimulatedWorld) -> Snapshot:
    """Read the sensors of one world once, including images if there are any."""
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
