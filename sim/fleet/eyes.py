"""The cameras of many worlds, whose images are made together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import image_names, name_images
from peopleboy.sim.fleet.crew import Crew, Task, Work
from peopleboy.sim.fleet.draw_worlds import Poses
from peopleboy.sim.fleet.scenery import Array, join_scenery
from peopleboy.sim.fleet.side_by_side import Joined, Numbers
from peopleboy.sim.fleet.studios import Images, is_simple, open_studio
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.on_demand import OnDemand
from peopleboy.sim.physics.kinematic.kinematic import turn_wheels
from peopleboy.sim.world import World

Pictures = Mapping[str, NDArray[Any]]

_SHARES: Final = 3  # of a camera's images for each thread, so that none waits long for the last


class Eyes:
    """The cameras of B worlds, see `cameras_of`; they give to the byte what each world by itself would give.

    Args:
        worlds: of one kind, all of a fleet.
        joined: where all of their parts are.
        wheels: (B, 2) numbers of the wheels among the parts of all worlds.
        crew: works while Python goes on.
    """

    def __init__(self, worlds: Sequence[World], joined: Joined, wheels: Numbers, crew: Crew) -> None:
        self._worlds, self._joined, self._wheels, self._crew = tuple(worlds), joined, wheels, crew
        self._cameras = dict(worlds[0].cameras)
        scenery = join_scenery([world.table for world in worlds], [world.looks for world in worlds])
        self._studios = {
            name: open_studio(name, config, scenery, worlds) for name, config in self._cameras.items()
        }
        first_part = joined.firsts.part[:-1]
        first_body = np.repeat(joined.firsts.body[:-1], np.diff(joined.firsts.part))
        self._body_of_part = joined.bodies.of_part + first_body
        assert len(first_part) == len(worlds)
        self._work: Work | None = None

    def look(self, going: Numbers, robots: Array, turn_rad_s: Array) -> list[Pictures]:
        """Begin with the images of some worlds at this instant; who asks for one waits until all are made.

        Args:
            going: (G,) numbers of the worlds.
            robots: (G, 4, 4) world from robot.
            turn_rad_s: (G,) at which they turn.
        """
        self.finish()
        part = self._joined.bodies.poses.copy()
        turn_wheels(part, self._wheels.reshape(-1), self._joined.motion.angles.reshape(-1))
        hidden = self._joined.bodies.hidden[self._body_of_part]
        due = [self._worlds[number].due() for number in going.tolist()]
        taken: list[dict[str, tuple[Images, int]]] = [{} for _ in due]
        tasks: list[Task] = []
        for name, config in self._cameras.items():
            rows = np.array([row for row, names in enumerate(due) if name in names], np.int64)
            if not len(rows):
                continue
            assert isinstance(config.camera, Pinhole)
            poses = Poses(
                part=part,
                hidden=hidden,
                camera=robots[rows] @ config.camera.robot_from_camera,
                turned=turn_rad_s[rows] * config.exposure_s,
            )
            images, fill = self._studios[name].shoot(going[rows], poses)
            for place, row in enumerate(rows.tolist()):
                taken[row][name] = images, place
            tasks += [partial(fill, *share) for share in self._shares(len(rows))]
        self._work = self._crew.start(tasks)
        return [self._pictures(each, self._work) for each in taken]

    def finish(self) -> None:
        """Wait until all images are made, as must be before anything in the worlds changes."""
        if self._work is not None:
            self._work.finish()
            self._work = None

    def _shares(self, count: int) -> list[tuple[int, int]]:
        ends = np.linspace(0, count, min(_SHARES * self._crew.threads, count) + 1).round().astype(int).tolist()
        return list(zip(ends, ends[1:], strict=False))

    def _pictures(self, taken: Mapping[str, tuple[Images, int]], work: Work) -> Pictures:
        """What one world's cameras give, by the names of the images."""
        owners = {
            image: name for name in taken for image in _names(name, self._cameras[name])
        }

        def make(image: str) -> NDArray[Any]:
            work.finish()
            name = owners[image]
            images, row = taken[name]
            return name_images(name, self._cameras[name], [each[row] for each in images])[image]

        return OnDemand(owners, make)


def cameras_of(world: World) -> object | None:
    """What all worlds must share whose images are made together; None for a world that makes its own."""
    config = world.config
    simple = all(is_simple(camera) for camera in world.cameras.values())
    if config.renderer != "raycast" or config.detail != "plain" or not simple:
        return None
    return tuple(sorted(world.cameras.items(), key=lambda item: item[0]))


def _names(name: str, config: CameraConfig) -> tuple[str, ...]:
    return image_names(name, config)
